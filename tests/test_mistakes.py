"""Ninety mistakes in Python: each gives one line that names the remedy. No kernel runs here."""

import dataclasses
import pickle
from types import SimpleNamespace

import numpy as np
import pytest

import gaspart as gp
from gaspart.errors.guidance import MissingName

BOX = gp.Container((9.0, 9.0), boundary="periodic")
GAS = gp.Species(20, 0.5, temperature=1.0)
SCENE = gp.Scene(BOX, [GAS])
STATE = gp.State(0.0, *[np.zeros((2, 2))] * 3, *[np.ones(2)] * 3, np.full(2, 9.0), *[np.ones(2)] * 2)
SIM = object.__new__(gp.Simulation)  # which has not been set up: no engine is compiled
TEXT = {"container": {"lengths": [9.0, 9.0]}, "species": [{"count": 20, "radius": 0.5}]}


def of(scene=None, **changes):
    """A scene of a file with some keys of its species, or of another part."""
    part = TEXT["species"][0] if scene is None else TEXT
    kept = {key: value for key, value in part.items() if changes.get(key, "") is not None}
    changed = kept | {key: value for key, value in changes.items() if value is not None}
    return gp.Scene.from_dict(TEXT | {"species": [changed]} if scene is None else changed)


WORDS = {
    "species T": (lambda: gp.Species(20, 0.5, T=1.0), "unknown argument of Species; here it is temperature"),
    "species temp": (lambda: gp.Species(20, 0.5, temp=1.0), "here it is temperature"),
    "species kT": (lambda: gp.Species(20, 0.5, kT=1.0), "here it is temperature"),
    "species N": (lambda: gp.Species(N=20, radius=0.5), "here it is count"),
    "species number": (lambda: gp.Species(number=20, radius=0.5), "here it is count"),
    "species diameter": (lambda: gp.Species(20, diameter=1.0), "here it is radius, half of it"),
    "species sigma": (lambda: gp.Species(20, sigma=1.0), "here it is radius, half the diameter"),
    "species m": (lambda: gp.Species(20, 0.5, m=1.0), "here it is mass"),
    "species misspelt": (lambda: gp.Species(20, 0.5, temprature=1.0), "did you mean temperature?"),
    "species without radius": (lambda: gp.Species(20), "radius = None: is required by Species"),
    "species n": (lambda: gp.Species(n=10, radius=0.5), "unknown argument of Species; here it is count"),
    "species mass by position": (
        lambda: gp.Species(10, 0.5, 1.0),
        "Species takes count, radius by position, and by name mass",
    ),
    "species alone": (lambda: gp.Species(), "count = None: is required by Species"),
    "species twice": (lambda: gp.Species(20, 0.5, radius=0.5), "radius = 0.5: is given twice to Species"),
    "species of text": (lambda: gp.Species("20", 0.5), "count = '20': must be a whole number"),
    "radius with a unit": (lambda: gp.Species(20, "0.5 nm"), "must be a number, without a unit"),
    "negative radius": (lambda: gp.Species(20, -0.5), "radius = -0.5: must be positive"),
    "particle pos": (lambda: gp.Particle(pos=(1, 1), velocity=(0, 0), radius=1), "here it is position"),
    "particle vel": (lambda: gp.Particle((1, 1), vel=(0, 0), radius=1), "here it is velocity"),
    "particle omega": (lambda: gp.Particle((1, 1), (0, 0), 1.0, omega=1.0), "here it is spin"),
    "container size": (lambda: gp.Container(size=(9, 9)), "unknown argument of Container; known are lengths"),
    "container L": (lambda: gp.Container(L=(9, 9)), "here it is lengths"),
    "container periodic": (
        lambda: gp.Container((9, 9), periodic=True),
        "here it is boundary of the container",
    ),
    "container pbc": (lambda: gp.Container((9, 9), pbc=True), "here it is boundary"),
    "container a number": (lambda: gp.Container(9.0), "lengths = 9.0: must be a list of 2 or 3"),
    "container two numbers": (lambda: gp.Container(9.0, 9.0), "lengths = 9.0: must be a list"),
    "container three numbers": (lambda: gp.Container(9.0, 9.0, 9.0), "takes lengths, boundary by position"),
    "boundary true": (lambda: gp.Container((9, 9), boundary=True), "must be one of ('wall', 'periodic')"),
    "scene box": (lambda: gp.Scene(box=BOX), "unknown argument of Scene; here it is container"),
    "scene g": (lambda: gp.Scene(BOX, g=(0, -1)), "here it is gravity"),
    "scene obstacles": (lambda: gp.Scene(BOX, obstacles=[]), "here it is walls, or particles that are fixed"),
    "scene gas": (lambda: gp.Scene(BOX, gas=GAS), "here it is species"),
    "scene a number": (lambda: gp.Scene(BOX, gravity=-1.0), "gravity = -1.0: must be a list"),
    "scene a tuple": (lambda: gp.Scene((9.0, 9.0)), "container = (9.0, 9.0): must be a Container"),
    "species a number": (lambda: gp.Scene(BOX, 20), "species = 20: must be a Species"),
    "species in words": (lambda: gp.Scene(BOX, [{"count": 20}]), "{'count': 20}: must be a Species"),
    "engine dt": (lambda: gp.TimeStepped(dt=0.1), "here it is time_step"),
    "engine timestep": (lambda: gp.TimeStepped(timestep=0.1), "here it is time_step"),
    "engine without a step": (lambda: gp.TimeStepped(), "time_step = None: is required by TimeStepped"),
    "engine of another": (lambda: gp.EventDriven(time_step=0.1), "unknown argument of EventDriven"),
    "run dt": (lambda: gp.run(SCENE, dt=0.1), "unknown argument of run"),
    "run time": (lambda: gp.run(SCENE, time=9.0), "here it is duration"),
    "run steps": (lambda: gp.run(SCENE, steps=100), "here it is duration"),
    "run output": (lambda: gp.run(SCENE, output="a.nc"), "here it is path"),
    "run every": (lambda: gp.run(SCENE, every=1.0), "here it is sample_interval"),
    "run integrator": (lambda: gp.run(SCENE, integrator="event"), "here it is engine"),
    "run a file": (lambda: gp.run("gas.yaml"), "such as Scene.from_file(path)"),
    "simulation of a file": (
        lambda: gp.Simulation("gas.yaml"),
        "such as Scene.from_file(path)",
    ),
    "simulation dt": (lambda: gp.Simulation(SCENE, dt=0.1), "unknown argument of Simulation"),
    "sweep n_jobs": (lambda: gp.sweep(SCENE, {}, ["Z"], folder="a", n_jobs=2), "here it is workers"),
    "sweep grid": (lambda: gp.sweep(SCENE, grid={}, observables=["Z"], folder="a"), "here it is over"),
    "sweep no folder": (lambda: gp.sweep(SCENE, {}, ["Z"]), "folder = None: is required by sweep"),
    "accuracy tolerance": (lambda: gp.Accuracy("Z", tolerance=0.1), "here it is accuracy"),
    "film fps": (lambda: gp.film("a.nc", "a.gif", fps=10), "here it is frames_per_second"),
    "film of a simulation": (
        lambda: gp.film(SIM, "a.gif"),
        "a film needs frames; gaspart.run(scene, path=...)",
    ),
    "measure before the start": (
        lambda: gp.analysis.pressure(gp.Simulation(SCENE)),
        "simulation = 'at time 0': has not advanced; call advance(duration=...) first",
    ),
    "walls of an engine without": (
        lambda: gp.Simulation(
            gp.Scene(gp.Container((9.0, 9.0)), GAS, walls=[gp.Wall((5, 5), (5, 9))]), gp.DSMC()
        ),
        'needs the "event" engine; this one has none',
    ),
    "film by place": (lambda: gp.film("a.nc", "a.gif", (9, 9)), "takes trajectory, path by position"),
    "render color": (lambda: gp.render(SCENE, color="speed"), "here it is colour"),
    "advance t": (lambda: SIM.advance(t=1.0), "of Simulation.advance; here it is duration"),
    "advance steps": (lambda: SIM.advance(steps=10), "here it is duration"),
    "theory eta": (
        lambda: gp.theory.compressibility_factor(eta=0.1, dimension=3),
        "here it is packing_fraction",
    ),
    "theory no dimension": (
        lambda: gp.theory.compressibility_factor(0.1),
        "dimension = None: is required by compressibility_factor",
    ),
    "analysis skip": (lambda: gp.analysis.rdf("a.nc", skip=1.0), "here it is start"),
    "analysis of a scene": (lambda: gp.analysis.rdf(SCENE), "run it first, gaspart.run(scene"),
    "measure a scene": (lambda: gp.analysis.collision_rate(SCENE), "this is a scene: run it first"),
    "film of a scene": (lambda: gp.film(SCENE, "a.gif"), "this is a scene: run it first"),
    "film of a state": (lambda: gp.film(STATE, "a.gif"), "gaspart.run(scene, path=...) writes them"),
    "view of a scene": (lambda: gp.view(SCENE), "this is a scene: run it first"),
    "export of a scene": (lambda: gp.export(SCENE, "a.gsd"), "this is a scene: run it first"),
    "last state of a scene": (lambda: gp.last_state(SCENE), "this is a scene: run it first"),
    "open density": (lambda: gp.Open(density=0.1), "here it is activity, which gaspart.theory.activity"),
    "piston velocity": (lambda: gp.Piston(velocity=1.5), "here it is speed"),
    "piston alone": (lambda: gp.Piston(mass=10.0), "must be mass and pressure, or speed alone"),
    "wall temp": (lambda: gp.Wall((5.0, 5.0), (5.0, 9.0), temp=2.0), "here it is temperature"),
    "boundary in capitals": (
        lambda: gp.Container((9, 9), boundary="Periodic"),
        "must be one of ('wall', 'periodic')",
    ),
    "face in words": (
        lambda: gp.Scene(gp.Container((9.0, 9.0)), GAS, faces={"x_low": "open"}),
        "faces.x_low = 'open': must be Thermal, Well",
    ),
    "face by its side": (
        lambda: gp.Scene(gp.Container((9.0, 9.0)), GAS, faces={"bottom": gp.Thermal(1.0)}),
        "faces.bottom = 'thermal': unknown face; here it is y_low",
    ),
    "open without centres": (
        lambda: gp.Scene(gp.Container((9.0, 9.0)), GAS, faces={"x_low": gp.Open()}),
        "needs centres_to_walls: true",
    ),
    "engine as a class": (lambda: gp.Simulation(SCENE, gp.EventDriven), "must be an engine: EventDriven()"),
    "engine in words": (lambda: gp.Simulation(SCENE, "md"), "must be one of ('event', 'step', 'dsmc')"),
    "no seed": (lambda: gp.Simulation(SCENE, seed=None), "seed = None: must be a whole number of at least 0"),
    "run without a file": (
        lambda: gp.run(SCENE, duration=1.0, sample_interval=0.5),
        "path = None: must be given: the file of the trajectory",
    ),
    "run keep": (
        lambda: gp.run(SCENE, duration=1.0, sample_interval=0.5, path="a.nc", keep=True),
        "keep = True: must be one of ('positions', 'velocities')",
    ),
    "replicas in words": (
        lambda: gp.run(SCENE, duration=1.0, sample_interval=0.5, path="a.nc", replicas="two"),
        "replicas = 'two': must be a whole number of at least 1",
    ),
    "sweep by interval": (
        lambda: gp.sweep(SCENE, {"packing_fraction": [0.1]}, ["Z"], sample_interval=1.0),
        "here it is samples, the number of frames",
    ),
    "film without a file": (lambda: gp.film("gas.nc"), "path = None: is required by film"),
    "no such trajectory": (lambda: gp.open_trajectory("none.nc"), "No such file"),
    "theory of nothing": (lambda: gp.theory.shock_before_piston(), "is required by shock_before_piston"),
    "theory activity": (lambda: gp.theory.activity(0.1), "dimension = None: is required by activity"),
    "file number": (lambda: of(count=None, number=20), "number = 20: unknown key; here it is count"),
    "file diameter": (lambda: of(radius=None, diameter=1.0), "unknown key; here it is radius, half of it"),
    "file obstacles": (lambda: of(TEXT, obstacles=[]), "obstacles = []: unknown key; here it is walls"),
    "file box": (lambda: of(TEXT, container=None, box=[9, 9]), "unknown key; here it is container"),
    "file periodic": (lambda: of(TEXT, periodic=True), "unknown key; here it is boundary of the container"),
}
NAMES = {
    "theory.Z": (gp.theory, "it is compressibility_factor(packing_fraction, dimension)"),
    "theory.g": (gp.theory, "it is contact_value"),
    "sim.run": (SIM, "simulation.advance(duration) runs it; gaspart.run(scene, ...) writes"),
    "sim.positions": (SIM, "it is state.positions"),
    "sim.kinetic_energy": (SIM, "it is state.kinetic_energy"),
    "sim.collisions": (SIM, "it is tally.collisions"),
    "sim.packing_fraction": (SIM, "it is scene.packing_fraction"),
    "sim.plot": (SIM, "gaspart.render(simulation) draws it"),
    "sim.advanse": (SIM, "did you mean advance?"),
    "state.x": (STATE, "it is positions"),
    "state.pos": (STATE, "it is positions"),
    "state.vel": (STATE, "it is velocities"),
    "analysis.presure": (gp.analysis, "did you mean pressure?"),
    "state.speed": (STATE, "did you mean speeds?"),
    "scene.run": (SCENE, "gaspart.run(scene, duration=..."),
    "scene.lengths": (SCENE, "it is container.lengths"),
    "scene.N": (SCENE, "it is count"),
    "gp.plot": (gp, "an observable has .plot(), and gaspart.render draws particles"),
    "gp.rdf": (gp, "it is gaspart.analysis.rdf"),
    "gp.contact_valu": (gp, "did you mean contact_value?"),
    "gp.Box": (gp, "gaspart.Container is the box"),
    "gp.Sphere": (gp, "gaspart.Particle is one sphere or disc"),
    "gp.analysis.mean_square": (gp.analysis, "did you mean mean_squared_displacement?"),
}


def line(mistake, kind):
    """The line of a mistake, as a notebook prints it."""
    with pytest.raises(kind) as found:
        mistake()
    (text,) = found.value._render_traceback_()
    assert "\n" not in str(found.value)
    return text


@pytest.mark.parametrize(("mistake", "remedy"), WORDS.values(), ids=WORDS)
def test_a_call_that_does_not_fit_names_what_would(mistake, remedy):
    assert remedy in line(mistake, gp.SceneError)


@pytest.mark.parametrize("name", NAMES)
def test_a_missing_name_suggests_another(name):
    owner, remedy = NAMES[name]
    assert remedy in line(lambda: getattr(owner, name.rpartition(".")[2]), MissingName)


@pytest.fixture(scope="module")
def trajectory(tmp_path_factory):
    path = tmp_path_factory.mktemp("names") / "gas.nc"
    gas = gp.Species(20, 0.2, temperature=1.0)
    gp.run(gp.Scene(BOX, [gas]), seed=1, duration=2.0, sample_interval=0.5, path=path)
    with gp.open_trajectory(path) as data:
        yield data


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("positions", "it is coordinates"),
        ("positionss", "it is coordinates"),
        ("velocity", "did you mean velocities?"),
        ("kinetic_enrgy", "did you mean kinetic_energy?"),
        ("Z", 'gaspart.measure(trajectory, "Z") measures it'),
        ("isell", "did you mean isel?"),
    ],
)
def test_a_missing_variable_of_a_trajectory_suggests_another(trajectory, name, remedy):
    for data in (trajectory, trajectory.isel(frame=0), trajectory.copy(deep=True)):
        text = line(lambda data=data: getattr(data, name), MissingName)
        assert text.endswith(f"has no attribute {name!r}; {remedy}")
    assert not hasattr(trajectory, "_ipython_display_") and trajectory.coordinates.sizes["atom"] == 20


def test_a_run_in_the_file_of_another_states_the_difference(tmp_path):
    given = {"duration": 1.0, "sample_interval": 0.5, "path": tmp_path / "gas.nc"}
    path = gp.run(SCENE, seed=1, **given)
    before = path.read_bytes()
    remedy = "which differs in seed 1, not 2; move it away, or overwrite it (overwrite=True)"
    assert remedy in line(lambda: gp.run(SCENE, seed=2, **given), gp.SceneError)
    assert path.read_bytes() == before


def test_speeds_of_an_open_gas_are_not_defined():
    faces = {"x_low": gp.Open(), "x_high": gp.Open(activity=0.1, temperature=1.0)}
    scene = gp.Scene(gp.Container((9.0, 9.0)), GAS, faces=faces, centres_to_walls=True)
    simulation = gp.Simulation(scene, seed=1)
    simulation.advance(duration=1.0)
    remedy = "defined here are number, flux, density, velocity, temperature, pressure and force"
    assert remedy in line(lambda: gp.analysis.speed_distribution(simulation), gp.SceneError)


def test_there_are_ninety():
    assert len(WORDS | NAMES) >= 90


def test_one_species_and_one_particle_are_taken_for_a_list():
    ball = gp.Particle((4.0, 4.0), (0.0, 0.0), 1.0)
    assert gp.Scene(BOX, GAS) == SCENE
    assert gp.Scene(BOX, particles=ball) == gp.Scene(BOX, particles=[ball])


def test_what_cannot_change_says_how_to_make_another():
    with pytest.raises(dataclasses.FrozenInstanceError) as found:
        SCENE.gravity = (0.0, -1.0)
    assert str(found.value).endswith("make another one: dataclasses.replace(scene, gravity=...)")


def test_errors_of_functions_themselves_stay():
    with pytest.raises(TypeError, match="unsupported operand"):
        gp.theory.compressibility_factor(0.1, None + 1)
    assert not hasattr(SCENE, "nothing") and getattr(SCENE, "nothing", 1) == 1
    assert not hasattr(SimpleNamespace(scene=SCENE).scene, "__array__")


def test_guided_things_are_found_by_pickle():
    for thing in (gp.run, gp.theory.compressibility_factor, gp.analysis.rdf, SCENE):
        assert pickle.loads(pickle.dumps(thing)) == thing
    assert "count" in str(pickle.loads(pickle.dumps(MissingName(gp.Scene, "cuont"))))
