"""Keys of a point that describe its scene, its engine and its length.

Each key has its kind, default and meaning. The keys of a job are defined in its module in
`reproduction.jobs`. `config_keys` has the keys of a complete config.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gaspart import engines
from gaspart.analysis.observables import observables_with
from gaspart.keys import POSITIVE, TEXT, Kind, choice, count, describe, flag, positive, schema_of
from gaspart.scene.sizes import DISTRIBUTIONS

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point


PREFIX = "scene."
"""Prefix of a key that replaces a value of the scene file, such as ``scene.species.0.mass``."""

_PER_AXIS = {"minItems": 2, "maxItems": 3}

EXTENTS: dict[str, Kind] = {
    "count": count("number of particles", default=None),
    "radius": positive("radius of a particle", default=None),
    "packing_fraction": positive(
        "area or volume of all particles over that of the container", exclusiveMaximum=1, default=None
    ),
    "side": describe(
        {**POSITIVE, "type": ["number", "array"], "items": POSITIVE, **_PER_AXIS},
        "side length of the container, or one for each axis",
        default=None,
    ),
}
"""Extents of a gas; exactly three are given, and the fourth is computed."""

GAS: dict[str, Kind] = {
    "dimension": choice("2 for discs, 3 for spheres; required", 2, 3, default=None),
    "boundary": describe(
        {"type": ["string", "array"]}, "`wall` or `periodic`, or one of them for each axis", default="wall"
    ),
    "centres_to_walls": flag(
        "walls stop the centres of particles, not their surfaces (the rule of Frederickx and Meerts, 2010)",
        default=False,
    ),
    "mass": positive("mass of a particle", default=1.0),
    "size_ratio": positive(
        "radius of the particles of a second species over that of the first, whose `radius` is given",
        maximum=1,
        default=None,
    ),
    "small_fraction": positive(
        "number of these smaller particles over that of all; required with `size_ratio`",
        exclusiveMaximum=1,
        default=None,
    ),
    "polydispersity": positive(
        "standard deviation of the radii over their mean, which is the `radius`", maximum=1, default=None
    ),
    "radius_distribution": choice(
        "of the radii, with `polydispersity`", *DISTRIBUTIONS, default=DISTRIBUTIONS[0]
    ),
    "temperature": positive("temperature of the Maxwellian velocities at the start", default=None),
    "exact_temperature": flag(
        "the velocities are scaled to exactly the `temperature`, without a mean velocity along axes on which "
        "momentum is conserved",
        default=False,
    ),
    "speed": positive(
        "instead of `temperature`: one speed for all particles, in random directions", default=None
    ),
    "arrangement": choice(
        "initial positions; `slab` is a lattice whose empty sites all lie in the upper half of the longest "
        "side, `compressed` grows the particles to a density beyond that of random insertion",
        *("random", "lattice", "slab", "compressed"),
        default="random",
    ),
}
"""Keys of one species in a container, or of two species of different sizes."""

SCENE_FILE: dict[str, Kind] = {
    "scene": describe(
        {**TEXT, "minLength": 1},
        "path of a scene file, instead of all keys above; it runs by itself with `gaspart run`",
        default=None,
    )
}

ENGINE: dict[str, Kind] = {
    "engine": choice(
        "`auto` is the cheapest engine for an `accuracy`, with its time step and precision or model, and "
        "the length of the run if none is given (see `gaspart advise`)",
        *(*engines.ENGINES, "auto"),
        default="event",
    )
}

_BOXES_PER_PARTICLE = positive(
    "instead of `boxes_per_side`: nearly cubic boxes, so many for each particle, none smaller than a "
    "diameter",
    default=None,
)


def _settings(engine: Any) -> dict[str, Kind]:
    """Return the keys of an engine, from its fields. Points with another engine do not require them."""
    declared = schema_of(engine)
    kinds = {name: Kind({"default": None, **kind}) for name, kind in declared["properties"].items()}
    for name in declared.get("required", ()):
        kinds[name]["description"] += "; required"
    return {**kinds, **({"boxes_per_particle": _BOXES_PER_PARTICLE} if "boxes_per_side" in kinds else {})}


ENGINE_KEYS: dict[str, dict[str, Kind]] = {
    **{name: _settings(engine) for name, engine in engines.ENGINES.items()},
    "auto": {
        "accuracy": positive(
            "relative accuracy: standard error and bias; required", exclusiveMaximum=1, default=None
        ),
        "observable": choice(
            "observable whose accuracy it is", *observables_with(tabulated=True), default="Z"
        ),
    },
}
"""Keys that have a meaning for each engine."""

LENGTHS: dict[str, Kind] = {
    "collisions_per_particle": positive(
        "length in collisions per particle (each collision counts for two), which become time by Enskog's "
        "rate: for one species of smooth particles and nothing else",
        default=None,
    ),
    "duration": positive("length in the scene's time", default=None),
    "steps": count("length in time steps; needs an engine that makes steps", default=None),
}
"""Keys of the length of a run; exactly one is given."""

SCANS = ("scan_boxes_per_side", "scan_boxes_per_particle", "scan_time_steps", "scan_step_parts")
"""Keys of jobs that run several engines alternately."""


# The end of the runs of a point with `until`. It is computed here instead of in the job, whose module must
# not depend on the analysis.


def ending(point: Point) -> dict[str, Any]:
    """Return the fields of `Recipe` that follow from `until`. Raises SceneError for accuracies that no run
    can reach.
    """
    from gaspart.runs.ending import Accuracy, contents_until, default_sample_interval
    from gaspart.trajectory.run_options import Until, contents_of

    settings, times = point.settings, point.schedule
    start = times.equilibration if "equilibration" in settings else None
    accuracies = tuple(Accuracy.from_name(name, value, start) for name, value in settings["until"].items())
    until = Until(accuracies, times.duration)
    contents = contents_until(until, point.scene, point.engine, contents_of(settings), from_state=False)
    interval = times.sample_interval
    if "samples" not in settings:
        interval = default_sample_interval(point.scene, point.engine, None)
    return {
        "duration": None,
        "sample_interval": interval,
        "until": until,
        "displacements": contents.displacements,
    }
