"""Run `fuzzylite_runner.py` in an environment of its own, which is made where it is missing.

pyfuzzylite is under the GPL and needs NumPy below 2; nothing of this project depends on it.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PLACE = HERE.parent.parent / "build" / "conformance" / "pyfuzzylite"
NEEDED = ["pyfuzzylite==8.0.6", "numpy<2"]


def main() -> int:
    """Make the environment once, then become the runner."""
    python = PLACE / "bin" / "python"
    ready = PLACE / ".ready"
    if not ready.exists():
        subprocess.run([sys.executable, "-m", "venv", str(PLACE)], check=True, stdout=sys.stderr)
        words = [
            str(python),
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            *NEEDED,
        ]
        done = subprocess.run(words, check=False, stdout=sys.stderr)
        if done.returncode:
            print("pyfuzzylite could not be installed: is there a registry?", file=sys.stderr)
            return 1
        ready.touch()
    os.execv(python, [str(python), str(HERE / "fuzzylite_runner.py")])


if __name__ == "__main__":
    sys.exit(main())
