"""Theory of hard discs and spheres: formulas, provenance, range of validity.

Independent of the engines; imports only numpy. Every docstring states the source of its formula: exact
(closed form), literature (and what of it was derived again or tested here), computed (this project's own
numerics). What was not verified is said to be so. Arguments that are out of range raise SceneError, which
is a ValueError.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__, for_users=True)
