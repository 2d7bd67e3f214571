"""The figures, by family: found in the folders of this package.

The folder of a family states its `TITLE` and its `FIGURES` in `__init__.py`, which imports nothing heavy, and
holds a function of the name of each figure in `measure.py`, `claims.py` and `figure.py`.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pathlib import Path


@cache
def titles() -> dict[str, str]:
    """The title of each family, in alphabetical order of the families."""
    folder = Path(__file__).parent
    names = sorted(path.parent.name for path in folder.glob("*/figure.py"))
    return {name: import_module(f"gaspart.experiments.{name}").TITLE for name in names}


@cache
def families() -> dict[str, str]:
    """The family of each figure."""
    return {
        figure: name for name in titles() for figure in import_module(f"gaspart.experiments.{name}").FIGURES
    }
