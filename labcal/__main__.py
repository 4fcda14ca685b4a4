"""``python -m labcal`` is ``labcal``."""

import sys

from labcal.cli import main

if __name__ == "__main__":
    sys.exit(main())
