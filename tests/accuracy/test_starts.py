"""Errors of runs that keep the energy of a start which their seed draws."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.accuracy.reached import AccuracyStatus, Examiner
from gaspart.accuracy.scatter import scatter_of_run, start_scatter
from gaspart.accuracy.target import Target
from gaspart.cli import main
from gaspart.trajectory.replicas import opened_together

PAIRS = 10
STRESS = gp.Correlations(interval=0.05, lags=12, stress=True)


def scene(boundary="periodic", faces=None, exact=False, count=48):
    kind = gp.Species(count, 0.5, temperature=1.0, exact_temperature=exact)
    return gp.Scene(gp.Container((6.0, 6.0, 6.0), boundary), [kind], faces=faces or {})


def paths(folder, made, **options):
    found = []
    for seed in range(2 * PAIRS):
        path = folder / f"{seed}.nc"
        found.append(gp.run(made, gp.EventDriven(), seed, 90.0, 0.3, path, displacements=True, **options))
    return found


def statuses(files, name):
    """The status of each pair of runs."""
    asked, found = (gp.Accuracy.from_name(name, 0.1),), []
    for n in range(PAIRS):
        with opened_together(files[2 * n : 2 * n + 2]) as runs:
            found += Examiner().examine(runs, asked, runs[0].sizes["frame"])
    return found


@pytest.fixture(scope="module")
def periodic(tmp_path_factory):
    return paths(tmp_path_factory.mktemp("periodic"), scene(), correlations=STRESS)


@pytest.fixture(scope="module")
def walled(tmp_path_factory):
    return paths(tmp_path_factory.mktemp("walled"), scene(("periodic", "periodic", "wall")))


@pytest.fixture(scope="module")
def heated(tmp_path_factory):
    faces = {"z_low": gp.Thermal(1.0), "z_high": gp.Thermal(2.0)}
    return paths(tmp_path_factory.mktemp("heated"), scene(("periodic", "periodic", "wall"), faces))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("runs", "name"),
    [
        ("periodic", "collision_rate"),
        ("periodic", "D"),
        ("periodic", "shear_viscosity"),
        ("walled", "pressure:z low"),
        ("walled", "collision_rate"),
        ("heated", "heat_flux:z low"),
    ],
)
def test_the_mean_of_two_replicas_scatters_by_its_error(runs, name, request):
    """Of ten pairs, so that the ratio is uncertain by a quarter; of a pressure without the starts it is 8."""
    known = statuses(request.getfixturevalue(runs), name)
    ratio = np.std([one.value for one in known], ddof=1) / np.sqrt(np.mean([one.error**2 for one in known]))
    print(name, ratio)
    assert 0.45 < ratio < 1.5  # chi of 9 degrees of freedom: 1 % beyond each


def test_a_single_run_states_the_scatter_of_other_seeds(walled, capsys):
    with gp.open_trajectory(walled[0]) as run:
        (one,) = Examiner().examine([run], (gp.Accuracy("pressure", 0.1, face="z low"),), run.sizes["frame"])
        exact = math.sqrt(2.0 / (3.0 * 48.0))
        assert one.scatter == pytest.approx(exact) and one.error == one.noise < 0.2 * exact * one.value
        assert scatter_of_run(run, "collision_rate").value == pytest.approx(0.5 * exact)
        assert scatter_of_run(run, "density").value == 0.0
    assert main(["measure", str(walled[0]), "collision_rate", "density"]) == 0
    text = capsys.readouterr().out
    assert text.count("(for the energy of this run; other seeds scatter by 5.9 %)") == 1


@pytest.mark.thorough
def test_runs_without_an_energy_of_their_own_have_no_scatter(tmp_path, heated):
    with gp.open_trajectory(heated[0]) as run:
        assert scatter_of_run(run, "collision_rate").value == 0.0
    assert start_scatter(Target(scene(exact=True), "collision_rate")).value == 0.0
    state = gp.Simulation(scene(), gp.EventDriven(), 1).state
    given = gp.run(scene(), gp.EventDriven(), 1, 2.0, 0.5, tmp_path / "given.nc", initial=state)
    with gp.open_trajectory(given) as run:
        assert scatter_of_run(run, "collision_rate").value == 0.0


def test_the_temperature_under_a_piston_scatters_with_the_enthalpy():
    """Of an ideal gas: H = (d/2 + 1) N T in equilibrium."""
    piston = {"z_high": gp.Piston(mass=5.0, pressure=0.2)}
    loaded = scene(("periodic", "periodic", "wall"), piston)
    enthalpy = 1.5 * 48.0 + 0.2 * 216.0
    found = start_scatter(Target(loaded, "temperature")).value
    assert found == pytest.approx(1.5 * math.sqrt(1.5 * 48.0) / enthalpy)
    assert start_scatter(Target(loaded, "pressure")).value == 0.0
    driven = {"z_high": gp.Piston(speed=0.1)}
    assert start_scatter(Target(scene(("periodic", "periodic", "wall"), driven), "temperature")).value == 0.0


def test_what_replicas_never_reach_is_refused_and_otherwise_ends_when_noise_is_as_small(tmp_path):
    walls = scene(("periodic", "periodic", "wall"))
    asked = {"until": gp.Accuracy("pressure", 0.05), "path": tmp_path / "run.nc", "replicas": 2}
    rule = (
        r"starts alone scatter the mean of 2 replicas by 8.3 %: exact_temperature: true removes it; 12 repl"
    )
    with pytest.raises(gp.SceneError, match=rule):
        gp.run(walls, gp.EventDriven(), 1, **asked)
    known = AccuracyStatus(gp.Accuracy("pressure", 0.05), "", 1.0, 1.0, 0.01, 50.0, True, "", 0.12, 2)
    assert (
        known.excess < 1.0
        and not known.met
        and known.error == pytest.approx(math.hypot(0.01, 0.0849), rel=1e-3)
    )
    assert replace(known, scatter=0.04).met and not replace(known, scatter=0.06, noise=0.025).met
    assert replace(known, replicas=1).met and replace(known, replicas=1).error == 0.01


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_density_at_a_piston_scatters_with_the_enthalpy_of_the_start(dimension):
    """Points of a given enthalpy H have the height h with the density h^N (H - p h)^(freedoms / 2 - 1)."""
    count, sides = 150, (1.0,) * (dimension - 1)
    kind, face = gp.Species(count, 1e-6, temperature=1.0), gp.Piston(mass=150.0, pressure=count / 20.0)
    made = gp.Scene(
        gp.Container((*sides, 20.0), "wall"), [kind], faces={"xyz"[dimension - 1] + "_high": face}
    )
    enthalpy = count * (0.5 * dimension + 1.0)
    heights = np.linspace(10.0, 30.0, 4001)

    def density(total):
        free = np.maximum(total - count * heights / 20.0, 1e-300)
        weight = count * np.log(heights) + (0.5 * (dimension * count + 1) - 1.0) * np.log(free)
        weight = np.exp(weight - weight.max())
        return np.cumsum((weight / heights)[::-1])[::-1] / weight.sum()

    low, high = density(0.999 * enthalpy), density(1.001 * enthalpy)
    change = np.abs(high - low).max() / 0.002 / density(enthalpy)[0]
    expected = change * math.sqrt(0.5 * dimension * count) / enthalpy
    assert start_scatter(Target(made, "density")).value == pytest.approx(expected, rel=0.03)
    assert start_scatter(Target(made, "temperature")).value < 0.3 * expected
