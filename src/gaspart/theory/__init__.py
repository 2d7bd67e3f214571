"""Theory of hard discs and spheres: formulas, their sources and their ranges of validity.

The package is independent of the engines and imports only numpy. Every docstring names the source of its
formula. "Exact" marks a formula that holds without approximation. "Literature" marks a published formula,
with the parts that were derived again or tested here. "Computed" marks numerical results of this project.
Formulas that were not verified are marked as such. Functions raise SceneError, which is a ValueError, if an
argument is out of range.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__)
