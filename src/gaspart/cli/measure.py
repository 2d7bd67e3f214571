"""`gaspart measure`: observables of a trajectory, with uncertainties and theory."""

from __future__ import annotations

import argparse
import io
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.analysis.names import OBSERVABLES, measure
from gaspart.cli.arguments import Parser, UsageError, add_trajectory, print_line, real, set_command
from gaspart.cli.progress import waiting
from gaspart.errors import SceneError
from gaspart.files import Kind, begins_with, output_path, writing

if TYPE_CHECKING:
    from gaspart.analysis.observable import Observable

