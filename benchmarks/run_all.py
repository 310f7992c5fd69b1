"""Run every benchmark of this folder, one after the other.

    python benchmarks/run_all.py [--fuzzylite ENV/bin/python] [--write]

The options go to those that know them. Nothing is skipped silently: what a part needs
and does not find (a C compiler, a peer) it says itself.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from pathlib import Path

PARTS = {
    "goals": "first runs, single points, infer beside compiled, scaling",
    "inference": "a table against pyfuzzylite; the start of a check",
    "compiled": "compiled inference against C and peers",
    "lookup": "table look-up against C; memory of a large table",
    "closed_loop": "closed loops against C",
    "sweeps": "many runs of the arm",
    "controllers": "exported controllers against the kernel",
    "learning": "rule bases from samples beside regression, boosting and peers",
    "tuning": "tuned controllers on what was not seen, beside a tuned line; an hour",
    "step_cost": "operations and time of a control step of every controller",
    "designer": "the designer in a browser: frames, key strokes, first paint, bytes",
    "keystroke": "the editor's answer to a key",
    "proofs": "proved bounds, with their targets",
}
WITH_WORDS = {"compiled"}
READS_ARGV = {"inference"}


def main() -> int:
    """Run what is there."""
    sys.path.insert(0, str(Path(__file__).parent))
    words = sys.argv[1:]
    present = [name for name in PARTS if importlib.util.find_spec(name) is not None]
    failed = []
    for number, name in enumerate(present, 1):
        print(f"[{number}/{len(present)}] {name}: {PARTS[name]}", file=sys.stderr, flush=True)
        print(f"\n## {name}\n", flush=True)
        module = importlib.import_module(name)
        sys.argv = [name, *([word for word in words if word != "--write"] * (name in READS_ARGV))]
        try:
            module.main(words) if name in WITH_WORDS else module.main()
        except (Exception, SystemExit) as error:
            if isinstance(error, SystemExit) and not error.code:
                continue
            failed.append(name)
            print(f"{name} failed: {error}", file=sys.stderr)
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
