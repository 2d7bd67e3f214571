"""Advice from pilot runs, for scenes that the table does not cover."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.accuracy import pilot, plan
from gaspart.accuracy import target as target_module
from gaspart.accuracy.estimates import Component
from gaspart.accuracy.of_engine import Candidate
from gaspart.accuracy.option import Option, candidates, suitable_engines
from gaspart.accuracy.pilot import Pilot, Trials, raised_bias
from gaspart.accuracy.scatter import start_scatter
from gaspart.accuracy.tabulated import is_tabulated
from gaspart.accuracy.target import Target
from gaspart.analysis.measuring import measure
from gaspart.cli import main
from gaspart.cli.advise import _lines, _shortfall
from gaspart.engines import EventDriven
from gaspart.engines.dsmc.cells import CELL_LOSS
from gaspart.state import initial
from gaspart.theory.columns import gravity_column

BOX = gp.Scene(gp.Container((12.0, 12.0)), [gp.Species(40, 0.5, temperature=1.0)])
SHEARED = gp.Scene(
    gp.Container((20.0, 20.0), boundary="periodic"),
    [gp.Species(120, 0.5, temperature=1.0)],
    faces={"y_high": gp.LeesEdwards(0.3)},
    restitution=gp.Restitution(normal=0.9),
)
DILUTE = gp.Scene(
    gp.Container((100.0, 100.0, 100.0), boundary="periodic"), [gp.Species(500, 0.5, temperature=1.0)]
)


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    """Pilots are kept in a folder of the test; kernels in that of all tests."""
    monkeypatch.setattr(pilot, "cache_directory", lambda: tmp_path / "cache")


@pytest.mark.thorough
def test_pilots_are_kept():
    made, again = (plan.plan_from_pilots(BOX, "pressure", 0.05, pilot_seconds=0.4) for _ in range(2))
    assert made.affordable and made.best.error <= 0.05 * (1.0 + 1e-9)
    assert again.pilots[0].seconds == 0.0


@pytest.mark.parametrize("observable", ["msd", pytest.param("vacf", marks=pytest.mark.thorough)])
def test_lags_are_those_of_correlations(tmp_path, observable):
    """Whatever the length of the run, so that a longer one is more accurate."""
    coarse, fine = (
        plan.plan_from_pilots(BOX, observable, x, pilot_seconds=0.4).recipe for x in (0.05, 0.005)
    )
    assert fine.correlations.lags == coarse.correlations.lags and fine.duration > 8.0 * coarse.duration
    assert fine.displacements == (observable == "msd")
    path = gp.run(
        BOX, coarse.engine, 3, coarse.duration, coarse.sample_interval, tmp_path / "run.nc",
        correlations=coarse.correlations, displacements=coarse.displacements,
    )  # fmt: skip
    found = measure(path, observable)
    assert found["lag"][-1] == pytest.approx(coarse.correlations.lags * coarse.correlations.interval)
    error = float((found.error**2).mean() / (found.estimate**2).mean()) ** 0.5
    assert error <= 0.05


@pytest.mark.parametrize("observable", ["D", pytest.param("mutual_diffusion", marks=pytest.mark.thorough)])
def test_paths_are_followed_however_far_frames_are_apart(tmp_path, observable):
    """Some of these particles cross the container between frames."""
    kinds = [gp.Species(32, radius, temperature=1.0, exact_temperature=True) for radius in (0.5, 0.4)]
    scene = gp.Scene(gp.Container((20.0, 20.0, 20.0), "periodic"), kinds)
    recipe = plan.plan_from_pilots(scene, observable, 0.5, pilot_seconds=0.4).recipe
    paths = [tmp_path / "with.nc", tmp_path / "without.nc"]
    for path, kept in zip(paths, (recipe.displacements, False), strict=True):
        interval = recipe.sample_interval
        gp.run(scene, gp.EventDriven(), 3, 400 * interval, interval, path, displacements=kept)
    assert float(measure(paths[0], observable).estimate) > 0.0
    with pytest.raises(gp.SceneError, match="is too long to follow particles"):
        measure(paths[1], observable)


@pytest.mark.thorough
def test_particles_that_start_at_rest_set_the_lags_by_their_collisions_later():
    """Of which theory says nothing: those of a bed of discs on a floor that moves."""
    scene = bed(0.3)
    target, gas_of_theory = Target(scene, "vacf"), Target(SHEARED, "vacf")
    lags = target.correlations(EventDriven())
    assert lags.interval * lags.lags * target.frequency == pytest.approx(10.0, rel=0.4)
    simulation = gp.Simulation(scene, EventDriven(), 1)
    simulation.advance(until=40.0)
    before = simulation.tally.collisions
    simulation.advance(until=80.0)
    found = 2.0 * (simulation.tally.collisions - before) / scene.count / 40.0
    assert target.frequency == pytest.approx(found, rel=0.5)
    assert gas_of_theory.frequency == pytest.approx(1.6, rel=0.5)


@pytest.mark.thorough
def test_their_frequency_is_known_however_soon_they_have_collided(monkeypatch):
    monkeypatch.setattr(target_module, "_COLLIDED", 1e-9)
    assert Target(bed(0.3), "vacf").frequency > 0.0


def bed(amplitude):
    """Discs that are shaken by their floor, none of which reaches the ceiling."""
    return gp.Scene(
        gp.Container((12.0, 60.0), ("periodic", "wall")),
        [gp.Species(30, 0.5, region=((0.0, 0.0), (12.0, 12.0)))],
        gravity=(0.0, -1.0),
        faces={"y_low": gp.Vibrating(amplitude, 2.0)},
        restitution=gp.Restitution(normal=0.8),
    )


@pytest.mark.thorough
def test_the_pressure_on_one_wall(tmp_path):
    """Of a wall that nothing hits there is no relative accuracy."""
    made = plan.plan_from_pilots(bed(0.3), "pressure:y low", 0.05, pilot_seconds=0.4)
    assert made.target.name == "pressure:y low" and made.affordable
    assert made.value == pytest.approx(30.0 / 12.0, rel=0.05)  # the weight of the discs
    (asked,) = made.recipe.until.accuracies
    assert asked.name == "pressure:y low"
    with pytest.raises(gp.SceneError, match="does not change in the pilot run.* or state a wall"):
        plan.plan_from_pilots(bed(0.3), "pressure", 0.05, pilot_seconds=0.4)


@pytest.mark.thorough
def test_an_engine_that_cannot_start_is_no_candidate():
    """Of a few large particles among many small ones DSMC draws no partners."""
    large = gp.Particle((6.0, 6.0), (0.0, 0.0), radius=2.0, mass=16.0)
    scene = replace(BOX, particles=(large,))
    made = plan.plan_from_pilots(scene, "pressure", 0.1, pilot_seconds=0.4)
    assert made.best.candidate.engine.name in ("event", "step")
    assert {"dsmc", "dsmc enskog"} == set(made.refused) and "much larger" in made.refused["dsmc"]


@pytest.mark.thorough
def test_pilots_of_diffusion_and_structure_are_their_own():
    """Frames of others may lie too far apart, or be too many."""
    kinds = [gp.Species(32, radius, temperature=1.0, exact_temperature=True) for radius in (0.5, 0.4)]
    scene = gp.Scene(gp.Container((8.0, 8.0, 8.0), "periodic"), kinds)
    for observable in ("Z", "D", "rdf"):
        (found, *_) = plan.plan_from_pilots(scene, observable, 0.1, pilot_seconds=0.4).pilots
        assert found.measured > 0.0 and found.seconds > 0.0


@pytest.mark.thorough
def test_particles_that_are_compressed_are_made_once(monkeypatch):
    dense = gp.Species(200, 0.5, temperature=1.0, exact_temperature=True, arrangement="compressed")
    scene = gp.Scene(gp.Container((15.0, 15.0), "periodic"), [dense])
    made = []
    whole = initial.compress_positions

    def compressed(*arguments):
        made.append(arguments)
        return whole(*arguments)

    monkeypatch.setattr(initial, "compress_positions", compressed)
    plan.plan_from_pilots(scene, "rdf", 0.2, pilot_seconds=0.4)
    assert len(made) == 1


@pytest.mark.thorough
def test_a_sheared_gas_has_a_steady_state():
    made = plan.plan_from_pilots(SHEARED, "shear_viscosity", 0.1, pilot_seconds=0.4)
    assert made.affordable and made.recipe.correlations.stress
    assert made.best.candidate.engine.name == "event" and len(made.refused) == 3


def test_dilute_gases_are_advised_to_draw_partners():
    made = plan.plan_from_pilots(DILUTE, "collision_rate", 0.02, pilot_seconds=0.4)
    assert made.best.candidate.engine.name == "dsmc"
    by_name = {option.candidate.engine.name: option for option in made.options}
    assert by_name["event"].seconds > 5.0 * made.best.seconds
    exact = gp.theory.collision_rate(DILUTE.packing_fraction, 3)
    assert made.value == pytest.approx(float(exact), rel=0.2)


def test_bounds_come_from_theory():
    """Boltzmann's equation lacks the excluded volume; the Enskog model is known up to a density."""
    able, refused = candidates_of(BOX, "pressure")
    engines = {f"{one.engine.name} {getattr(one.engine, 'model', '')}".strip(): one for one in able}
    filled = BOX.packing_fraction * (12.0 / 11.0) ** 2  # of what centres can reach
    contact = float(gp.theory.contact_value(filled, 2))
    few = (1.0 - 2.0 * filled / 40) ** -1  # of a pair among 40
    virial = 2.0 * filled * contact * few
    assert engines["dsmc boltzmann"].model == pytest.approx(
        max(contact * few - 1.0, virial / (1.0 + virial)), rel=0.1
    )
    assert engines["event"].bias == 0.0 and 0.0 < engines["step"].bias <= 0.01 / 8.0
    assert refused == {}
    dense = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(43, 0.5, temperature=1.0)])
    _, refused = candidates_of(dense, "pressure")
    lost = gp.DSMC(model="enskog", cells_per_side=2).bias(BOX, "rates")
    assert lost == pytest.approx(CELL_LOSS[BOX.dimension] * 4 / BOX.count)
    assert gp.DSMC(model="enskog", cells_per_side=1).bias(BOX, "rates") == 0.0
    assert list(refused) == ["dsmc enskog"] and "known up to 0.4" in refused["dsmc enskog"]
    able, refused = candidates_of(DILUTE, "rdf")
    assert {one.engine.name for one in able} == {"event", "step"} and len(refused) == 2
    walled = gp.Scene(BOX.container, BOX.species, walls=[gp.Wall((4.0, 4.0), (6.0, 6.0))])
    able, refused = suitable_engines(Target(walled, "pressure"))
    assert [one.name for one in able] == ["event"] and len(refused) == 3


def candidates_of(scene, observable):
    target = Target(scene, observable)
    return candidates(target, 0.01, target.conditions)


def known(value, accuracy, time=1.0, **more):
    """An observable with its relative error in a run of a time."""
    return Component(value, value, time, (accuracy * value) ** 2 * time, **more)


def test_pilots_that_differ_raise_the_bound():
    event, other = EventDriven(), gp.DSMC(model="enskog")
    exact = Pilot(event, 1.0, components={"": known(2.0, 0.01)})
    alike = Pilot(other, 1.0, components={"": known(2.03, 0.01)})
    apart = Pilot(other, 1.0, components={"": known(2.2, 0.01)})
    candidate = Candidate(other, model=0.003)
    assert raised_bias(candidate, alike, [exact, alike]) == 0.003
    raised = 0.1 + 1.96 * math.hypot(0.01, 0.01)
    assert raised_bias(candidate, apart, [exact, apart]) == pytest.approx(raised)
    trials = Trials(Target(DILUTE, "Z"), 0.02, 1.0, print)
    trials.speeds = {Candidate(event): 1.0, candidate: 0.1}
    trials.pilots = [exact, apart]
    assert trials.differing == (apart,) and trials.reference is exact
    options = plan._options(trials, None)
    assert options[0].candidate.engine == event and options[1].bias == pytest.approx(raised)
    made = plan.Plan(trials.target, 0.02, tuple(options), {}, 2.0, 1, (exact, apart), trials.differing)
    (line,) = [one for one in _lines(made, "gas.yaml") if one.startswith("pilots differ")]
    assert "DSMC: 2.2 against 2 by the event-driven engine" in line


def test_pilots_are_compared_in_the_same_component():
    """The stress on two plates has opposite signs, and symmetry makes its other component vanish."""

    def pilot(engine, *values):
        parts = {name: Component(v, 2.0, 1.0, 1e-4) for name, v in zip("abc", values, strict=True)}
        return Pilot(engine, 1.0, components=parts)

    other = gp.DSMC(model="enskog")
    exact, alike = pilot(EventDriven(), -2.02, 2.0, 0.01), pilot(other, -2.0, 2.01, -0.01)
    candidate = Candidate(other, model=0.003)
    assert exact.value == -2.02 and exact.accuracy == pytest.approx(0.005)
    assert raised_bias(candidate, alike, [exact, alike]) == 0.003
    apart = pilot(other, -2.2, 2.2, 0.0)
    assert raised_bias(candidate, apart, [exact, apart]) > 0.09


def test_cost_follows_from_noise_and_bias():
    """Of an accuracy a and a bias b: noise / (a - b)^2, and its equilibration."""

    def option(bias, least=0.0, most=math.inf):
        noise = known(1.0, 0.1, 9.0, freedom=math.inf)
        return Option(Candidate(EventDriven()), bias, noise, 2.0, 0.03, least, most)

    plain = option(0.01)
    measured = 0.09 / 0.02**2
    assert plain.duration == pytest.approx(measured / 0.75)
    assert plain.seconds == pytest.approx(2.0 * plain.duration)
    assert plain.cost(0.03) == pytest.approx(plain.seconds)
    assert plain.cost(0.02) == pytest.approx(4.0 * plain.seconds)
    assert option(0.05).seconds == math.inf
    assert option(0.01, most=plain.duration / 4.0).error == pytest.approx(0.01 + 2.0 * 0.02)
    assert option(0.01, least=4.0 * plain.duration).error == pytest.approx(0.01 + 0.5 * 0.02)
    settled = replace(plain, settling=measured)
    assert settled.duration == pytest.approx(2.0 * measured)  # longer than a quarter of the run


@pytest.mark.thorough
def test_what_one_run_cannot_reach_is_shared_by_replicas():
    """Of a run the frames that are correlated are limited, here by the collisions of light particles."""
    kinds = [gp.Species(20, 0.5, mass=mass, temperature=1.0, exact_temperature=True) for mass in (1.0, 100.0)]
    mixture = gp.Scene(gp.Container((7.0, 7.0, 7.0), "periodic"), kinds)
    made = plan.plan_from_pilots(mixture, "D", 0.004, pilot_seconds=0.5)
    assert made.affordable and made.best.duration > made.target.span[1] and made.replicas > 1
    assert made.duration <= made.target.span[1] * (1.0 + 1e-9)
    lines = _lines(made, "gas.yaml")
    assert any(f"--replicas {made.replicas}" in line for line in lines)
    assert not any("budget" in line for line in lines)


def test_a_message_names_a_budget_only_where_one_was_given():
    noise = known(1.0, 0.1, 9.0, freedom=math.inf)
    option = Option(Candidate(EventDriven()), 0.0, noise, 2.0, 0.01, 0.0, 12.0)
    short = plan.Plan(Target(DILUTE, "D"), 0.01, (option,), {}, 1.0)
    assert short.runs == 100 and "the mean of 100 runs with other seeds has it" in _shortfall(short)
    assert "the budget does not suffice for 0.01" in _shortfall(replace(short, budget=24.0))


def test_what_is_stored_falls_faster_than_noise():
    """error^2 = S / t + C / t^2: the length for an error is the root of a quadratic."""
    found = Component(2.0, 2.0, 10.0, 0.5, 30.0, math.inf)
    assert found.accuracy == pytest.approx(0.5 * math.sqrt(0.05 + 0.3))
    length = found.length(0.01)
    assert 0.5 / length + 30.0 / length**2 == pytest.approx(0.02**2)
    assert found.reaches(length) == pytest.approx(0.01)
    assert length < 0.05 * 100.0 * found.accuracy**2 / 0.01**2


@pytest.mark.parametrize(
    ("scene", "observable", "line"),
    [
        (
            gp.Scene(BOX.container, BOX.species, restitution=gp.Restitution(normal=0.9)),
            "pressure",
            "restitution.normal = 0.9: loses energy that nothing returns",
        ),
        (gp.Scene(BOX.container, [gp.Species(40, 0.5)]), "pressure", "moving particles"),
        (gp.Scene(BOX.container), "pressure", "count = 0"),
        (BOX, "Z", "observable = 'Z': container.boundary"),
        (BOX, "pressure:z low", "must be one of the walls, x low, x high, y low, y high"),
        (BOX, "collision_rate:x low", "collision_rate is not of a wall"),
        (SHEARED, "vacf", "not defined where images of the particles slide"),
        (replace(SHEARED, restitution=None), "shear_viscosity", "nothing takes the energy"),
        (replace(BOX, faces={"y_low": gp.Vibrating(0.1, 1.0)}), "pressure", "nothing takes the energy"),
        (BOX, "Q", "observable = 'Q': unknown observable"),
    ],
)
def test_what_has_no_advice_is_refused_in_one_line(scene, observable, line):
    with pytest.raises(gp.SceneError, match=line):
        plan.plan_from_pilots(scene, observable, 0.1, pilot_seconds=0.1)


def test_the_command_line_prints_the_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    BOX.to_file("box.yaml")
    words = ["advise", "box.yaml", "--observable", "pressure", "--accuracy", "0.1", "--pilot", "0.4"]
    assert main(words) == 0
    output = capsys.readouterr().out
    for part in ("engine  ", "command  ", "predicted cost ", "standard error ", "pilot  ", "why not  "):
        assert part in output
    (command,) = [line for line in output.splitlines() if line.startswith("command")]
    assert main(command.split()[2:]) == 0
    assert "pressure" in capsys.readouterr().out
    assert main([*words, "--budget", "1e-6"]) == 0
    assert "the budget does not suffice for 0.1, which takes" in capsys.readouterr().out


def column(count, height, pull, region=None, **more):
    """Spheres above a floor of 6 by 6."""
    kind = gp.Species(count, 0.5, temperature=1.0, exact_temperature=True, region=region)
    box = gp.Container((6.0, 6.0, height), ("periodic", "periodic", "wall"))
    return gp.Scene(box, [kind], gravity=(0.0, 0.0, -pull), **more)


def test_a_plain_gas_between_walls_has_one_pilot_or_two(monkeypatch):
    """As many as there are engines that may be advised, within the time for all of them."""
    made, whole = [], pilot.run_pilot

    def counted(target, engine, seconds, *more):
        made.append(seconds)
        return whole(target, engine, seconds, *more)

    monkeypatch.setattr("gaspart.accuracy.pilot.run_pilot", counted)
    plan.plan_from_pilots(BOX, "pressure", 0.05, pilot_seconds=0.4)
    assert len(made) <= 2 and sum(made) <= 0.4


@pytest.mark.thorough
def test_a_pilot_in_which_a_column_falls_is_continued():
    """Spheres that start at the top of it reach the floor within the first of four parts."""
    scene = column(40, 120.0, 0.1, ((0.0, 0.0, 100.0), (6.0, 6.0, 120.0)))
    target, length = Target(scene, "collision_rate"), 60.0
    found = pilot.run_pilot(target, EventDriven(), 1.0, 1.0 / length)
    assert found.settled > pilot.EQUILIBRATION * length
    assert found.duration == pytest.approx(4.0 * length, rel=0.05) or not found.measured
    steady = pilot.run_pilot(target, EventDriven(), 2.0, 0.005 / length)
    assert steady.measured and steady.settled < pilot.EQUILIBRATION * steady.duration
    value, error = steady.value, math.hypot(steady.accuracy, found.accuracy)
    if found.measured:
        assert found.value == pytest.approx(value, rel=3.0 * error)
    falling = pilot.run_pilot(target, EventDriven(), 3.0, 3.0 / 10.0)
    assert not falling.measured and "is not steady yet" in falling.rule


def test_the_energy_of_random_places_scatters_as_stated():
    """That of the temperature, from the energies of starts, which all have an exact temperature."""
    scene = column(60, 80.0, 0.05)
    energies = []
    for seed in range(100):
        state = initial.initial_state(scene, seed)
        energies.append(state.translational_energy + 0.05 * float(state.positions[:, 2].sum()))
    found = start_scatter(Target(scene, "temperature"))
    assert found.placed and not found.drawn
    column_of = gravity_column(scene)
    hot, cold = (
        column_of.of_energy(np.mean(energies) - 30.0 * 0.05 + k * np.std(energies), False) for k in (1, -1)
    )
    expected = (hot.temperature - cold.temperature) / (hot.temperature + cold.temperature)
    assert found.value == pytest.approx(expected, rel=3.0 / math.sqrt(2.0 * 99.0) + 0.05)
    drawn = replace(scene, species=[replace(scene.species[0], exact_temperature=False)])
    assert start_scatter(Target(drawn, "temperature")).value > found.value
    heated = replace(scene, faces={"z_low": gp.Thermal(1.0)})
    assert start_scatter(Target(heated, "temperature")).value == 0.0


def test_what_cannot_be_measured_is_not_advised():
    """Of ten particles: the table, which knows D of many, does not answer for them."""
    kind = gp.Species(10, 0.5, temperature=1.0, exact_temperature=True)
    few = gp.Scene(gp.Container((6.0, 6.0, 6.0), "periodic"), [kind])
    many = replace(few, species=[replace(kind, count=100)])
    assert is_tabulated(many, "D") and not is_tabulated(few, "D")
    with pytest.raises(gp.SceneError, match="an error needs 16 moving particles or more"):
        plan.plan_from_pilots(few, "D", 0.1, pilot_seconds=0.2)


@pytest.mark.thorough
def test_a_density_is_advised_with_the_impulses_that_an_engine_keeps(tmp_path):
    """Of which the run is shorter than by counts, which are what other engines have."""
    container = gp.Container((6.0, 6.0, 8.0), ("periodic", "periodic", "wall"))
    scene = gp.Scene(container, [gp.Species(20, 0.4, temperature=1.0)], gravity=(0.0, 0.0, -0.5))
    uneven = replace(scene, species=[replace(scene.species[0], polydispersity=0.2)])
    (kept,) = Target(scene, "density").tallies(EventDriven())
    assert kept.to_text() == "z:40"
    for target, engine in (
        (Target(scene, "density"), gp.DSMC(0.1)),
        (Target(scene, "temperature"), EventDriven()),
        (Target(uneven, "density"), EventDriven()),
    ):
        assert target.tallies(engine) == ()
    made = plan.plan_from_pilots(scene, "density", 0.02, pilot_seconds=0.4)
    exact = made.pilots[0]
    assert exact.component.length(0.01) < 0.5 * exact.counted.length(0.01)
    for option in made.options:
        assert (option.noise == exact.component) == (option.engine.name in ("event", "step"))
    own = next(option for option in made.options if option.engine == EventDriven())
    advised = replace(made, options=(own,))
    lines = " ".join(_lines(advised, "scene.yaml"))
    assert "--until density=" in lines and "--impulses z:40" in lines
    until = gp.Accuracy("density", 0.05)
    path = gp.run(scene, EventDriven(), 3, None, 1.0, tmp_path / "run.nc", until=until, at_most=400.0)
    (reached,) = gp.reached_accuracy(path)
    found = measure(path, "density")
    assert reached.met and found.attrs["estimator"] == "counts and impulses"
    assert float((found.error**2).mean() / (found.estimate**2).mean()) ** 0.5 < 0.05
