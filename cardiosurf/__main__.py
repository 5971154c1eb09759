"""``python -m cardiosurf``: the command line."""

from cardiosurf.cli.main import main

if __name__ == "__main__":
    main()
