"""The command line, as ``fuzzyarm`` and as ``python -m fuzzyarm``."""

import sys

from fuzzyarm import interrupts


def main() -> int:
    """Run the command of this process; Ctrl-C ends it in one line, while modules load as well."""
    try:
        interrupts.leave()
        from fuzzyarm.apps.cli.main import main as run

        status = run()
        interrupts.ignore()
    except BaseException as error:
        if isinstance(error, SystemExit) or not interrupts.heard:
            raise
        interrupts.ignore()
        sys.stderr.write("fuzzyarm: interrupted\n")
        status = interrupts.INTERRUPTED
    if status == interrupts.INTERRUPTED:
        interrupts.end_interrupted()
    return status


if __name__ == "__main__":
    sys.exit(main())
