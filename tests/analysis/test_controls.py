"""Control variates: of planted series, and of pressures on walls against virial theorem and equipartition."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.accuracy.estimates import components
from gaspart.accuracy.target import Target
from gaspart.analysis.impulses import group_count, subtract_controls, wall_controls
from gaspart.analysis.run import open_run
from gaspart.analysis.series import face_pressures
from gaspart.runs.ending import Accuracy
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import read_recipe

A = gp.analysis
SLIT = gp.Container((5.0, 5.0, 8.0), ("periodic", "periodic", "wall"))
GAS = gp.Species(19, 0.5, temperature=1.0)
SCENE = gp.Scene(SLIT, [GAS])
PLANTED = 2000


def test_planted_controls_are_taken_off_and_leave_the_mean_unbiased():
    """In 2000 series of mean 5 that have 3 and -2 of two controls, and noise of 0.5."""
    rng = np.random.default_rng(1)
    controls, noise = rng.standard_normal((PLANTED, 96, 2)), rng.standard_normal((PLANTED, 96))
    series = 5.0 + controls @ (3.0, -2.0) + 0.5 * noise
    found = np.array([subtract_controls(*one, 64) for one in zip(series, controls, strict=True)])
    means = found.mean(axis=1)
    assert means.mean() == pytest.approx(5.0, abs=4.0 * means.std() / PLANTED**0.5)
    assert means.std() == pytest.approx(0.5 / 96**0.5, rel=0.1)  # two coefficients from 32 groups
    claimed = found.std(axis=1, ddof=1) / 96**0.5
    assert np.sqrt((claimed**2).mean()) == pytest.approx(means.std(), rel=0.05)


def test_coefficients_are_those_of_the_other_half():
    rng = np.random.default_rng(2)
    controls, series = rng.standard_normal((64, 1)), rng.standard_normal(64)
    other = series.copy()
    other[:32] += 7.0 * controls[:32, 0]
    before, after = subtract_controls(series, controls, 64), subtract_controls(other, controls, 64)
    assert after[:32] - before[:32] == pytest.approx(7.0 * controls[:32, 0])  # with the coefficient of before
    assert after[32:] - before[32:] == pytest.approx(-7.0 * controls[32:, 0])


@pytest.fixture(scope="module")
def thin(tmp_path_factory):
    """A thin gas between two walls, with its impulses."""
    path = tmp_path_factory.mktemp("thin") / "run.nc"
    return gp.run(SCENE, gp.EventDriven(), 1, 800.0, 0.5, path, tallies=[gp.ImpulseTally("z", 8)])


def test_the_balance_of_the_virial_holds_without_contacts(tmp_path):
    """Of points, to rounding: the impulses of both walls are twice the kinetic energy along their normal,
    over the way that centres have, less what is stored."""
    points = gp.Scene(SLIT, [gp.Species(7, 1e-6, temperature=1.0)])
    path = gp.run(
        points, gp.EventDriven(), 3, 40.0, 1.0, tmp_path / "run.nc", tallies=[gp.ImpulseTally("z", 5)]
    )
    with open_trajectory(path) as data, open_run(data, 0.0) as run:
        assert not run.increments("collisions").any() and not group_count(run)
        low, high = 25.0 * face_pressures(run)[:, 4:].T
        known = wall_controls(run, 2)
        energy = known[:, 0] + 7.0 * run.temperature
    assert low - high == pytest.approx(known[:, 1], abs=1e-4)
    assert 0.5 * (low + high) * 8.0 == pytest.approx(energy - known[:, 2], abs=1e-4)


def test_pressures_have_less_error_and_agree(thin):
    with open_trajectory(thin) as data:
        found, plain = A.wall_pressure(data), A.wall_pressure(data.assign_attrs(tallies="[]"))
        better, usual = (components(one, "pressure") for one in (data, data.assign_attrs(tallies="[]")))
    assert found.attrs["estimator"] != plain.attrs["estimator"] == "wall impulses"
    assert "--impulses z:40" in plain.attrs["note"] and "note" not in found.attrs
    assert "wall_pressure_freedom" not in plain
    assert found["wall_pressure_freedom"].values.tolist() == [12.0, 12.0]  # of 16 blocks and 3 controls
    assert ((plain.error / found.error) ** 2 > 4.0).all()
    apart = (plain.estimate - found.estimate) / np.sqrt(plain.error**2 + found.error**2)
    assert (abs(apart) < 3.0).all() and (abs(found.deviation) < 3.0).all()
    assert float(found.estimate[0]) == pytest.approx(float(found.estimate[1]), rel=1e-3)
    for face, one in better.items():
        assert (usual[face].error(600.0) / one.error(600.0)) ** 2 > 8.0
        assert one.value == pytest.approx(float(found.estimate.sel(face=face)), rel=1e-3)


UNEVEN = {
    "gravity": gp.Scene(SLIT, [GAS], gravity=(0.0, 0.0, -0.3)),
    "a well": gp.Scene(SLIT, [GAS], faces={"z_low": gp.Well(1.0, 0.7)}),
    "a thermal face": gp.Scene(SLIT, [GAS], faces={"z_low": gp.Thermal(1.0)}),
    "rough": gp.Scene(SLIT, [GAS], restitution=gp.Restitution(1.0, 1.0)),
}


@pytest.mark.parametrize("name", UNEVEN)
def test_where_the_energy_is_not_constant_there_are_no_controls(name, tmp_path):
    path = gp.run(
        UNEVEN[name], gp.EventDriven(), 1, 60.0, 0.5, tmp_path / "run.nc", tallies=[gp.ImpulseTally("z", 8)]
    )
    with open_trajectory(path) as data, open_run(data, 0.0) as run:
        assert wall_controls(run, 2) is None and group_count(run)
    found = A.wall_pressure(path)
    assert found.attrs["estimator"] == "wall impulses" and "note" not in found.attrs
    assert not Target(UNEVEN[name], "pressure").tallies(gp.EventDriven())


def test_steps_keep_no_impulses_for_a_pressure_as_they_share_energy_unevenly(tmp_path):
    steps = gp.TimeStepped(0.02)
    run = gp.run(SCENE, steps, 1, 100.0, 0.5, tmp_path / "run.nc", tallies=[gp.ImpulseTally("z", 8)])
    with open_trajectory(run) as data, open_run(data, 0.0) as opened:
        assert wall_controls(opened, 2) is None and group_count(opened)
        found, bare = A.wall_pressure(data), A.wall_pressure(data.assign_attrs(tallies="[]"))
    assert found.attrs["estimator"] == "wall impulses" and found.identical(bare)
    assert "note" not in found.attrs
    for engine, kept in ((steps, 0), (gp.EventDriven(), 1)):
        assert len(Target(SCENE, "pressure", "z low").tallies(engine)) == kept
        assert len(Target(SCENE, "density").tallies(engine)) == 1


def test_a_file_without_all_states_and_another_axis_have_none(tmp_path):
    box = gp.Scene(gp.Container((5.0, 5.0, 8.0)), [GAS])
    path = gp.run(
        box, gp.EventDriven(), 1, 60.0, 0.5, tmp_path / "few.nc", tallies=[gp.ImpulseTally("x", 8)], follow=3
    )
    whole = gp.run(
        box, gp.EventDriven(), 1, 60.0, 0.5, tmp_path / "all.nc", tallies=[gp.ImpulseTally("x", 8)]
    )
    half = gp.run(
        box,
        gp.EventDriven(),
        1,
        60.0,
        0.5,
        tmp_path / "half.nc",
        tallies=[gp.ImpulseTally("x", 8)],
        keep="positions",
    )
    for lacking in (path, half):
        with open_run(lacking, 0.0) as run:
            assert wall_controls(run, 0) is None
    with open_trajectory(half) as data:
        assert len(components(data, "pressure")) == 6
    with open_run(whole, 0.0) as run:
        assert wall_controls(run, 0) is not None and wall_controls(run, 2) is None
    assert A.wall_pressure(whole)["wall_pressure_freedom"].values.tolist() == [12.0, 12.0, *[15.0] * 4]


def test_a_run_until_a_pressure_is_accurate_keeps_what_it_needs(tmp_path):
    box = gp.Scene(gp.Container((5.0, 5.0, 8.0)), [GAS])
    engine = gp.EventDriven()
    kept = [Target(box, "pressure", face).tallies(engine) for face in ("y high", None)]
    assert [one.to_text() for one in kept[0]] == ["y:40"] and not kept[1]  # of all walls the worst counts
    assert not Target(SCENE, "pressure").tallies(gp.DSMC(0.05, (4, 4, 4)))
    path = gp.run(
        SCENE, engine, 1, sample_interval=1.0, path=tmp_path / "run.nc",
        until=Accuracy("pressure", 0.05, face="z low"), at_most=1600.0,
    )  # fmt: skip
    assert [one.to_text() for one in read_recipe(path).tallies] == ["z:40"]
    (reached,) = gp.reached_accuracy(path)
    assert reached.met and reached.freedom >= 15.0


def test_the_pressure_of_two_discs_has_no_controls_and_an_honest_error(tmp_path):
    """With controls 52 of 60 values were within two errors of their mean."""
    kind = gp.Species(2, 0.5, temperature=1.0, exact_temperature=True)
    scene = gp.Scene(gp.Container((2.6, 2.9)), [kind])
    values, errors = [], []
    for seed in range(30):
        path = gp.run(
            scene,
            gp.EventDriven("direct"),
            seed,
            60.0,
            0.25,
            tmp_path / f"{seed}.nc",
            tallies=[gp.ImpulseTally("y", 40)],
        )
        found = gp.measure(path, "pressure").sel(face="y low")
        assert "known mean" not in str(found.attrs["estimator"])
        values.append(float(found.estimate))
        errors.append(float(found.error))
    ratio = np.std(values, ddof=1) / np.sqrt(np.mean(np.square(errors)))
    assert 0.7 < ratio < 1.35  # of 29 degrees of freedom, and 15 of each error
