"""`python -m mauve` is the command line."""

import sys

from mauve.cli import main

sys.exit(main())
