"""Print the messages of the designer as TypeScript types, from their records in Python.

``python tools/message_types.py`` writes ``editors/designer/messages.d.ts``, in which `tsc` looks up
what the page says and hears; ``tests/designer/test_designer_built.py`` holds the file to it.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path
from types import NoneType, UnionType
from typing import (
    Any,
    Literal,
    NotRequired,
    Union,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)

from fuzzyarm.apps.designer import messages, requests
from fuzzyarm.apps.designer.records import Absent, json_name

FILE = Path(__file__).parents[1] / "editors/designer/messages.d.ts"

HEAD = """\
// What the designer's page says and hears. Printed by tools/message_types.py from the records of
// fuzzyarm.apps.designer.requests and fuzzyarm.apps.designer.messages; `make types` prints it anew.

declare namespace Messages {
"""

PLAIN = {
    str: "string",
    bool: "boolean",
    int: "number",
    float: 'number | "inf" | "-inf"',
    NoneType: "null",
    Any: "any",
}
"""Types of fields that a page sends; what it hears has finite numbers, see `Printer`."""

REGISTERS: Mapping[str, Mapping[str, type]] = {
    "Commands": requests.COMMANDS,
    "TextQuestions": requests.TEXT_QUESTIONS,
    "FolderQuestions": requests.FOLDER_QUESTIONS,
    "Works": requests.WORKS,
    "Words": requests.WORDS,
}


class Printer:
    """Prints records, those first that others name.

    Attributes
    ----------
    printed : dict
        By name, in the order in which they were met.
    """

    def __init__(self) -> None:
        self.printed: dict[str, str] = {}

    def type_of(self, annotation: Any, *, heard: bool) -> str:
        """Return an annotation as a type of TypeScript."""
        if isinstance(annotation, type) and (is_dataclass(annotation) or is_typeddict(annotation)):
            return self.record(annotation)
        if annotation is float and heard:
            return "number"
        if annotation in PLAIN:
            return PLAIN[annotation]
        return self._generic(get_origin(annotation), get_args(annotation), heard=heard)

    def _generic(self, origin: Any, kinds: tuple[Any, ...], *, heard: bool) -> str:
        if origin is Literal:
            return " | ".join(f'"{word}"' for word in kinds)
        if origin is NotRequired:
            return self.type_of(kinds[0], heard=heard)
        types = [self.type_of(kind, heard=heard) for kind in kinds if kind not in (Absent, ...)]
        if origin in (Union, UnionType):
            return " | ".join(dict.fromkeys(types))
        if origin is tuple and ... not in kinds:
            return f"[{', '.join(types)}]"
        if origin in (list, tuple, Sequence):
            return f"Array<{types[0]}>"
        if origin in (dict, Mapping):
            return f"Record<{types[0]}, {types[1]}>"
        raise TypeError(f"no type of TypeScript for {origin}")

    def record(self, kind: type) -> str:
        """Print a record unless it is there; return its name."""
        name = kind.__name__
        if name not in self.printed:
            lines = self._fields(kind)
            words = (kind.__doc__ or "").strip().partition("\n")[0]
            note = [] if is_typeddict(kind) and words.startswith("dict(") else [f"  /** {words} */"]
            more = ["    [key: string]: any;"] if kind in messages.OPEN else []
            body = [*note, f"  interface {name} {{", *lines, *more, "  }"]
            self.printed[name] = "\n".join(line for line in body if line != "  /**  */")
        return name

    def _fields(self, kind: Any) -> list[str]:
        heard = is_typeddict(kind)
        hints = get_type_hints(kind, include_extras=True)
        if heard:
            needed = {name: name in kind.__required_keys__ for name in hints}
            for name, hint in hints.items():
                needed[name] &= get_origin(hint) is not NotRequired
        else:
            needed = {
                each.name: each.default is MISSING and each.default_factory is MISSING
                for each in fields(kind)
            }
        types = {name: self.type_of(hints[name], heard=heard) for name in hints}
        marks = {name: "" if required else "?" for name, required in needed.items()}
        return [f"    {json_name(name)}{marks[name]}: {types[name]};" for name in hints]


def printed_types() -> str:
    """Return the text of the file."""
    printer = Printer()
    registers = []
    for title, register in REGISTERS.items():
        rows = [f'    "{name}": {printer.record(kind)};' for name, kind in register.items()]
        registers.append("\n".join([f"  interface {title} {{", *rows, "  }"]))
    heard = [printer.record(kind) for kind in messages.HEARD]
    union = f"  type Heard =\n{chr(10).join(f'    | {name}' for name in heard)};"
    return HEAD + "\n\n".join([*printer.printed.values(), *registers, union]) + "\n}\n"


def main() -> int:
    """Write the file."""
    FILE.write_text(printed_types(), encoding="utf-8")
    sys.stdout.write(f"{FILE}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
