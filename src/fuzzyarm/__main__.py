"""``python -m fuzzyarm`` is the command line."""

import sys

from fuzzyarm.cli import main

sys.exit(main())
