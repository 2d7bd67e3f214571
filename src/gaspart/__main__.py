"""`python -m gaspart`: the command line."""

import sys

from gaspart.cli import main

sys.exit(main())
