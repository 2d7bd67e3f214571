"""The same run in other units of mass, length and time: factors of powers of two, which change no bit."""

import json
from dataclasses import fields, replace

import numpy as np
from battery.units import Powers, powers_of

import gaspart as gp
from gaspart.engines import engine_from_dict, engine_to_dict
from gaspart.scene.surfaces import FACES
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
    **dict.fromkeys(("corner", "start", "end"), Powers(length=1)),
    "edges": Powers(length=1),
    "velocity": _SPEED,
    "speed": _SPEED,
    "reference_speed": _SPEED,
    "position": Powers(length=1),
    "region": Powers(length=1),
    "width": Powers(length=1),
    "skin": Powers(length=1),
    "depth": _ENERGY,
    "vibration": _ENERGY,
    "momentum": Powers(1, 1, -1),
    "moment_of_inertia": Powers(1, 2, 0),
    "spin": Powers(0, 0, -1),
    "contact_duration": Powers(time=1),
    "gravity": Powers(0, 1, -2),
    "shear_rate": Powers(0, 0, -1),
    "amplitude": Powers(length=1),
    "period": Powers(time=1),
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
STATE = {
    "time": Powers(time=1),
    "positions": Powers(length=1),
    "velocities": _SPEED,
    "lengths": Powers(length=1),
    "radii": Powers(length=1),
    "masses": Powers(mass=1),
    "moments_of_inertia": Powers(1, 2, 0),
    "spins": Powers(0, 0, -1),
    "gravity": Powers(0, 1, -2),
    "well_energies": _ENERGY,
    "vibrations": _ENERGY,
    "displaced": Powers(length=1),
    "shear_rate": Powers(0, 0, -1),
}
"""Field of a state -> its units, but for the piston's place and velocity; the others are numbers."""


def scaled(values, units, key="", dimension=3):
    """Numbers of a mapping in the other units."""
    if isinstance(values, dict):
        return {name: scaled(value, units, name, dimension) for name, value in values.items()}
    if isinstance(values, list | tuple):
        return [scaled(value, units, key, dimension) for value in values]
    if isinstance(values, bool | str) or values is None:
        return values
    powers = Powers(1, 2 - dimension, -2) if key == "pressure" else KEYS[key]
    factor = powers.scale(**units)
    return values if factor == 1.0 else values * factor


def scene_in_units(scene, units=UNITS):
    """A scene in the other units."""
    return gp.Scene.from_dict(scaled(scene.to_dict(), units, dimension=scene.dimension))


def engine_in_units(engine, units=UNITS):
    """An engine in the other units."""
    return engine_from_dict(scaled(engine_to_dict(engine), units))


def state_in_units(state, units=UNITS):
    """A state in the other units."""
    changed = {key: getattr(state, key) * powers.scale(**units)
               for key, powers in STATE.items() if getattr(state, key) is not None}  # fmt: skip
    if state.piston is not None:
        changed["piston"] = state.piston * [STATE[key].scale(**units) for key in ("positions", "velocities")]
    return replace(state, **changed)


def tally_in_units(tally, dimension, units=UNITS):
    """A tally in the other units."""
    declared = {field.name: field.metadata["units"] for field in fields(tally) if "units" in field.metadata}
    declared["time"] = "time"
    factors = {name: powers_of(text, dimension).scale(**units) for name, text in declared.items()}
    present = {name: getattr(tally, name) for name in factors if getattr(tally, name) is not None}
    return replace(tally, **{name: value * factors[name] for name, value in present.items()})


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
        attributes["tallies"] = json.dumps(scaled(json.loads(data.attrs["tallies"]), UNITS))
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
