"""``python -m cardiosurf``: the command line."""

import sys

from cardiosurf.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
