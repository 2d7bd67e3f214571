from pathlib import Path

import numpy as np
import pytest

from gaspart import run
from gaspart.reproduction.families.adsorption import measure as adsorption
from gaspart.reproduction.points.point import Point
from gaspart.theory.adsorption import flux_density, slow_flux_share, well_ratio
from gaspart.theory.tables import packing_fraction_at

SCENES = Path(__file__).parents[4] / "config/scenes"
SETTINGS = {"blocks": 10, "layer_blocks": 10, "near": 0.5, "bins": 20}


def point(name, folder="results/points", **settings):
    settings = {"scene": str(SCENES / f"adsorption_{name}.yaml"), "duration": 60.0, "samples": 30} | settings
    return Point("held", "single", "simulate", {"equilibration": 20.0} | settings, str(folder), 1)


def test_what_holds_is_read_from_the_scene():
    ideal, layer, sticky = (adsorption.Holder.of(point(name)) for name in ("ideal", "monolayer", "sticky"))
    assert (ideal.kind, layer.kind, sticky.kind) == ("ideal", "layer", "sticky")
    assert ideal.outside == pytest.approx(1.975 - 0.2)
    assert (layer.width, layer.outside, layer.area) == (0.1, pytest.approx(38.9), 100.0)
    assert (sticky.momentum, sticky.depth, sticky.outside) == (1.0, 0.0, 9.0)


def test_an_ideal_gas_in_frames_is_counted_as_it_was_made():
    """Independent frames of a Maxwellian gas, in the Boltzmann distribution of the well."""
    rng = np.random.default_rng(4)
    holder = adsorption.Holder.of(point("ideal"))
    odds = well_ratio(holder.depth, holder.width, holder.outside)
    inside = rng.random((400, 500)) < odds / (1.0 + odds)
    where = rng.random(inside.shape)
    height = np.where(inside, where * holder.width, holder.width + where * holder.outside)
    velocity = rng.standard_normal(inside.shape)
    held, free, far, slowly, flux = adsorption.counts_of(holder, height, velocity, SETTINGS, 1.0)
    error = np.sqrt((1.0 + odds) ** 2 / (odds * inside.size))  # of ln(held / free)
    assert np.log(held / free / odds) == pytest.approx(0.0, abs=4.0 * error)
    assert far / free == pytest.approx(1.0 - 0.05 / holder.outside, abs=0.001)
    assert slowly / flux.sum() == pytest.approx(slow_flux_share(1.0), abs=0.01)
    middle = np.linspace(0.1, 3.9, 20)
    assert flux / (flux.sum() * 0.2) == pytest.approx(flux_density(middle), abs=0.03)


def test_only_particles_without_a_velocity_along_the_normal_are_stuck():
    holder = adsorption.Holder.of(point("sticky"))
    height, velocity = np.array([[0.0, 0.1, 0.2, 5.0]]), np.array([[0.0, 0.5, -0.5, 2.0]])
    held, free, far, slowly, flux = adsorption.counts_of(holder, height, velocity, SETTINGS, 1.0)
    assert (held, free, far) == (1.0, 3.0, 1.0)
    assert slowly == flux.sum() == flux[2] == 0.5  # one leaves, with 0.5


def test_a_real_well_holds_as_many_as_it_must(tmp_path):
    one = point("ideal", tmp_path, **{"scene.faces.x_low.depth": 1.0})
    path = one.replica_path(0)
    Path(path).parent.mkdir(parents=True)
    times = one.schedule
    run(one.scene, one.engine, one.seed(0), times.duration, times.sample_interval, path)
    dataset = adsorption.adsorption([one], SETTINGS).isel(point=0)
    expected = well_ratio(1.0, 0.2, 1.975 - 0.2)
    error = float(dataset["log_ratio_error"])
    assert 0.005 < error < 0.04
    assert np.log(float(dataset["ratio"]) / expected) == pytest.approx(0.0, abs=4.0 * error)
    # A little more than counted, since spheres close room to each other, most where they are dense.
    assert 1.0001 < float(dataset["length"]) / (0.2 * float(dataset["ratio"]) / expected) < 1.001
    assert np.isnan(dataset["filling"])
    with pytest.raises(ValueError, match="blocks: 31"):
        adsorption.adsorption([one], SETTINGS | {"blocks": 31})


def test_the_coverage_of_a_layer_is_compared_with_that_of_discs():
    holder = adsorption.Holder.of(point("monolayer"))
    density, held = 0.01, 25.0
    for _ in range(50):  # until the coverage is that of discs at the activity which it gives the layer
        held /= holder.filling(held, density, 1e9)
    assert holder.filling(held, density, 1e9) == pytest.approx(1.0)
    plain = packing_fraction_at(holder.activity(density), 2)
    assert 1.002 < holder.coverage(held) / plain < 1.006  # more than with the pressure alone, by first order
    assert 1.002 < 1.0 / holder.filling(held, density, 40.0) < 1.006  # a small gas leaves the layer more
