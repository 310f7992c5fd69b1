"""What ``compile`` says of exported source text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fuzzyarm.export import Exported


def export_data(exported: Exported, tables: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the report as JSON data; `tables` are those that were compiled on the way."""
    return {
        "files": [str(path) for path, _ in exported.files],
        "functions": [
            {
                "call": call,
                "output": routine.output.name,
                "arguments": [argument.name for argument in routine.arguments],
                "type": routine.kind,
                "worst": routine.accuracy().worst,
                "points": routine.accuracy().points,
                "against": routine.accuracy().against,
                "operations": dict(routine.cost().operations),
                "stack": routine.cost().stack,
            }
            for call, routine in zip(exported.calls, exported.routines, strict=True)
        ],
        "tables": tables,
    }


def export_words(exported: Exported) -> str:
    """Return the report as lines of text."""
    from fuzzyarm.show.words import number_words

    lines = []
    for path, text in exported.files:
        lines.append(f"{path}: {len(text.encode()):,} bytes of source")
    for call, routine in zip(exported.calls, exported.routines, strict=True):
        accuracy, cost = routine.accuracy(), routine.cost()
        lines.append(call)
        lines.append(
            f"  worst error against {accuracy.against}: {number_words(accuracy.worst, 3)}"
            f" (of {accuracy.points:,} points)"
        )
        lines.append(f"  at most {cost.in_words()}")
    return "\n".join(lines)
