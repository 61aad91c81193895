"""The ``atm`` command: ``python -m atm``."""

import signal
import sys

from atm._atm import _main


def main() -> int:
    """Run the command line of this process, and return its exit status."""
    # Ctrl-C ends the command as it ends any other: no Python code runs that could be told of it.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _main(["atm", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
