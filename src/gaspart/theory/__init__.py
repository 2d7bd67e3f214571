"""Theory of hard discs and spheres: formulas, provenance, range of validity.

The package is independent of the engines and imports only numpy. Every docstring names the source of its
formula. "Exact" means a closed form. "Literature" names the parts that were derived again or tested here.
"Computed" means numerical results of this project. Formulas that were not verified are marked. Arguments that
are out of range raise SceneError, which is a ValueError.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__, for_users=True)
