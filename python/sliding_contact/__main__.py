"""`python -m sliding_contact`, which is the command `sliding-contact`."""

import sys

from ._commands import main

if __name__ == "__main__":
    sys.exit(main())
