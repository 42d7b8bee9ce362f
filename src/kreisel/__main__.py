"""Turns Ctrl-C at any moment, that of loading the command line included, into one line and exit code 130."""

import sys


def main() -> int:
    """Run the command line; returns the exit code."""
    try:
        from kreisel.cli.main import main as run

        return run()
    except KeyboardInterrupt:
        sys.stderr.write("kreisel: interrupted; nothing half-written was left behind\n")
        return 130


if __name__ == "__main__":
    raise SystemExit(main())
