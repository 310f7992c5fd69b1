"""Formats by suffix: read and write any file with a rule base.

To add a format
---------------
A module with ``parse_<suffix>(text, path) -> Imported`` within `drafts.imported` (never raises,
every finding has a position, a loss that changes numbers goes through ``Findings.loss``), made of
a ``SystemReader`` (:mod:`.system_reader`) that finds words and a ``SystemWriter``
(:mod:`.system_writer`) that writes them; a line here; its dialect (:mod:`.dialects`); a column in
``docs/reference/formats.md``; sample files of our own in ``tests/formats/data``, which round trips
and damage tests take up; and the meaning of its numbers in
``tests/formats/test_orders_of_numbers.py``, checked against the program itself.
"""

from __future__ import annotations

import codecs
import math
import os
from dataclasses import replace
from pathlib import Path

from fuzzyarm.base.diagnostic import MAX_CHARACTERS as MAX_OWN_CHARACTERS
from fuzzyarm.base.diagnostic import Diagnostic, Span
from fuzzyarm.base.folders import FOREIGN, READABLE, SUFFIXES
from fuzzyarm.base.protected import note_source
from fuzzyarm.exchange.formats.dialects import MEANINGS, PRODUCERS
from fuzzyarm.exchange.formats.fcl_reader import parse_fcl
from fuzzyarm.exchange.formats.fcl_writer import write_fcl
from fuzzyarm.exchange.formats.findings import (
    MAX_CHARACTERS,
    Exported,
    Findings,
    FormatError,
    Imported,
    demand_program,
)
from fuzzyarm.exchange.formats.fis_reader import parse_fis
from fuzzyarm.exchange.formats.fis_writer import write_fis
from fuzzyarm.exchange.formats.fll import parse_fll, write_fll
from fuzzyarm.exchange.formats.fml import parse_fml
from fuzzyarm.exchange.formats.fml_writer import write_fml
from fuzzyarm.exchange.formats.not_texts import called, started
from fuzzyarm.exchange.formats.system_writer import note_threshold
from fuzzyarm.language.model.rulebase import AnyRuleBase, RuleBase, model_of


def suffix_of(path: str | os.PathLike[str], suffixes: tuple[str, ...] = SUFFIXES) -> str:
    """Return the suffix of `path`, one of `suffixes`, in lower case.

    Parameters
    ----------
    path : path-like
        A name of a file.
    suffixes : tuple of str
        The accepted suffixes.

    Raises
    ------
    FormatError
        If the suffix is none of them.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in suffixes:
        endings = ", ".join(suffixes)
        if known_as := called(path):
            kind, hint = known_as
            raise FormatError(f"{os.fspath(path)}: this is {kind}, not a text", hint=hint)
        raise FormatError(f"{os.fspath(path)}: a rule base ends in {endings}, not '{suffix}'")
    return suffix


def parse(
    text: str,
    suffix: str,
    path: str = "<text>",
    *,
    producer: str | None = None,
    block: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Imported:
    """Read `text` as the format of `suffix`; never raises on any text.

    Parameters
    ----------
    text : str
        Any text.
    suffix : str
        One of :data:`READABLE`.
    path : str
        Name of the file, for the diagnostics.
    producer : str, optional
        Program whose semantics apply, one of :data:`MEANINGS` for the suffix; detected from the
        text by default.
    block : str, optional
        The function block of an FCL file with several.
    lossy : bool
        Make a loss that changes numbers a warning instead of an error.
    strict : bool
        Make a slight loss, such as another sampling, an error instead of a warning.

    Raises
    ------
    FormatError
        If `suffix` or `producer` is not known.
    """
    demand_program(producer, suffix, "read as those of", MEANINGS)
    match suffix:
        case ".fll":
            return parse_fll(text, path, lossy=lossy, strict=strict)
        case ".fcl":
            return parse_fcl(text, path, dialect=producer, block=block, lossy=lossy, strict=strict)
        case ".fis" | ".t2fis":
            return parse_fis(text, path, producer=producer, lossy=lossy, strict=strict)
        case ".fml" | ".xml":
            return parse_fml(text, path, lossy=lossy, strict=strict)
        case ".frb":
            return _own(text, path)
    raise FormatError(f"no format has the suffix '{suffix}'")


def _own(text: str, path: str) -> Imported:
    from fuzzyarm.language import parse as parse_rulebase
    from fuzzyarm.language.reading import without_rulebase

    parsed = parse_rulebase(text, path)
    if parsed.rulebase is None:
        return Imported(None, tuple(without_rulebase(parsed, path)), "fuzzyarm")
    return Imported(parsed.rulebase, parsed.diagnostics, "fuzzyarm")


def read(
    path: str | os.PathLike[str],
    *,
    producer: str | None = None,
    block: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Imported:
    """Read the file at `path` by its suffix.

    Parameters
    ----------
    path : str or PathLike
        A ``.frb``, ``.fll``, ``.fcl``, ``.fis`` (``.t2fis``) or ``.fml`` (``.xml``) file, UTF-8
        or else Latin-1.
    producer, block, lossy, strict
        As for :func:`parse`.

    Raises
    ------
    OSError
        If the file cannot be read.
    FormatError
        If the suffix or the producer is not known.
    """
    suffix = suffix_of(path, READABLE)
    name = os.fspath(path)
    most = MAX_CHARACTERS if suffix in FOREIGN else MAX_OWN_CHARACTERS
    note_source(path)
    with Path(path).open("rb") as file:
        # UTF-8 takes at most four bytes for a character; one byte more shows that it is too large.
        data = file.read(4 * most + 1)
    text, findings = decoded(data, name)
    if any(diagnostic.is_error for diagnostic in findings):
        return Imported(None, findings)
    imported = parse(text, suffix, name, producer=producer, block=block, lossy=lossy, strict=strict)
    diagnostics = tuple(sorted((*findings, *imported.diagnostics), key=lambda d: d.span))
    return replace(imported, diagnostics=diagnostics)


def decoded(data: bytes, path: str) -> tuple[str, tuple[Diagnostic, ...]]:
    """Decode UTF-8 bytes, or Latin-1 with a warning at the first bad byte.

    UTF-16 with a byte-order mark is read as well; other bytes with a NUL are not text.
    """
    # Before the search for NUL: in UTF-16 every second byte of plain text is one.
    if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return data.decode("utf-16", errors="replace"), ()
    if known_as := started(data):
        kind, hint = known_as
        findings = Findings(path)
        findings.error("not-text", f"this is {kind}, not a text", hint=hint)
        return "", findings.all()
    if b"\0" in data:
        findings = Findings(path)
        findings.error("not-text", "not a text file")
        return "", findings.all()
    try:
        return data.decode("utf-8-sig"), ()
    except UnicodeDecodeError as error:
        before = data[: error.start]
        line = before.count(b"\n") + 1
        column = len(before) - before.rfind(b"\n")
        findings = Findings(path)
        byte = data[error.start]
        message = f"not UTF-8: byte 0x{byte:02x}; the whole file is read as Latin-1"
        findings.warn("not-utf-8", message, Span(line, column, line, column + 1))
        return data.decode("latin-1"), findings.all()


def write(
    rulebase: AnyRuleBase,
    suffix: str,
    *,
    producer: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Exported:
    """Return `rulebase` in the format of `suffix`.

    Parameters
    ----------
    rulebase : RuleBase
        Any rule base.
    suffix : str
        One of :data:`SUFFIXES`.
    producer : str, optional
        The program to write for, one of :data:`PRODUCERS` for the suffix; by default the one
        with the least loss: of a ``.fis`` MATLAB, unless another has the sampling of the
        outputs or a feature that MATLAB lacks.
    lossy : bool
        Write even if that program would compute other numbers.
    strict : bool
        Refuse slight losses too, such as another sampling.

    Raises
    ------
    FormatError
        If `suffix` or `producer` is not known.
    """
    rulebase = model_of(rulebase)
    demand_program(producer, suffix, "written for", PRODUCERS)
    match suffix:
        case ".fll":
            return write_fll(rulebase, lossy=lossy, strict=strict)
        case ".fcl":
            return write_fcl(rulebase, dialect=producer, lossy=lossy, strict=strict)
        case ".fis":
            return write_fis(rulebase, producer=producer, lossy=lossy, strict=strict)
        case ".fml":
            return write_fml(rulebase, lossy=lossy, strict=strict)
        case ".frb":
            return _write_own(rulebase, lossy=lossy, strict=strict)
    raise FormatError(f"no format has the suffix '{suffix}'")


def _write_own(rulebase: RuleBase, *, lossy: bool, strict: bool) -> Exported:
    """Write a ``.frb`` text; refuse a model that would not read back the same."""
    from fuzzyarm.language import parse as parse_rulebase
    from fuzzyarm.language import write as write_rulebase

    text = write_rulebase(rulebase)
    findings = Findings(lossy=lossy, strict=strict)
    parsed = parse_rulebase(text)
    for diagnostic in parsed.diagnostics:
        if diagnostic.is_error:
            findings.error(diagnostic.name, diagnostic.message)
    if parsed.rulebase is not None and not same_model(parsed.rulebase, rulebase):
        # Is a threshold, which the language lacks, the only difference?
        blocks = tuple(replace(block, threshold=0.0) for block in rulebase.blocks)
        if same_model(parsed.rulebase, replace(rulebase, blocks=blocks)):
            note_threshold(rulebase, findings, "the language", 0.0)
        else:
            findings.loss("not-in-language", "the text does not say all of the model")
    return findings.exported(text)


def same_model(one: RuleBase, other: RuleBase) -> bool:
    """Whether two rule bases are equal, with NaN equal to NaN.

    Parameters
    ----------
    one, other : RuleBase
        Rule bases.
    """
    return _without_nan(one) == _without_nan(other)


def _without_nan(rulebase: RuleBase) -> RuleBase:
    outputs = tuple(
        replace(o, no_rule="nan") if isinstance(o.no_rule, float) and math.isnan(o.no_rule) else o
        for o in rulebase.outputs
    )
    return replace(rulebase, outputs=outputs)
