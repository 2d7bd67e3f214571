"""Arguments out of range: an error instead of a wrong number, whatever the formula."""

import inspect
import pkgutil
from importlib import import_module

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory
from gaspart.theory import geometry as _arguments

GOOD = {"packing_fraction": 0.1, "dimension": 3, "width": 3.0, "length": 9.0, "collisions": 2.0, "hot": 2.0}
GOOD |= {"inertia": 0.5, "tangential": 0.5, "restitution": 0.9, "energy": 5.0, "count": 8, "probability": 0.5}
GOOD |= {"z": np.linspace(0.0, 5.0, 11), "numbers": [0.1], "weights": [0.1], "reach": 1.0, "per_side": 3}
GOOD |= {"mean": 12.0, "variance": 3.0, "compressibility_factor": 9.0, "density": 0.5, "bulk_density": 0.5}
GOOD |= {"diameters": [1.0, 0.5], "quantity": "viscosity"}
GOOD |= {"side_over_diameter": 9.0, "boundary": "wall", "radius": 0.5, "side": 9.0}


MODULES = [import_module(f"gaspart.theory.{one.name}") for one in pkgutil.iter_modules(theory.__path__)]
FORMULAS = {name: getattr(theory, name) for name in dir(theory)}
FORMULAS |= {key: one for part in MODULES for key, one in vars(part).items() if hasattr(one, "__wrapped__")}


def cases():
    """(name of a function, name of one of its arguments that has a range)."""
    for name, function in FORMULAS.items():
        if inspect.isfunction(function):
            for argument in inspect.signature(function).parameters:
                if argument in _arguments._RANGES:
                    yield name, argument


@pytest.mark.parametrize(("name", "argument"), list(cases()))
def test_what_is_out_of_range_is_refused(name, argument):
    function = FORMULAS[name]
    parameters = inspect.signature(function).parameters.values()
    required = {p.name: GOOD.get(p.name, 1.0) for p in parameters if p.default is p.empty}
    least, most, _ = _arguments._RANGES[argument]
    wrong = [np.nan, np.inf, -np.inf, np.array([1.0, np.nan])]
    wrong += [np.nextafter(least, -np.inf), np.nextafter(most, np.inf)]
    if name != "conducting_slab":  # which returns more than numbers
        assert np.all(np.isfinite(np.asarray(function(**required), dtype=float)))
    for value in wrong:
        with pytest.raises(gp.SceneError, match=f"^{argument} = ") as caught:
            function(**(required | {argument: value}))
        assert isinstance(caught.value, ValueError) and "\n" not in str(caught.value)
