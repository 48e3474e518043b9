"""Runs the program: ``python -m dvi run DRIVE -o OUT`` is ``dvi run DRIVE -o OUT``."""
import sys

from . import _dvi


def main() -> int:
    """Runs the command line of the process, and returns the exit code."""
    return _dvi.main(["dvi", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
