"""The same run in other units of mass, length and time: factors of powers of two, which change no bit."""

import json
from dataclasses import replace

import numpy as np
from battery.units import Powers, powers_of

import gaspart as gp
from gaspart.engines import engine_from_dict, engine_to_dict
from gaspart.scene.faces import FACES
from gaspart.yaml_text import dump_yaml, parse_yaml

UNITS = {"mass": 2.0**4, "length": 2.0**-3, "time": 2.0**2}
"""What one of the old units is in new ones."""
_ENERGY, _SPEED, _NUMBER = Powers(1, 2, -2), Powers(0, 1, -1), Powers()
KEYS = {
    "lengths": Powers(length=1),
    "radius": Powers(length=1),
    "mass": Powers(mass=1),
    "temperature": _ENERGY,
    **dict.fromkeys(FACES, _ENERGY),
    "corner": Powers(length=1),
    "edges": Powers(length=1),
    "velocity": _SPEED,
    "speed": _SPEED,
    "gravity": Powers(0, 1, -2),
    "shear_rate": Powers(0, 0, -1),
    "amplitude": Powers(length=1),
    "period": Powers(time=1),
    "pressure": Powers(1, -1, -2),
    "power": Powers(1, 2, -3),
    "interval": Powers(time=1),
    "furthest": Powers(length=1),
    "time_step": Powers(time=1),
    **dict.fromkeys(
        (
            "accommodation",
            "activity",
            "count",
            "normal",
            "tangential",
            "polydispersity",
            "cells_per_side",
            "passes",
            "threads",
            "bins",
            "shells",
            "share",
        ),
        _NUMBER,
    ),
}
"""Key of a scene or an engine -> its units, of a face those of the temperature there. Another number in a
scene of the battery is a KeyError."""


def _scaled(values, key=""):
    """Numbers of a mapping in the other units."""
    if isinstance(values, dict):
        return {name: _scaled(value, name) for name, value in values.items()}
    if isinstance(values, list | tuple):
        return [_scaled(value, key) for value in values]
    if isinstance(values, bool | str) or values is None:
        return values
    factor = KEYS[key].scale(**UNITS)
    return values if factor == 1.0 else values * factor


def scene_in_units(scene):
    """A scene in the other units."""
    return gp.Scene.from_dict(_scaled(scene.to_dict()))


def engine_in_units(engine):
    """An engine in the other units."""
    return engine_from_dict(_scaled(engine_to_dict(engine)))


def state_in_units(state):
    """A state at time 0 in the other units."""
    length, speed = Powers(length=1).scale(**UNITS), _SPEED.scale(**UNITS)
    mass, moment = Powers(mass=1).scale(**UNITS), Powers(1, 2, 0).scale(**UNITS)
    return replace(
        state,
        positions=state.positions * length,
        velocities=state.velocities * speed,
        lengths=state.lengths * length,
        radii=state.radii * length,
        masses=state.masses * mass,
        moments_of_inertia=state.moments_of_inertia * moment,
    )


def _variables(data, dimension):
    """The variables of a trajectory or a result in the other units, by their attribute `units`."""
    found = {}
    for name, variable in data.variables.items():
        if variable.dtype.kind in "US":
            continue
        units = variable.attrs.get("units", "1")
        factor = powers_of(units, dimension).scale(**UNITS)
        values = variable.values if factor == 1.0 else np.asarray(variable.values * factor, variable.dtype)
        found[name] = (variable.dims, values, variable.attrs)
    return found


def data_in_units(data):
    """A trajectory, in memory, in the other units."""
    scene = scene_in_units(gp.Scene.from_dict(parse_yaml(data.attrs["scene"])))
    new = _variables(data, scene.dimension)
    result = data.assign({name: values for name, values in new.items() if name in data.data_vars})
    result = result.assign_coords({name: values for name, values in new.items() if name in data.coords})
    attributes = {"scene": dump_yaml(scene.to_dict())}
    if "engine" in data.attrs:
        engine = engine_from_dict(json.loads(data.attrs["engine"]))
        attributes["engine"] = json.dumps(engine_to_dict(engine_in_units(engine)))
    if "tallies" in data.attrs:
        attributes["tallies"] = json.dumps(_scaled(json.loads(data.attrs["tallies"])))
    if "correlations" in data.attrs:
        attributes["correlations"] = json.dumps(_correlations(json.loads(data.attrs["correlations"])))
    return result.assign_attrs(attributes)


def _correlations(settings):
    factor = Powers(time=1).scale(**UNITS)
    return {key: value * factor if key in ("interval", "start") else value for key, value in settings.items()}


def result_in_units(found, dimension=3):
    """A result in the other units."""
    new = _variables(found, dimension)
    result = found.assign({name: values for name, values in new.items() if name in found.data_vars})
    return result.assign_coords({name: values for name, values in new.items() if name in found.coords})
