"""The planted errors of engines and of theory, each with the cell that catches it; see `planting.Plant`."""

from exact.planting import Plant

_DSMC, _STEP, _FACES = "engines.dsmc.arrays", "engines.step.arrays", "engines.features.faces"

# fmt: off
_ROWS = (
    ("cells over the container", _DSMC, "volume=float(((upper - lower) / per_side).prod())",
     "volume=float((np.array(scene.container.lengths) / per_side).prod())",
     ("masses_walls", "collision_rate", "dsmc")),
    ("kinetic gas up to a nearer wall", _DSMC, "margin=float(not scene.centres_to_walls)",
     "margin=0.9 * float(not scene.centres_to_walls)", ("masses_walls", "density", "dsmc")),
    ("contact values of a denser gas", _DSMC, "ball_volume(d) / volume", "1.5 * ball_volume(d) / volume",
     ("periodic", "Z", "enskog")),
    ("contact values to first order", _DSMC, "bend=BEND[d]", "bend=0.0", ("halves", "Z", "enskog")),
    ("half of the slope of contact values", _DSMC, "slope=SLOPE[d]", "slope=0.5 * SLOPE[d]",
     ("periodic", "collision_rate", "enskog")),
    ("areas of the other sizes", _DSMC, "Accessible(scene).areas(radius)",
     "Accessible(scene).areas(radius[::-1])", ("sizes_near", "pressure", "dsmc")),
    ("virial of half", "engines.dsmc.dynamics", "float(exact_parts(workspace.virial)[0])",
     "0.5 * float(exact_parts(workspace.virial)[0])", ("halves", "Z", "enskog")),
    ("shear of the other sign", "engines.dsmc.dynamics", '{"wall_shear": exact_parts(',
     '{"wall_shear": -exact_parts(', ("masses_slit", "momentum", "dsmc")),
    ("stress about rest", "engines.dsmc.dynamics", "drift_of(scene, state))", "0.0 * drift_of(scene, state))",
     ("wind", "pressure_tensor", "dsmc")),
    ("heat of faces twice", "engines.stepped", "wall_energy=self._heat.sum(axis=1) *",
     "wall_energy=2.0 * self._heat.sum(axis=1) *", ("accommodating", "energy", "step")),
    ("half of the kicks", "engines.stepped", "thermostat_energy=net(", "thermostat_energy=0.5 * net(",
     ("kicked", "energy", "dsmc")),
    ("lost energy once more", "engines.stepped", "dissipated_energy=net(", "dissipated_energy=2.0 * net(",
     ("granular", "energy", "step")),
    ("stepped gas up to a nearer wall", _STEP, "real(not scene.centres_to_walls)",
     "real(0.9 * (not scene.centres_to_walls))", ("masses_walls", "density", "step")),
    ("impulses 5 % too small", _STEP, "real(0.5 * (1.0 + normal))", "real(0.475 * (1.0 + normal))",
     ("periodic", "energy", "step")),
    ("reservoirs too hot", _FACES, "math.sqrt(face.temperature / scene",
     "math.sqrt(2.0 * face.temperature / scene",
     ("open", "temperature", "dsmc")),
    ("reservoirs of half", _FACES, "rates[number] = attempt_rate", "rates[number] = 0.5 * attempt_rate",
     ("open", "number", "event")),
    ("entries twice", _FACES, "np.pad(self._inside.entries", "np.pad(2 * self._inside.entries",
     ("open", "bodies", "event")),
    ("all are partners", "analysis.expected.equilibrium", "return 1.0 - 1.0 / run.count", "return 1.0",
     ("halves", "Z", "event")),
    ("theory of Maxwell at half the temperature", "analysis.expected.equilibrium",
     "run.dimension, run.temperature, mass, int", "run.dimension, 0.5 * run.temperature, mass, int",
     ("periodic", "speeds", "event")),
    ("scale height of half", "analysis.expected.places", "weight = kind.mass * abs(field)",
     "weight = 2.0 * kind.mass * abs(field)", ("points_in_gravity", "density", "dsmc")),
    ("theory of the whole weight on each face", "analysis.expected.flows", "/ (2.0 * area)", "/ area",
     ("driven_channel", "wall_shear", "event")),
    ("uniform density of half", "analysis.expected.places", "(scene.number_density, 0.0, ",
     "(0.5 * scene.number_density, 0.0, ", ("halves", "density", "event")),
)
# fmt: on
ENGINE_PLANTS = [Plant(*row) for row in _ROWS]
"""Planted errors of engines and of theory."""
