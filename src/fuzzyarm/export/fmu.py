"""A controller as a co-simulation unit: its description, the library, the archive."""

from __future__ import annotations

import hashlib
import io
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import uuid
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from xml.etree import ElementTree as Xml

from fuzzyarm.export.c import CText, controller_c
from fuzzyarm.export.controllers import ControllerProgram, port_name
from fuzzyarm.export.document import xml_document
from fuzzyarm.export.fmi import fmi_source
from fuzzyarm.export.names import in_ascii
from fuzzyarm.export.numbers import ExportError
from fuzzyarm.export.steps import StepVariable
from fuzzyarm.extras import installing
from fuzzyarm.version import __version__

VERSIONS = (2, 3)

_EPOCH = (1980, 1, 1, 0, 0, 0)
"""The time of all files in an archive: the same source gives the same bytes."""

Entry = tuple[StepVariable, str, str]
"""A variable, its name in the unit, and the member that holds it."""


@dataclass(frozen=True, slots=True)
class Platform:
    """A machine that a unit can hold a library for.

    Attributes
    ----------
    target : str
        As the compiler of the ``ziglang`` wheel calls it.
    folders : dict of int to str
        Of the library in the archive, by the version of FMI; some are unknown to version 2.
    suffix : str
        Of the library.
    """

    target: str
    folders: dict[int, str]
    suffix: str


PLATFORMS = {
    # 2.17 is the oldest glibc that a host may have.
    "linux64": Platform("x86_64-linux-gnu.2.17", {2: "linux64", 3: "x86_64-linux"}, ".so"),
    "win64": Platform("x86_64-windows-gnu", {2: "win64", 3: "x86_64-windows"}, ".dll"),
    "darwin64": Platform("x86_64-macos", {2: "darwin64", 3: "x86_64-darwin"}, ".dylib"),
    "aarch64-linux": Platform("aarch64-linux-gnu.2.17", {3: "aarch64-linux"}, ".so"),
    "aarch64-darwin": Platform("aarch64-macos", {3: "aarch64-darwin"}, ".dylib"),
}
"""Platforms by name: those of version 2 of FMI, and two of version 3."""


def platforms_named(text: str, version: int) -> tuple[Platform, ...]:
    """Return platforms by a list like ``linux64,win64``."""
    platforms = []
    for name in dict.fromkeys(part.strip() for part in text.split(",")):
        if name not in PLATFORMS:
            raise ExportError(f"no platform '{name}'", hint=f"there are {', '.join(PLATFORMS)}")
        if version not in PLATFORMS[name].folders:
            raise ExportError(f"version {version} of FMI does not know '{name}'", hint="--fmi 3")
        platforms.append(PLATFORMS[name])
    return tuple(platforms)


def controller_fmu(
    program: ControllerProgram, prefix: str, version: int = 2, platforms: Sequence[Platform] = ()
) -> bytes:
    """Return a controller as a co-simulation unit, built with the C compiler that is there.

    Parameters
    ----------
    program : ControllerProgram
        In double precision.
    prefix : str
        The model identifier.
    version : int
        Of FMI, 2 or 3.
    platforms : sequence of Platform
        Which libraries it holds, built by the ``ziglang`` wheel; by default that of the machine
        at hand, built by its own compiler.

    Raises
    ------
    ExportError
        If there is no C compiler, or it fails.
    """
    if version not in VERSIONS:
        raise ExportError(f"version {version} of FMI is not supported", hint="versions 2 and 3 are")
    if program.precision != "float64":
        raise ExportError("an FMU computes in double precision", hint="--precision float64")
    compiler = _cross_compiler() if platforms else find_compiler()
    steps = program.steps
    made = controller_c(steps, prefix, prefix, ".h", program.tried.vectors, program.head())
    header = made.files[".h"]
    entries = list(_entries(program, made))
    settable = sum(entry.sort in ("reference", "measured", "gain") for entry, _, _ in entries)
    # The host compares this token with that of the library: it changes with what is computed.
    digest = hashlib.sha256((header + str(version)).encode()).digest()
    token = f"{{{uuid.UUID(bytes=digest[:16])}}}"
    places = [(variable, place) for variable, _, place in entries]
    shell = fmi_source(version, prefix, token, places, settable, steps.model.period)
    source = f'#include "{prefix}.h"\n\n{shell}'
    sources = {f"{prefix}.h": header, f"{prefix}.c": source}
    description = _description(program, prefix, version, token, entries)
    folder = {2: _platform2(), 3: _platform3()}[version]
    content: dict[str, str | bytes] = {
        "modelDescription.xml": description,
        **{
            f"binaries/{entry.folders[version]}/{prefix}{entry.suffix}": compile_library(
                [*compiler, "-target", entry.target], sources, prefix, entry.suffix
            )
            for entry in platforms
        },
        f"sources/{prefix}.h": header,
        f"sources/{prefix}.c": source,
    }
    if not platforms:
        place = f"binaries/{folder}/{prefix}{_suffix()}"
        content[place] = compile_library(compiler, sources, prefix, _suffix())
    if version == 3:
        content["sources/buildDescription.xml"] = _build_description(prefix)
    return _archive(content)


# --- The C compiler ---


def find_compiler() -> list[str]:
    """Return the words that call the C compiler: `CC`, else the first of cc, gcc and clang."""
    command = os.environ.get("CC", "")
    words = shlex.split(command)
    if words:
        if shutil.which(words[0]) is None:
            raise ExportError(f"the C compiler '{words[0]}' named by CC was not found")
        return words
    for name in ("cc", "gcc", "clang"):
        if shutil.which(name) is not None:
            return [name]
    raise ExportError(
        "an .fmu needs a C compiler, and none was found",
        hint="install gcc or clang, or name one in CC; a .h needs no compiler",
    )


def _cross_compiler() -> list[str]:
    """Return the words that call the compiler of the ``ziglang`` wheel; ExportError without it."""
    if find_spec("ziglang") is None:
        raise ExportError(
            "libraries for other platforms are built by the ziglang wheel, which is not installed",
            hint=installing("platforms"),
        )
    return [sys.executable, "-m", "ziglang", "cc"]


def compile_library(
    compiler: Sequence[str], files: dict[str, str], name: str, suffix: str
) -> bytes:
    """Return the shared library that a C compiler makes of some files."""
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as folder:
        for file, text in files.items():
            (Path(folder) / file).write_text(text, "utf-8")
        target = Path(folder) / f"{name}{suffix}"
        # Products and sums stay apart: a fused one would move the last bit.
        words = ["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-fvisibility=hidden"]
        command = [*compiler, *words, f"{name}.c", "-o", target.name, "-lm"]
        try:
            process = subprocess.run(
                command, cwd=folder, capture_output=True, text=True, check=False
            )
        except OSError as error:
            raise ExportError(f"cannot run the C compiler: {error}") from None
        if process.returncode != 0 or not target.is_file():
            message = next(iter(process.stderr.strip().splitlines()), "it says nothing")
            raise ExportError(f"the C compiler '{' '.join(compiler)}' failed: {message}")
        return target.read_bytes()


def _suffix() -> str:
    return {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def _platform2() -> str:
    bits = "64" if sys.maxsize > 2**32 else "32"
    return {"win32": "win", "darwin": "darwin"}.get(sys.platform, "linux") + bits


def _platform3() -> str:
    machine = platform.machine().lower()
    machine = {"amd64": "x86_64", "arm64": "aarch64", "i686": "x86"}.get(machine, machine)
    system = {"win32": "windows", "darwin": "darwin"}.get(sys.platform, "linux")
    return f"{machine}-{system}"


# --- The description ---


def _entries(program: ControllerProgram, made: CText) -> Iterator[Entry]:
    """Yield what has a value reference, what may be set first."""
    steps, taken = program.steps, set[str]()
    for sort in ("reference", "measured", "gain", "drive", "signal"):
        for variable in steps.of_sort(sort):
            place = made.place(variable)
            name = variable.name if sort == "gain" else port_name(steps, variable)
            if variable.number >= 0:
                name = f"{name}[{variable.number + 1}]"
            name = {"reference": f"reference.{name}", "measured": f"measured.{name}"}.get(
                sort, f"signal.{name}" if sort == "signal" else name
            )
            yield variable, _structured(name, taken), place


def _structured(name: str, taken: set[str]) -> str:
    """Return a name by the structured naming convention: odd parts stand between quotes.

    It has ASCII alone: accents are dropped and Greek is spelt; a name that is taken has a number.
    """
    plain, number = in_ascii(name), 1
    name = plain
    while name in taken:
        number += 1
        name = f"{plain}_{number}"
    taken.add(name)
    parts = name.split(".")
    return ".".join(part if _PLAIN.fullmatch(part) else _quoted(part) for part in parts)


_PLAIN = re.compile(r"[A-Za-z_]\w*(\[\d+\])?", re.ASCII)


def _quoted(part: str) -> str:
    escaped = part.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"


_CAUSALITY = {
    "reference": "input", "measured": "input", "gain": "parameter", "drive": "output",
    "signal": "local",
}  # fmt: skip


def _words_of(variable: StepVariable, program: ControllerProgram) -> dict[str, str]:
    """Return the attributes that both versions share, except for the start."""
    gains = {gain.name: gain.unit for gain in program.text.model.gains}
    words = {
        "causality": _CAUSALITY[variable.sort],
        "variability": "tunable" if variable.sort == "gain" else "discrete",
    }
    unit = gains.get(variable.name, "") if variable.sort == "gain" else ""
    return words | ({"unit": unit} if unit else {})


def _starts(variable: StepVariable) -> bool:
    return variable.sort in ("reference", "measured", "gain")


def _description(
    program: ControllerProgram, prefix: str, version: int, token: str, entries: Sequence[Entry]
) -> str:
    model = program.text.model
    root = Xml.Element(
        "fmiModelDescription",
        {
            "fmiVersion": f"{version}.0",
            "modelName": model.name,
            "guid" if version == 2 else "instantiationToken": token,
            "description": f"{model.description or model.name}; runs every {model.period!r} s",
            "generationTool": f"fuzzyarm {__version__}",
            "variableNamingConvention": "structured",
        },
    )
    if version == 2:
        root.set("numberOfEventIndicators", "0")
    ways = {
        "modelIdentifier": prefix,
        "canHandleVariableCommunicationStepSize": "true",
        "canGetAndSetFMUstate" if version == 2 else "canGetAndSetFMUState": "true",
        "canSerializeFMUstate" if version == 2 else "canSerializeFMUState": "true",
    }
    if version == 3:
        ways["fixedInternalStepSize"] = repr(model.period)
    way = Xml.SubElement(root, "CoSimulation", ways)
    if version == 2:
        Xml.SubElement(Xml.SubElement(way, "SourceFiles"), "File", {"name": f"{prefix}.c"})
    units = dict.fromkeys(_words_of(entry, program).get("unit", "") for entry, _, _ in entries)
    unit_names = [unit for unit in units if unit]
    if unit_names:
        listed = Xml.SubElement(root, "UnitDefinitions")
        for unit in unit_names:
            Xml.SubElement(listed, "Unit", {"name": unit})
    Xml.SubElement(
        root,
        "DefaultExperiment",
        {"startTime": "0.0", "stopTime": repr(1000 * model.period), "stepSize": repr(model.period)},
    )
    variables = Xml.SubElement(root, "ModelVariables")
    for number, (entry, name, _) in enumerate(entries):
        words = {"name": name, "valueReference": str(number), **_words_of(entry, program)}
        start = {"start": repr(entry.start)} if _starts(entry) else {}
        if version == 3:
            Xml.SubElement(variables, "Float64", {**words, **start})
        else:
            unit_attribute = {"unit": words.pop("unit")} if "unit" in words else {}
            variable = Xml.SubElement(variables, "ScalarVariable", words)
            Xml.SubElement(variable, "Real", {**unit_attribute, **start})
    if version == 3:
        # FMI 3 wants the independent variable listed; FMI 2 does not know it.
        time = {"name": "time", "valueReference": str(len(entries)), "causality": "independent"}
        Xml.SubElement(variables, "Float64", {**time, "variability": "continuous"})
    _structure(root, version, entries)
    Xml.indent(root)
    return xml_document(root, "UTF-8")


def _structure(root: Xml.Element, version: int, entries: Sequence[Entry]) -> None:
    """Say what is calculated: drives are, of what was measured when a period began."""
    structure = Xml.SubElement(root, "ModelStructure")
    drives = [number for number, (variable, _, _) in enumerate(entries) if variable.sort == "drive"]
    if version == 3:
        for word in ("Output", "InitialUnknown"):
            for number in drives:
                Xml.SubElement(structure, word, {"valueReference": str(number), "dependencies": ""})
        return
    for word in ("Outputs", "InitialUnknowns"):
        listed = Xml.SubElement(structure, word)
        for number in drives:
            # FMI 2 refers to a variable by its position, from 1.
            Xml.SubElement(listed, "Unknown", {"index": str(number + 1), "dependencies": ""})


def _build_description(prefix: str) -> str:
    root = Xml.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = Xml.SubElement(root, "BuildConfiguration", {"modelIdentifier": prefix})
    sources = Xml.SubElement(configuration, "SourceFileSet", {"language": "C99"})
    Xml.SubElement(sources, "SourceFile", {"name": f"{prefix}.c"})
    Xml.indent(root)
    return xml_document(root, "UTF-8")


def _archive(content: dict[str, str | bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data)
    return buffer.getvalue()
