"""Compile the kernels of the variant that is named on the command line."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "src"))

from gaspart.variants import warm

warm(sys.argv[1])
