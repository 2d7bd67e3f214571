"""The keys of a config: kind, default and meaning of each, declared once.

Validation, the table of each engine's keys, the JSON schema and the reference page follow from these tables.
A figure's own settings are declared in the `__init__.py` of its family.
"""

from __future__ import annotations

from typing import Any

from gaspart import engines
from gaspart.kinds import (
    COUNT,
    NOT_NEGATIVE,
    POSITIVE,
    TEXT,
    Kind,
    choice,
    count,
    described,
    flag,
    listed,
    nullable,
    positive,
    record,
)
from gaspart.scene.keys import schema_of

PREFIX = "scene."
"""Start of a key that replaces a value of the scene file: ``scene.species.0.mass``."""

_PER_AXIS = {"minItems": 2, "maxItems": 3}
_NAME = {"pattern": r"^[a-z][a-z0-9_]*$(?!\n)", "maxLength": 100}  # $ matches before a final line break too

EXTENTS: dict[str, Kind] = {
    "count": count("number of particles", default=None),
    "radius": positive("radius of a particle", default=None),
    "packing_fraction": positive(
        "area or volume of all particles over that of the container", exclusiveMaximum=1, default=None
    ),
    "side": described(
        {**POSITIVE, "type": ["number", "array"], "items": POSITIVE, **_PER_AXIS},
        "side length of the container, or one for each axis",
        default=None,
    ),
}
"""Exactly three of them are given; the fourth follows."""

GAS: dict[str, Kind] = {
    "dimension": choice("2 for discs, 3 for spheres; required", 2, 3, default=None),
    "boundary": described(
        {"type": ["string", "array"]}, "`wall` or `periodic`, or one of them for each axis", default="wall"
    ),
    "centres_to_walls": flag(
        "walls stop the centres of particles, not their surfaces (the rule of Frederickx and Meerts, 2010)",
        default=False,
    ),
    "mass": positive("mass of a particle", default=1.0),
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
"""One species in a container."""

SCENE_FILE: dict[str, Kind] = {
    "scene": described(
        {**TEXT, "minLength": 1},
        "path of a scene file, instead of all keys above; it runs by itself with `gaspart run`",
        default=None,
    )
}

ENGINE: dict[str, Kind] = {
    "engine": choice(
        "`auto` is the cheapest engine for an `accuracy`, with its time step and precision, and the length "
        "of the run if none is given (see `gaspart advise`)",
        *(*engines.ENGINES, "auto"),
        default="event",
    )
}

_BOXES_PER_BODY = positive(
    "instead of `boxes_per_side`: nearly cubic boxes, so many for each particle, none smaller than a "
    "diameter",
    default=None,
)


def _settings(engine: Any) -> dict[str, Kind]:
    """The keys of an engine, as its fields declare them. What it requires, a point with another does not."""
    declared = schema_of(engine)
    made = {name: {"default": None, **kind} for name, kind in declared["properties"].items()}
    for name in declared.get("required", ()):
        made[name]["description"] += "; required"
    return {**made, **({"boxes_per_body": _BOXES_PER_BODY} if "boxes_per_side" in made else {})}


ENGINES: dict[str, dict[str, Kind]] = {
    **{name: _settings(engine) for name, engine in engines.ENGINES.items()},
    "auto": {
        "accuracy": positive(
            "relative accuracy, half of a 95 % interval; required", exclusiveMaximum=1, default=None
        ),
        "observable": choice("observable whose accuracy it is", "Z", "collision_rate", "D", default="Z"),
    },
}
"""The keys that each engine has a meaning for."""

SCANS: dict[str, Kind] = {
    "scan_boxes_per_side": listed(
        COUNT, "`measure_cost`: numbers of boxes per side that one job times in turn", default=None
    ),
    "scan_boxes_per_body": listed(
        POSITIVE, "`measure_cost`: numbers of boxes per particle that one job times in turn", default=None
    ),
    "scan_time_steps": listed(
        POSITIVE,
        "`measure_cost`, `compare`: time steps that one job runs in turn; the length of the run is in "
        "multiples of `time_step`",
        default=None,
    ),
}

LENGTHS: dict[str, Kind] = {
    "collisions_per_body": positive(
        "length in collisions per particle (each collision counts for two), which become time by Enskog's "
        "rate: for one species of smooth particles and nothing else",
        default=None,
    ),
    "duration": positive("length in the scene's time", default=None),
    "steps": count("length in time steps; needs an engine that makes steps", default=None),
}
"""Exactly one of them is given."""

RUN: dict[str, Kind] = {
    "equilibration": described(
        NOT_NEGATIVE,
        "time before the length, in the same unit; rounded up to whole samples, which are not measured",
        default=0,
    ),
    "samples": count(
        "number of intervals of the length. `simulate`: a frame at the end of each; `measure_cost`: timings "
        "of one interval; `compare`: initial states, an interval apart; `echo`: echoes after 1, 2 ... "
        "intervals",
        default=1,
    ),
    "displacements": flag(
        "`simulate`: keep displacements in float64, for mean-squared displacements", default=False
    ),
    "lags": count(
        "`simulate`: accumulate time correlations of all samples up to so many intervals apart, but at most "
        "half the length, and keep the first and the last frame only; with `displacements` of these too",
        default=None,
    ),
    "follow": count(
        "`simulate`: keep only the first so many particles (single `bodies` come first, then `species`); "
        "counters and energies are those of all",
        default=None,
    ),
    "replicas": count("independent runs within the point's job", maximum=10_000, default=1),
    "attempts": count(
        "`fill`, `pack`: positions tried for each particle of `count`, of which not all need fit",
        default=None,
    ),
    "record_events": flag("`measure_cost`, engine `event`: record all events", default=False),
    "without": described(
        {"type": "array", "items": TEXT, "minItems": 1},
        "`measure_cost`: keys that a second scene and engine lack, which are timed in turn with the point's",
        default=None,
    ),
}


def _of_any_engine() -> dict[str, Kind]:
    """The keys of all engines; what one means is stated for each engine that has another meaning of it."""
    found: dict[str, Kind] = {}
    for engine, keys in ENGINES.items():
        for name, kind in keys.items():
            meaning = kind["description"]
            known = found.setdefault(name, {**kind, "default": None})["description"]
            if meaning not in known:
                found[name] = {**found[name], "description": f"{known}; {engine}: {meaning}"}
    return found


POINT: dict[str, Kind] = {
    name: kind if name == "dimension" else nullable(kind)
    for name, kind in (EXTENTS | GAS | SCENE_FILE | ENGINE | _of_any_engine() | SCANS | LENGTHS | RUN).items()
}
"""All keys of a point; null takes a key back."""

WHOLE = frozenset(
    name
    for name, kind in POINT.items()
    if kind.get("type") == ["integer", "null"] or all(isinstance(item, int) for item in kind.get("enum", "-"))
)
"""Keys of whole numbers, which may be written 1e3."""

JOBS = {
    "simulate": "trajectories",
    "measure_cost": "counted work and timings, with nothing running beside them",
    "compare": "time-stepped runs beside exact ones from the same states",
    "echo": "runs forward and back",
    "fill": "random insertion, every failure counted",
    "pack": "random insertion until nothing more fits; with `arrangement: compressed` growth until all jam",
    "count_instructions": "the machine code of both engines for the scene, with and without the source of "
    "absent features",
}

_BLOCK: Kind = {"type": "object"}  # each value is checked against its key's kind
EXPERIMENT: dict[str, Kind] = {
    "job": choice("; ".join(f"`{name}`: {made}" for name, made in JOBS.items()), *JOBS, default="simulate"),
    "point": record(POINT, "the settings that all points share", patternProperties={r"^scene[.]": {}}),
    "grid": {
        "anyOf": [_BLOCK, listed(_BLOCK)],
        "default": None,
        "description": "the settings that vary: a mapping from a key to the list of its values, of which the "
        "product is taken, or a list of such mappings, one after the other; a single value counts as a list "
        "of one",
    },
}

ANIMATION: dict[str, Kind] = {
    "experiment": described(TEXT, "the experiment whose first point's first replica is filmed"),
    "size": listed(
        {"type": "integer", "minimum": 16}, "width and height in pixels", 2, 2, default=[1000, 750]
    ),
    "colour": choice("what the colour of a particle shows", "speed", "species", default="speed"),
    "frames_per_second": positive("pictures per second", default=25.0),
    "trail": count("number of a disc whose path is drawn", 0, default=None),
    "clock": flag(
        "write parameters, the meaning of the colours, time and scale above and below the pictures",
        default=False,
    ),
    "figure": described(TEXT, "the figure beside which the report shows the film", default=None),
}


def config(figures: dict[str, Kind]) -> dict[str, Kind]:
    """The top level of a config, given the entries of its figures."""
    named = {"type": "object", "propertyNames": _NAME}
    return {
        "title": described({**TEXT, "minLength": 1}, "stands in the report and in each figure's data"),
        "seed": count(
            "with the names of experiment, point and replica it gives every random stream", minimum=0
        ),
        "points": described(
            {**TEXT, "pattern": r"^results(/[A-Za-z0-9_.-]*[A-Za-z0-9_-])+$(?!\n)", "maxLength": 200},
            "the folder of the simulations; figures, claims and report always lie in `results`",
        ),
        "experiments": described(
            {**named, "minProperties": 1, "additionalProperties": record(EXPERIMENT)}, "what is simulated"
        ),
        "figures": {
            "type": "object",
            "minProperties": 1,
            "additionalProperties": False,
            "properties": figures,
            "description": "what is drawn, and the settings of its measurement",
        },
        "animations": described(
            {**named, "additionalProperties": nullable(record(ANIMATION))},
            "films; null takes one back",
            default={},
        ),
    }
