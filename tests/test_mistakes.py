"""Mistakes in Python: a wrong value gives one line with the rule, a wrong name the name that is meant."""

import pickle

import numpy as np
import pytest

import gaspart as gp
from gaspart.errors import MissingName, meant

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
    "species of text": (lambda: gp.Species("20", 0.5), "count = '20': must be a whole number"),
    "radius with a unit": (lambda: gp.Species(20, "0.5 nm"), "must be a number, without a unit"),
    "negative radius": (lambda: gp.Species(20, -0.5), "radius = -0.5: must be positive"),
    "points": (lambda: gp.Species(20, 0.0), "points are particles with a radius of 1e-9 of the container"),
    "container a number": (lambda: gp.Container(9.0), "lengths = 9.0: must be a list of 2 or 3"),
    "species a number": (lambda: gp.Scene(BOX, 20), "species = 20: must be a Species"),
    "run a file": (lambda: gp.run("gas.yaml"), "such as Scene.from_file(path)"),
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
    "analysis of a scene": (lambda: gp.analysis.rdf(SCENE), "run it first, gaspart.run(scene"),
    "film of a scene": (lambda: gp.film(SCENE, "a.gif"), "this is a scene: run it first"),
    "face in words": (
        lambda: gp.Scene(gp.Container((9.0, 9.0)), GAS, faces={"x_low": "open"}),
        "faces.x_low = 'open': must be Thermal, Well",
    ),
    "face by its side": (
        lambda: gp.Scene(gp.Container((9.0, 9.0)), GAS, faces={"bottom": gp.Thermal(1.0)}),
        "faces.bottom = 'thermal': unknown face; did you mean y_low?",
    ),
    "open without centres": (
        lambda: gp.Scene(gp.Container((9.0, 9.0)), GAS, faces={"x_low": gp.Open(0.1, 1.0)}),
        "needs centres_to_walls: true",
    ),
    "engine as a class": (lambda: gp.Simulation(SCENE, gp.EventDriven), "must be an engine: EventDriven()"),
    "no seed": (lambda: gp.Simulation(SCENE, seed=None), "seed = None: must be a whole number of at least 0"),
    "run without a file": (
        lambda: gp.run(SCENE, duration=1.0, sample_interval=0.5),
        "path = None: must be given: the file of the trajectory",
    ),
    "replicas in words": (
        lambda: gp.run(SCENE, duration=1.0, sample_interval=0.5, path="a.nc", replicas="two"),
        "replicas = 'two': must be a whole number of at least 1",
    ),
    "view to a file": (lambda: gp.view("gas.nc", "gas.html"), "view(source).save(path) writes the page"),
    "run to a file": (lambda: gp.run(SCENE, "gas.nc", duration=1.0), "path= names the file"),
    "sweep over seeds": (
        lambda: gp.sweep(SCENE, {"seed": [1, 2]}, ["Z"], folder="a", duration=1.0),
        "replicas= makes runs of several seeds",
    ),
    "two observables": (lambda: gp.measure("gas.nc", "Z", "D"), "are a list, such as ['Z', 'D']"),
    "velocities of a simulation": (
        lambda: setattr(STATE.read_only(), "velocities", STATE.velocities),
        "change its copy(), and start from the copy by Simulation(scene, initial=copy)",
    ),
    "file diameter": (lambda: of(radius=None, diameter=1.0), "did you mean radius (half the diameter)?"),
    "file periodic": (lambda: of(TEXT, periodic=True), "did you mean container (its key boundary)?"),
}
NAMES = {
    "rdf": (gp, "analysis.rdf"),
    "Box": (gp, "Container"),
    "simulate": (gp, "run"),
    "presure": (gp.analysis, "pressure"),
}
SUGGESTIONS = {
    "advise": (["run", "view", "film"], ""),
    "--dt": (["--adapt", "--duration"], ""),
    "pressure x low": (["Z", "pressure"], "pressure"),
    "--dt ": (["--time-step", "--duration"], "--time-step"),
    "pressure": (["restore", "measure"], ""),
    "temprature": (["temperature", "radius"], "temperature"),
    "top": (["x_high", "y_high"], "y_high"),
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
    owner, meaning = NAMES[name]
    assert line(lambda: getattr(owner, name), MissingName).endswith(f"; did you mean {meaning}?")


@pytest.mark.parametrize("word", SUGGESTIONS)
def test_a_suggestion_is_the_right_word_or_none(word):
    candidates, meaning = SUGGESTIONS[word]
    assert meant(word.strip(), candidates) == meaning


def test_a_name_that_resembles_none_has_no_suggestion():
    assert line(lambda: gp.nothing, MissingName).endswith("has no attribute 'nothing'")


@pytest.fixture(scope="module")
def trajectory(tmp_path_factory):
    path = tmp_path_factory.mktemp("names") / "gas.nc"
    gas = gp.Species(20, 0.2, temperature=1.0)
    gp.run(gp.Scene(BOX, [gas]), seed=1, duration=2.0, sample_interval=0.5, path=path)
    with gp.open_trajectory(path) as data:
        yield data


@pytest.mark.parametrize(
    ("name", "remedy"),
    [("positions", "coordinates"), ("velocity", "velocities"), ("kinetic_enrgy", "kinetic_energy")],
)
def test_a_missing_variable_of_a_trajectory_suggests_another(trajectory, name, remedy):
    for data in (trajectory, trajectory.isel(frame=0), trajectory.copy(deep=True)):
        text = line(lambda data=data: getattr(data, name), MissingName)
        assert text.endswith(f"has no attribute {name!r}; did you mean {remedy}?")
    assert not hasattr(trajectory, "_ipython_display_") and trajectory.coordinates.sizes["atom"] == 20


def test_a_run_in_the_file_of_another_states_the_difference(tmp_path):
    given = {"duration": 1.0, "sample_interval": 0.5, "path": tmp_path / "gas.nc"}
    path = gp.run(SCENE, seed=1, **given)
    before = path.read_bytes()
    remedy = "which differs in seed 1, not 2; move it away, or overwrite it (overwrite=True)"
    assert remedy in line(lambda: gp.run(SCENE, seed=2, **given), gp.SceneError)
    assert path.read_bytes() == before


@pytest.mark.interpreted
def test_speeds_of_an_open_gas_are_not_defined():
    faces = {"x_low": gp.Open(), "x_high": gp.Open(activity=0.1, temperature=1.0)}
    scene = gp.Scene(gp.Container((9.0, 9.0)), GAS, faces=faces, centres_to_walls=True)
    simulation = gp.Simulation(scene, seed=1)
    simulation.advance(duration=1.0)
    remedy = "defined here are number, flux, density, velocity, temperature, pressure, force and heat_flux"
    assert remedy in line(lambda: gp.analysis.speed_distribution(simulation), gp.SceneError)


def test_one_species_and_one_particle_are_taken_for_a_list():
    ball = gp.Particle((4.0, 4.0), (0.0, 0.0), 1.0)
    assert gp.Scene(BOX, GAS) == SCENE
    assert gp.Scene(BOX, particles=ball) == gp.Scene(BOX, particles=[ball])


def test_public_objects_are_found_by_pickle():
    for thing in (gp.run, gp.theory.compressibility_factor, gp.analysis.rdf, SCENE):
        assert pickle.loads(pickle.dumps(thing)) == thing
    assert "Container" in str(pickle.loads(pickle.dumps(MissingName("gaspart", "Box", ["Container"]))))
