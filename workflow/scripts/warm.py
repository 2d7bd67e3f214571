"""Compile the kernels that the task on the command line needs."""

import gc
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "src"))

from gaspart.planning.variants import warm

gc.set_threshold(1_000_000)  # what the compiler makes stays until the end: some 3 % of its time
warm(sys.argv[1])
