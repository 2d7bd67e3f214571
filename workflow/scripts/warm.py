"""Compile the kernels that the task on the command line needs."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "src"))

from gaspart.planning.variants import warm

warm(sys.argv[1])
