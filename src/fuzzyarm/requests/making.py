"""Making: a lookup table of rules, source text and programs of tables, rules and controllers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from fuzzyarm.language.model.lookup_modes import LookupMode
from fuzzyarm.requests.fields import Limits, Request, option

SOURCE = "source text (.h, .c, .st, .xml, .scl) and units (.fmu)"


@dataclass(frozen=True, kw_only=True)
class CompileRequest(Request):
    """A lookup table of a rule base."""

    file: str = option("file FILE", "a rule base (.frb, .fll, .fcl, .fis), a table or a controller")
    output: str | None = option("--output NAME", "which output, if there are several", None)
    levels: str | None = option(
        "--levels SPEC", "49, or '-6 .. 6 step 1', or 'e = 49, ce = 25'", None, either="size"
    )
    tolerance: float | None = option(
        "--tolerance T",
        "find the smallest even grid within T",
        None,
        Limits(0.0, is_open=True),
        either="size",
    )
    round: float | None = option(
        "--round STEP", "round the values; 0 for not at all", None, Limits(0.0)
    )
    mode: LookupMode | None = option("--mode", "how to look up", None)
    ends: bool = option(
        "--ends", "two tables: of the left and the right end of an interval type-2 output", False
    )
    date: bool = option("--date", "put today's date into the table", False)


@dataclass(frozen=True, kw_only=True)
class ExportRequest(CompileRequest):
    """Source text or a program; see ``fuzzyarm compile``."""

    direct: bool = option(
        "--direct", "infer the rules, without a table: the default without lookup settings", False,
        group=SOURCE,
    )  # fmt: skip
    table: bool = option(
        "--table", "look tables up instead of inferring the rules", False, group=SOURCE
    )
    fmi: Literal[2, 3] | None = option("--fmi", "version of FMI, 2 by default", None, group=SOURCE)
    platforms: str | None = option(
        "--platforms LIST", "of an FMU: linux64,win64,darwin64 and others, by ziglang", None,
        group=SOURCE,
    )  # fmt: skip
    q: Literal[15, 7] | None = option("--q", "fixed point: int16 or int8", None, group=SOURCE)
    precision: Literal["mixed", "float32", "float64"] | None = option(
        "--precision", "mixed (float outside, double inside where needed) by default", None,
        group=SOURCE,
    )  # fmt: skip
    name: str | None = option("--name IDENT", "begins every identifier", None, group=SOURCE)
    place: Literal["arduino", "platformio"] | None = option(
        "--for", "a folder for an IDE", None, group=SOURCE
    )
    board: str | None = option(
        "--board NAME", "of --for: uno (default), nano, mega, due, pico, esp32", None, group=SOURCE
    )
    certificate: str | None = option(
        "--certificate CERT", "of a controller: certificate quoted in the header", None,
        group=SOURCE,
    )  # fmt: skip
    guard: str | None = option(
        "--guard CERT", "of a controller in C: a test of its state by this certificate", None,
        group=SOURCE,
    )  # fmt: skip
    trust: bool = option(
        "--trust", "with --certificate or --guard: run the Python file of its plant", False,
        group=SOURCE,
    )  # fmt: skip
