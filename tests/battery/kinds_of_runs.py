"""The runs that the battery looks at: a small one of each kind of scene under each engine that models it."""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.run import repeat_run
from gaspart.engines import Engine
from gaspart.errors import SceneError
from gaspart.reproduction.points.point import compiled_features
from gaspart.state.state import State
from gaspart.state.tally import ImpulseTally, PairImpulseTally, StressTally
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.reading import open_trajectory

FRAMES = 128
"""Intervals of a run, as those of a simulation that is run again; three quarters are measured."""
FEW = 8
"""Intervals of the runs that are compared with one another, before chaos takes over."""
SEED = 5
LAGS = 4
PERIODIC = "periodic"
STEPS = 4
"""Of a time step, in an interval between frames."""
BINS = 8
"""Of impulses."""
REACH, SHELLS = 0.4375, 7
"""Of impulses of pairs: the furthest distance, in the shortest side of the container, and the shells."""


@dataclass(frozen=True)
class Kind:
    """A kind of scene. interval: between frames, a power of two, in which a particle collides once at most;
    drift: of the initial state, added to what is drawn. moving: the axis along which a moving frame is the
    same scene; mirror: the axis that is mirrored; exchange: the order of the axes in which they are
    exchanged; each is the reason instead where the scene has no such symmetry. steady: why parts of the run
    may differ, "" if they may not. impulses: whether a run is made that keeps them along the axis `mirror`.
    """

    scene: gp.Scene
    interval: float = 0.125
    drift: tuple[float, ...] | None = None
    moving: int | str = 0
    mirror: int | str = 2
    exchange: tuple[int, ...] | str = (2, 0, 1)
    steady: str = ""
    impulses: bool = False


def _scene(lengths, boundary, *species, **rest):
    return gp.Scene(gp.Container(lengths, boundary), list(species), **rest)


def _gas(count=32, **properties):
    return gp.Species(count, **({"radius": 0.5, "temperature": 1.0} | properties))


def _across(sides, place, **properties):
    """A plate across z."""
    x, y = sides
    return gp.Plate((0.0, 0.0, place), ((x, 0.0, 0.0), (0.0, y, 0.0)), **properties)


_SLIT = (PERIODIC, PERIODIC, "wall")
_CUBE = (4.0, 4.0, 4.0)
_PLATES = {
    f"x_{side}": gp.Thermal(1.0, velocity=(0.0, sign * 1.5, 0.0), accommodation=fraction)
    for side, sign, fraction in (("low", -1, 1.0), ("high", 1, 0.75))
}
_AT_REST = "the walls are at rest"
_SMALL = gp.Plate((0.5, 0.5, 3.25), ((1.0, 0.0, 0.0), (0.0, 1.5, 0.0)), temperature=2.0)
_RAMPS = {
    "z_low": gp.Thermal({"x_low": 1.0, "x_high": 4.0}),
    "z_high": gp.Thermal({"x_low": 2.0, "x_high": 1.0}, accommodation=0.75),
}
KINDS = {
    "periodic": Kind(_scene(_CUBE, PERIODIC, _gas()), impulses=True),
    "walls": Kind(_scene((5.0, 5.0, 5.0), "wall", _gas(24)), moving=_AT_REST),
    "slit": Kind(_scene((4.0, 5.0, 6.0), _SLIT, _gas(24)), interval=0.25, impulses=True),
    "gravity": Kind(
        _scene((4.0, 4.0, 8.0), _SLIT, _gas(24), gravity=(0.0, 0.0, -0.25)), interval=0.25, impulses=True
    ),
    "lees_edwards": Kind(
        _scene(
            _CUBE,
            PERIODIC,
            _gas(),
            restitution=gp.Restitution(0.9),
            faces={"y_high": gp.LeesEdwards(0.75)},
        ),
        moving=2,
        exchange="sheared faces are those across y, which slide along x",
        mirror=0,
    ),
    "plates": Kind(
        _scene((6.0, 4.0, 4.0), ("wall", PERIODIC, PERIODIC), _gas(24), faces=_PLATES),
        interval=0.25,
        moving=1,
        mirror=0,
    ),
    "wind": Kind(_scene((4.0, 5.0, 4.0), PERIODIC, _gas()), drift=(1.5, -0.75, 0.5), impulses=True),
    "piston": Kind(
        _scene((4.0, 4.0, 8.0), _SLIT, _gas(24), faces={"z_high": gp.Piston(16.0, 0.5)}),
        interval=0.25,
        steady="the piston oscillates",
    ),
    "compressed": Kind(
        _scene((4.0, 4.0, 8.0), _SLIT, _gas(24), faces={"z_high": gp.Piston(speed=0.0625)}),
        interval=0.25,
        steady="the piston compresses the gas",
    ),
    "parted": Kind(
        _scene((4.0, 4.0, 8.0), _SLIT, _gas(24), walls=[_across((4.0, 4.0), 4.5, mass=16.0)]),
        interval=0.25,
        steady="the wall moves",
    ),
    "warm": Kind(
        _scene((4.0, 5.0, 6.0), _SLIT, _gas(24), walls=[_SMALL]),
        interval=0.25,
        moving=_AT_REST,
    ),
    "ramp": Kind(
        _scene((6.0, 4.0, 5.0), ("wall", PERIODIC, "wall"), _gas(24), faces=_RAMPS),
        interval=0.25,
        moving=_AT_REST,
        mirror=0,
    ),
    "vibrating": Kind(
        _scene(
            (4.0, 4.0, 8.0),
            _SLIT,
            _gas(24),
            restitution=gp.Restitution(0.95),
            faces={"z_low": gp.Vibrating(0.125, 1.0)},
        ),
        interval=0.25,
        steady="the energy changes slowly",
    ),
    "thermostat": Kind(
        _scene(
            _CUBE, PERIODIC, _gas(), restitution=gp.Restitution(0.8), thermostat=gp.Thermostat(1.0, 0.0625)
        )
    ),
    "mixture": Kind(_scene((4.0, 5.0, 4.0), PERIODIC, _gas(20), _gas(12, radius=0.375, mass=4.0))),
    "halves": Kind(_scene(_CUBE, PERIODIC, _gas(16), _gas(16)), impulses=True),
    "polydisperse": Kind(_scene(_CUBE, PERIODIC, _gas(radius=0.45, polydispersity=0.2))),
    "open": Kind(
        _scene(
            (6.0, 4.0, 4.0),
            ("wall", PERIODIC, PERIODIC),
            _gas(16),
            faces={"x_low": gp.Open(0.5, 1.0), "x_high": gp.Open(0.25, 2.0)},
            centres_to_walls=True,
        ),
        interval=0.25,
        moving="reservoirs are at rest",
        mirror=0,
    ),
    "two": Kind(_scene((2.5, 2.5, 2.5), PERIODIC, _gas(2)), steady="two particles pass a cell too rarely"),
    "ten": Kind(_scene((3.0, 3.0, 3.0), PERIODIC, _gas(10))),
}
"""Name -> kind of scene. All are of three dimensions, so that their kernels are few."""


def engines(interval):
    """Name -> engine: the three engines, and the two models of DSMC, with steps that are powers of two."""
    step = interval / STEPS
    return {
        "event": gp.EventDriven(),
        "step": gp.TimeStepped(step),
        **{f"dsmc {model}": gp.DSMC(step, (2, 2, 2), model) for model in ("boltzmann", "enskog")},
    }


def runs():
    """(engine, kind) of all runs, and why the other engines do not model the other kinds."""
    found, refused = [], {}
    for name, kind in KINDS.items():
        for engine, settings in engines(kind.interval).items():
            try:
                settings.check_features(kind.scene)
            except SceneError as error:
                refused[engine, name] = error.rule
            else:
                found.append((engine, name))
    return found, refused


_EVENT = ("periodic", "walls", "gravity", "lees_edwards", "plates", "piston", "thermostat", "mixture", "open")
CANONICAL = [
    *(("event", name) for name in _EVENT),
    *(("step", name) for name in ("periodic", "walls", "mixture")),
    *(("dsmc boltzmann", name) for name in ("periodic", "plates", "mixture")),
    *(("dsmc enskog", name) for name in ("periodic", "mixture")),
]
"""Runs whose kernels `make test` compiles; the other kinds are in `make test-all`."""


KNOWN_BY_OTHERS = {("step", "periodic"), ("step", "walls")}
KNOWN_BY_OTHERS |= {(f"dsmc {model}", "periodic") for model in ("boltzmann", "enskog")}
"""Canonical runs whose observables are those of mixtures."""


def kernels_of(engine, scene):
    """Return what the kernels of a scene under an engine depend on."""
    return engine.name, engine.variant(scene), scene.dimension, frozenset(compiled_features(scene))


@cache
def canonical_kernels():
    """Return what the kernels of the canonical runs depend on."""
    chosen = [(engines(KINDS[name].interval)[engine], KINDS[name].scene) for engine, name in CANONICAL]
    return {kernels_of(*run) for run in chosen}


def by_run(chosen, without=frozenset()):
    """A parameter for each of these runs; those that are not canonical are thorough, and these ones too."""
    marks = [() if run in CANONICAL and run not in without else pytest.mark.thorough for run in chosen]
    return pytest.mark.parametrize(
        ("engine", "name"),
        [pytest.param(*run, id=" ".join(run), marks=mark) for run, mark in zip(chosen, marks, strict=True)],
    )


@dataclass(frozen=True)
class Start:
    """What a run is made from. initial: its state at time 0, None: that of the scene and the seed; along: the
    axis of the impulses that one of its files has, None without such a file."""

    scene: gp.Scene
    engine: Engine
    interval: float
    initial: State | None = None
    seed: int = SEED
    along: int | None = None

    @property
    def tallies(self):
        """Form of the file -> the impulses that it has, where the scene and the engine have them."""
        if self.along is None:
            return {}
        furthest = REACH * min(self.scene.container.lengths)
        asked = ImpulseTally("xyz"[self.along], BINS), PairImpulseTally(furthest, SHELLS, 0.5)
        walled = not all(self.scene.container.periodic)
        return {
            tally.name: tally for tally in asked[: 1 if walled else 2] if tally.name in self.engine.tallies
        }

    @property
    def forms(self):
        """Form of the file -> arguments of `gaspart.run`: with paths and pairs, with correlations of the
        motion, with those of the fluxes, and with impulses, where the engine has them."""
        half = self.interval / 2.0
        if self.scene.is_open:  # nothing follows particles that come and go
            return {"frames": {}}
        every = {"pairs": self.engine.records_events}  # to record none needs other kernels
        found = {
            "frames": every | {"displacements": True},
            "correlations": every | {"displacements": True, "correlations": Correlations(half, LAGS)},
            "fluxes": every | {"correlations": Correlations(half, LAGS, stress=True)},
        }
        for form, tally in self.tallies.items():
            found[form] = {"tallies": [tally]}
        if self.scene.shear_rate is not None:  # correlations of the motion have no meaning
            del found["correlations"]
        try:
            self.engine.check_tally(StressTally(), self.scene)
        except SceneError:
            del found["fluxes"]
        return found

    def record(self, form, intervals):
        """The trajectory of so many intervals, in memory and in double precision."""
        duration = intervals * self.interval
        with TemporaryDirectory() as folder:
            path = Path(folder) / "run.nc"
            settings = self.forms[form] | {"initial": self.initial}
            gp.run(self.scene, self.engine, self.seed, duration, self.interval, path, **settings)
            with open_trajectory(path) as data:
                loaded = data.load()
        vectors = ("coordinates", "velocities")
        return loaded.assign({name: loaded[name].astype(float) for name in vectors})


def start_of(engine, name, seed=SEED):
    """What the run of a kind of scene is made from."""
    kind = KINDS[name]
    settings = engines(kind.interval)[engine]
    initial = None
    if kind.drift:
        drawn = gp.Simulation(kind.scene, settings, seed).initial_state
        initial = replace(drawn, velocities=drawn.velocities + np.array(kind.drift))
    along = kind.mirror if kind.impulses else None
    return Start(kind.scene, settings, kind.interval, initial, seed, along)


@cache
def recorded(engine, name):
    """Form -> the trajectory of a run."""
    start = start_of(engine, name)
    return {form: start.record(form, FRAMES) for form in start.forms}


@cache
def repeated_simulation(engine, name, form="frames", intervals=FRAMES):
    """The frames of the same run as a simulation, which gives them by being run again, with the impulses of a
    form."""
    start = start_of(engine, name)
    tallies = [tally for key, tally in start.tallies.items() if key == form]
    pairs = start.engine.records_events and not start.scene.is_open and not tallies
    simulation = gp.Simulation(start.scene, start.engine, start.seed, initial=start.initial, tallies=tallies)
    simulation.record_events = pairs
    quantum = start.engine.quantum or 0.0
    simulation.advance(until=intervals * start.interval + 0.5 * quantum)
    return repeat_run(simulation, pairs=pairs)
