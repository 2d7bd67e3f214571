"""g(r) from impulses of pairs: that of counts, with less error, and at contact that of the pressure."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.pairs import STRETCHES, g_by_impulses, mixed_g, radial_distribution, shell_volumes
from gaspart.analysis.run import open_run
from gaspart.cli.options import run_options
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import read_recipe

A = gp.analysis
SCENE = gp.Scene(gp.Container((7.0, 6.0, 5.0), "periodic"), [gp.Species(60, 0.5, temperature=1.0)])
ASKED = gp.PairImpulseTally(2.4, 48, 0.5)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Spheres with their impulses of pairs."""
    path = tmp_path_factory.mktemp("spheres") / "run.nc"
    return gp.run(SCENE, gp.EventDriven(), 5, 160.0, 0.4, path, tallies=[ASKED])


def counted(run):
    """The same without its impulses."""
    return run.assign_attrs(tallies="[]")


def test_g_of_a_run_has_less_error_with_impulses(run):
    with open_trajectory(run) as data:
        found, coarse = A.rdf(data), A.rdf(data, bins=12)
        other, uneven = A.rdf(counted(data), bins=48, furthest=2.4), A.rdf(data, bins=25)
    assert found.sizes["distance"] == 48 and float(found.distance[-1]) == pytest.approx(2.375)
    assert [one.attrs["estimator"] for one in (found, other, uneven)] == [
        "counts and impulses",
        "counts",
        "counts",
    ]
    assert "--pair-impulses 2.4:200:0.1" in other.attrs["note"] and "note" not in found.attrs
    assert not found.estimate[:20].any()
    ratio = (other.error / found.error)[20:] ** 2
    assert float(ratio.median()) > 3.0
    fine = found.estimate.values.reshape(12, 4) * shell_volumes(48, 3).reshape(12, 4)
    assert coarse.estimate.values == pytest.approx(fine.sum(axis=1) / shell_volumes(12, 3) / 64.0, abs=0.05)


def parts_of(run, bins):
    """(2, 16, bins) of the last three quarters of a run, and g(r) by counts in the same stretches."""
    stretches = np.array_split(np.arange(len(run.time)), STRETCHES)
    g = [
        radial_distribution(run.positions[part], SCENE.container.lengths, bins, 2.4)[1] for part in stretches
    ]
    starts = np.array([part[0] for part in stretches])
    return g_by_impulses(run, starts, bins, 2.4), np.array(g, dtype=float) * 60.0 / 59.0


def test_counts_and_impulses_agree_and_at_contact_with_the_pressure(run):
    """Impulses alone, with no number of pairs from counts."""
    with open_run(run, 40.0) as part:
        parts, g = parts_of(part, 16)
        virial = part.growth("virial_sum") / part.temperature * 210.0 / (0.5 * 60.0 * 59.0 * 4.0 * np.pi)
    apart = (g - parts.sum(axis=0))[:, 7:]
    z = apart.mean(axis=0) / apart.std(axis=0, ddof=1) * 4.0
    assert abs(z).max() < 4.0
    assert parts[0, :, 7:].mean(axis=0) == pytest.approx(
        np.full(9, virial), rel=0.02
    )  # times of the stretches
    assert abs(z[0]) < 3.0 and g[:, 7].mean() < virial


def test_impulses_take_the_number_of_pairs_from_counts():
    rng = np.random.default_rng(1)
    volumes, truth = shell_volumes(20, 3), np.where(np.arange(20) < 8, 0.0, 1.0 + np.exp(8.0 - np.arange(20)))
    counts = truth * (1.0 + 0.3 * rng.standard_normal((STRETCHES, 20)))
    contact = np.where(np.arange(20) < 8, 0.0, 2.0) * (1.0 + 0.2 * rng.standard_normal((STRETCHES, 1)))
    mixed = mixed_g(
        counts, np.stack([contact, np.broadcast_to(truth - 2.0 * (truth > 0.0), counts.shape)]), volumes
    )
    assert (mixed @ volumes).mean() == pytest.approx((counts @ volumes).mean(), rel=0.05)
    assert abs(mixed - truth)[:, 8:].mean() < 0.7 * abs(counts - truth)[:, 8:].mean()


def test_particles_that_hardly_meet_have_the_g_of_an_ideal_gas(tmp_path):
    small = gp.Scene(SCENE.container, [gp.Species(60, 0.03, temperature=1.0)])
    kept = [gp.PairImpulseTally(2.0, 20, 0.5)]
    path = gp.run(small, gp.EventDriven(), 2, 200.0, 2.0, tmp_path / "run.nc", tallies=kept)
    with open_trajectory(path) as data:
        found, other = A.rdf(data), A.rdf(counted(data), bins=20, furthest=2.0)
    assert ((found.estimate - 1.0) / found.error)[5:].values == pytest.approx(np.zeros(15), abs=4.0)
    assert float((other.error / found.error)[5:].median()) > 2.0


def test_particles_that_never_meet_have_the_g_of_counts(tmp_path):
    points = gp.Scene(SCENE.container, [gp.Species(40, 1e-4, temperature=1.0)])
    kept = [gp.PairImpulseTally(2.0, 20)]
    path = gp.run(points, gp.EventDriven(), 2, 20.0, 0.5, tmp_path / "run.nc", tallies=kept)
    with open_trajectory(path) as data:
        assert data["collisions"][-1] == 0
        found, other = A.rdf(data), A.rdf(counted(data), bins=20, furthest=2.0)
    assert np.isfinite(found.estimate).all()
    assert (np.isfinite(found.error) == (found.estimate > 0.0)).all()  # an empty bin states no error
    assert found.estimate.values == pytest.approx(other.estimate.values)
    assert found.attrs["estimator"] == other.attrs["estimator"]


def test_a_run_that_is_extended_keeps_its_impulses(tmp_path):
    made = [
        gp.run(SCENE, gp.EventDriven(), 1, time, 0.5, tmp_path / name, tallies=[ASKED], keep_checkpoint=True)
        for time, name in ((4.0, "whole.nc"), (2.0, "short.nc"))
    ]
    assert gp.resume(made[1], duration=4.0).read_bytes() == made[0].read_bytes()
    assert f"--pair-impulses {ASKED.to_text()}" in " ".join(run_options(made[0], read_recipe(made[0])))
