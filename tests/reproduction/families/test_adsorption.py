"""A made-up measurement of walls that hold particles, with known answers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, column, draw, shows, varied

from gaspart import run
from gaspart.reproduction.families.adsorption import claims, measure
from gaspart.reproduction.families.adsorption.figure import adsorption as draw_adsorption
from gaspart.reproduction.points.point import Point
from gaspart.theory import adsorption as theory
from gaspart.theory.adsorption import flux_density, slow_flux_share, well_ratio
from gaspart.theory.tables import packing_fraction_at

SPEED = np.linspace(0.1, 3.9, 20)


def _row(kind, **values):
    measured = ["ratio", "log_ratio", "length", "coverage", "gas_density", "activity"]
    measured += ["filling", "filling_by_activity"]
    names = ["temperature", "depth", "width", "momentum", *measured, *(f"{name}_error" for name in measured)]
    row = dict.fromkeys(names, np.nan)
    flux = theory.flux_density(SPEED) * (SPEED > 1.0 if kind == "sticky" else 1.0)
    slow = 0.0 if kind == "sticky" else theory.slow_flux_share(1.0)
    row |= {"kind": kind, "flux": flux, "flux_error": 0.01 + 0.0 * flux, "slow_speed": 1.0, "outside": 2.0}
    row["mass"] = 1.0
    return row | {"slow_share": slow, "slow_share_error": 0.002, "temperature": 1.0} | values


def walls(power=0.0, coverage_power=0.0):
    """What `measure.adsorption` gives if theory is right, its length going as T^power and the coverage of the
    sticky wall as the gas' density to `coverage_power`."""
    rows = []
    for depth in (1.0, 2.0):
        for temperature in (0.4, 0.6, 1.0, 2.0):
            length = 0.2 * temperature**power
            ratio = theory.well_ratio(depth / temperature, length, 2.0)
            rows.append(
                _row(
                    "ideal", temperature=temperature, depth=depth, width=0.2, ratio=ratio,
                    ratio_error=0.002 * ratio, log_ratio=np.log(ratio), log_ratio_error=0.002,
                    length=length, length_error=0.002 * length,
                )
            )  # fmt: skip
    for activity, deviation in ((0.1, 1.0), (1.0, -1.2), (10.0, 0.5)):
        coverage = float(packing_fraction_at(activity, 2))
        rows.append(
            _row(
                "layer", depth=5.0, width=0.1, coverage=coverage, coverage_error=0.01 * coverage,
                activity=activity, activity_error=0.02 * activity, filling=1.0 + 0.004 * deviation,
                filling_error=0.004,
                filling_by_activity=0.985, filling_by_activity_error=0.004,
            )
        )  # fmt: skip
    for density in (0.01, 0.02, 0.05):
        coverage = 0.07 * (density / 0.01) ** coverage_power
        rows.append(
            _row("sticky", momentum=1.0, coverage=coverage, coverage_error=0.001, gas_density=density)
        )
    arrays = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    values = {
        name: (("point", "bin") if array.ndim == 2 else "point", array) for name, array in arrays.items()
    }
    return xr.Dataset(values, coords={"speed": ("bin", SPEED)})


SCENES = Path(__file__).parents[3] / "config/scenes"
SETTINGS = {"blocks": 10, "layer_blocks": 10, "near": 0.5, "bins": 20}


def point(name, folder="results/points", **settings):
    settings = {"scene": str(SCENES / f"adsorption_{name}.yaml"), "duration": 60.0, "samples": 30} | settings
    return Point("held", "single", "simulate", {"equilibration": 20.0} | settings, str(folder), 1)


def test_what_holds_is_read_from_the_scene():
    ideal, layer, sticky = (measure.Holder.of(point(name)) for name in ("ideal", "monolayer", "sticky"))
    assert (ideal.kind, layer.kind, sticky.kind) == ("ideal", "layer", "sticky")
    assert ideal.outside == pytest.approx(1.975 - 0.2)
    assert (layer.width, layer.outside, layer.area) == (0.1, pytest.approx(38.9), 100.0)
    assert (sticky.momentum, sticky.depth, sticky.outside) == (1.0, 0.0, 9.0)


def test_an_ideal_gas_in_frames_is_counted_as_it_was_made():
    """Independent frames of a Maxwellian gas, in the Boltzmann distribution of the well."""
    rng = np.random.default_rng(4)
    holder = measure.Holder.of(point("ideal"))
    odds = well_ratio(holder.depth, holder.width, holder.outside)
    inside = rng.random((400, 500)) < odds / (1.0 + odds)
    where = rng.random(inside.shape)
    height = np.where(inside, where * holder.width, holder.width + where * holder.outside)
    velocity = rng.standard_normal(inside.shape)
    held, free, far, slowly, flux = measure.counts_of(holder, height, velocity, SETTINGS, 1.0)
    error = np.sqrt((1.0 + odds) ** 2 / (odds * inside.size))  # of ln(held / free)
    assert np.log(held / free / odds) == pytest.approx(0.0, abs=4.0 * error)
    assert far / free == pytest.approx(1.0 - 0.05 / holder.outside, abs=0.001)
    assert slowly / flux.sum() == pytest.approx(slow_flux_share(1.0), abs=0.01)
    middle = np.linspace(0.1, 3.9, 20)
    assert flux / (flux.sum() * 0.2) == pytest.approx(flux_density(middle), abs=0.03)


def test_only_particles_without_a_velocity_along_the_normal_are_stuck():
    holder = measure.Holder.of(point("sticky"))
    height, velocity = np.array([[0.0, 0.1, 0.2, 5.0]]), np.array([[0.0, 0.5, -0.5, 2.0]])
    held, free, far, slowly, flux = measure.counts_of(holder, height, velocity, SETTINGS, 1.0)
    assert (held, free, far) == (1.0, 3.0, 1.0)
    assert slowly == flux.sum() == flux[2] == 0.5  # one leaves, with 0.5


@pytest.mark.thorough
def test_a_real_well_holds_as_many_as_it_must(tmp_path):
    one = point("ideal", tmp_path, **{"scene.faces.x_low.depth": 1.0})
    path = one.replica_path(0)
    Path(path).parent.mkdir(parents=True)
    times = one.schedule
    run(one.scene, one.engine, one.seed(0), times.duration, times.sample_interval, path)
    dataset = measure.adsorption([one], SETTINGS).isel(point=0)
    expected = well_ratio(1.0, 0.2, 1.975 - 0.2)
    error = float(dataset["log_ratio_error"])
    assert 0.005 < error < 0.04
    assert np.log(float(dataset["ratio"]) / expected) == pytest.approx(0.0, abs=4.0 * error)
    # A little more than counted, since spheres close room to each other, most where they are dense.
    assert 1.0001 < float(dataset["length"]) / (0.2 * float(dataset["ratio"]) / expected) < 1.001
    assert np.isnan(dataset["filling"])
    with pytest.raises(ValueError, match="blocks: 31"):
        measure.adsorption([one], SETTINGS | {"blocks": 31})


def test_the_coverage_of_a_layer_is_compared_with_that_of_discs():
    holder = measure.Holder.of(point("monolayer"))
    density, held = 0.01, 25.0
    for _ in range(50):  # until the coverage is that of discs at the activity which it gives the layer
        held /= holder.filling(held, density, 1e9)
    assert holder.filling(held, density, 1e9) == pytest.approx(1.0)
    plain = packing_fraction_at(holder.activity(density), 2)
    assert 1.002 < holder.coverage(held) / plain < 1.006  # more than with the pressure alone, by first order
    assert 1.002 < 1.0 / holder.filling(held, density, 40.0) < 1.006  # a small gas leaves the layer more


def verdicts(dataset):
    return judged(claims.adsorption(dataset))


def verdict(found, text):
    return next(verdict for claim, verdict in found.items() if text in claim)


def test_walls_as_theory_says_agree():
    found = verdicts(walls())
    assert len(found) == 11
    assert set(found.values()) == {"agrees"}


def test_a_thermal_wavelength_is_found():
    found = verdicts(walls(power=-0.5))
    assert verdict(found, "power of T in h") == "disagrees"
    assert verdict(found, "slope of ln") == "disagrees"


def test_a_coverage_that_follows_henrys_law_is_found():
    assert verdict(verdicts(walls(coverage_power=1.0)), "power of the gas' density") == "disagrees"


@pytest.mark.parametrize(
    ("name", "kind", "change", "text"),
    [
        ("length", "ideal", 0.01, "over the well's width"),
        ("filling", "layer", 0.06, "coverage over that of hard discs"),
        ("slow_share", "ideal", 0.02, "wells: share"),
        ("slow_share", "sticky", 0.3, "slow particles that leave"),
    ],
)
def test_each_claim_can_fail(name, kind, change, text):
    dataset = walls()
    dataset[name] = dataset[name] + change * (dataset["kind"] == kind)
    assert verdict(verdicts(dataset), text) == "disagrees"


def test_the_panels_show_the_columns_of_the_data_set():
    ds = varied(walls(), "depth", "width")
    ratios, deviations, lengths, layer, coverage, leaving = draw(draw_adsorption, ds).axes
    wells = [ds.isel(point=slice(0, 4)), ds.isel(point=slice(4, 8))]
    tops, bottoms = [], []
    for kind, row in enumerate(wells):
        depth, width, outside = (float(row[name][0]) for name in ("depth", "width", "outside"))
        inverse = 1.0 / row["temperature"]
        tops.append(Points(inverse, row["ratio"], row["ratio_error"]))
        deviation = 100.0 * (row["log_ratio"] - np.log(well_ratio(depth * inverse, width, outside)))
        bottoms.append(Points(inverse + 0.02 * (kind - 1), deviation, 100.0 * row["log_ratio_error"]))
    shows(ratios, *tops)
    shows(deviations, *bottoms)
    width = 0.2
    shows(
        lengths,
        *(Points(row["temperature"], row["length"] / width, row["length_error"] / width) for row in wells),
    )
    own = ds.isel(point=slice(8, 11))
    shows(layer, Points(own["activity"], own["coverage"], own["coverage_error"], own["activity_error"]))
    sticky = ds.isel(point=slice(11, 14))
    shows(coverage, column(sticky, "gas_density", "coverage"))
    densest = sticky.isel(point=int(sticky["gas_density"].values.argmax()))
    shows(leaving, column(ds.isel(point=0), "speed", "flux"), column(densest, "speed", "flux"))
