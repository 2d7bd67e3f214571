"""Theory of hard discs and spheres: formulas, their sources and their ranges of validity.

The package is independent of the engines and imports only numpy. Every docstring names the source of its
formula. "Exact" marks a formula that holds without approximation. "Literature" marks a published formula,
with the parts that were derived again or tested here. "Computed" marks numerical results of this project.
Formulas that were not verified are marked as such. Functions raise SceneError, which is a ValueError, if an
argument is out of range.

An array as an argument gives an array of the same shape. Units stand in brackets; a result without brackets
is a number without a unit. These arguments mean the same in all functions, which describe only other
arguments and other ranges:

- `dimension`: 2 for discs, 3 for spheres.
- `packing_fraction`: eta, from 0 to 0.70 for discs, to 0.539 for spheres.
- `diameter` sigma [length], `mass` m [mass], `temperature` k_B T [energy] of the particles; default 1.
- `count`: number N of particles.
- `contact`: pair distribution at contact, chi; by default `contact_value`, 1 for a gas of points.
- `density`: number density [1/length^d]. `time` t [time]. `speed` v [length/time].
- `restitution`, `normal`: coefficient of normal restitution e, from 0 to 1. `inertia`: q = I / (m R^2).
- `diameters` [length], `masses` [mass] and `fractions` (of the number; default: equal) of the species.
- `theory`: "santos", "linear", or for spheres "boublik". `distance`: r of two centres. `wave_number`: k.
- `hot`, `cold`: temperatures T_1 and T_2 of two walls [energy].
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__)
