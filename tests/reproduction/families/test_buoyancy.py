"""Made-up runs and measurements of a large disc in a fluid under gravity, with known answers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import about, judged
from reproduction.families.drawn import Points, column, draw, shows, varied
from reproduction.families.test_gravity import point

import gaspart as gp
from gaspart.reproduction.families.buoyancy import claims, measure
from gaspart.reproduction.families.buoyancy.figure import buoyancy as draw_buoyancy
from gaspart.reproduction.families.shared.columns import Stretch
from gaspart.theory import gravity
from gaspart.theory.brownian import displaced_area

WIDTH, HEIGHT, STRENGTH, RADIUS, SMALL = 24.0, 60.0, 0.05, 3.0, 0.5


def dilute_fluid(rng, frames, count, large):
    """Frames (T, 1 + count, 2) of an ideal gas at temperature 1 around the large disc's places (T, 2)."""
    positions = np.empty((frames, 1 + count, 2))
    for frame, place in enumerate(large):
        chance = rng.random(4 * count) * -np.expm1(-STRENGTH * HEIGHT)
        points = np.stack([WIDTH * rng.random(4 * count), -np.log1p(-chance) / STRENGTH], axis=-1)
        across = np.abs(points[:, 0] - place[0])
        across = np.minimum(across, WIDTH - across)
        outside = across**2 + (points[:, 1] - place[1]) ** 2 > (RADIUS + SMALL) ** 2
        positions[frame] = [place, *points[outside][:count]]
    return positions


def stretch(positions, displaced):
    """The stretch of such frames at temperature 1, whose fluid bears the weight of so many small discs."""
    frames, particles, _ = positions.shape
    energies = np.ones((frames, particles))
    energies[:, 0] = 0.0
    weight = STRENGTH * (particles - 1)
    return Stretch(positions, energies, weight + 2.0 + displaced * STRENGTH, 2.0, 0.0, 1.0)


def measurement(error=0.03):
    """What `measure.buoyancy` gives if theory is right."""
    ratio = RADIUS / SMALL
    eta = np.array([0.4, 0.3, 0.2, 0.1])
    displaced = eta * displaced_area(eta, ratio)
    beyond = np.sqrt(displaced_area(eta, ratio)) - ratio
    height = np.linspace(0.0, HEIGHT, 50)
    (density,) = gravity.hydrostatic_profiles(height, [18.0], [0.08], 2)
    fluid = density * np.pi / 4.0
    fixed = {
        "force": displaced,
        "force_error": 0.02 * displaced,
        "missing": displaced,
        "missing_error": 0.01 * displaced,
        "packing_fraction": eta,
        "packing_fraction_error": 0.001 * eta,
        "force_radius": beyond,
        "force_radius_error": np.full(4, 2.0 * error),
        "count_radius": beyond,
        "count_radius_error": np.full(4, error),
        "radius_expected": beyond,
        "height": np.array([10.0, 20.0, 35.0, 50.0]),
    }
    free = {
        "mass": np.array([5.0, 40.0]),
        "height": np.array([45.0, 2.9]),
        "height_error": np.array([10.0, 1.0]) * error,
        "spread": np.array([6.0, 0.4]),
        "spread_error": np.array([1.0, 0.1]) * error,
        "expected": np.array([45.1, 3.0]),
        "expected_spread": np.array([6.0, 0.4]),
        "lowest": np.full(2, RADIUS - SMALL),
    }
    return xr.Dataset(
        {f"fixed_{name}": ("fixed", value) for name, value in fixed.items()}
        | {f"free_{name}": ("free", value) for name, value in free.items()}
        | {"displaced": ("height", fluid * displaced_area(fluid, ratio))},
        coords={"height": height},
        attrs={"size_ratio": ratio, "strength": STRENGTH, "top": HEIGHT},
    )


def with_source(ds):
    """The same, and ten of the source's discs if theory is right: the first two at the ceiling, the last at
    the floor, the one before too near to it for a claim, the others afloat, at the source's density in the
    middle."""
    expected = np.array([59.9, 59.0, 55.0, 47.0, 39.0, 31.0, 23.0, 15.0, 5.0, 3.1])
    low, high = np.full(10, 2.5), np.full(10, 60.5)
    density = 0.2 + 0.005 * (31.5 - expected) / 8.0
    source = {"mass": 300.0 * density, "density": density, "height": expected, "expected": expected.copy()}
    source |= {"height_error": np.full(10, 0.3), "lowest": low, "highest": high}
    made = ds.assign({f"source_{name}": ("source", value) for name, value in source.items()})
    return made.assign_attrs(source_density=0.2)


SETTINGS = {"bins": 30, "blocks": 8, "clear": 2, "far": 5.0, "near": 3.0, "source_density": 0.2}
SETTINGS |= {"source": ["column_source"]}
COUNT = 30


@pytest.fixture
def points(tmp_path):
    """A point with the disc held fast at height 20 above the small discs' lowest, and one with it free."""
    particle = gp.Particle((12.0, 20.0 + SMALL), (0.0, 0.0), RADIUS, mass=0.5)
    scene = gp.Scene(
        gp.Container((WIDTH, HEIGHT + 2 * SMALL), ("periodic", "wall")),
        [gp.Species(COUNT, SMALL)],
        particles=[particle],
        gravity=(0.0, -STRENGTH),
    )
    scene.to_file(tmp_path / "scene.yaml")
    return [point(tmp_path / "scene.yaml", **{"scene.particles.0.fixed": fixed}) for fixed in (True, False)]


@pytest.fixture
def runs(monkeypatch):
    """Stands in for the trajectories: a list of stretches."""
    made = []
    monkeypatch.setattr(measure, "stretches", lambda point, number: made)
    return made


def test_in_a_dilute_gas_the_radius_that_counts_is_r_more(points, runs):
    rng = np.random.default_rng(1)
    density = COUNT * STRENGTH / -np.expm1(-STRENGTH * HEIGHT) * np.exp(-STRENGTH * 20.0) / WIDTH
    displaced = density * np.pi * (RADIUS + SMALL) ** 2
    place = np.tile([12.0, 20.0], (1500, 1))
    runs += [
        stretch(dilute_fluid(rng, 1500, COUNT, place), displaced * factor)
        for factor in rng.normal(1.0, 0.02, 8)
    ]
    row = measure._measure_fixed(points[0], SETTINGS)
    missing = row["missing"]
    assert row["force"].value == pytest.approx(displaced, rel=0.03)
    assert missing.value == pytest.approx(displaced, abs=4.0 * missing.error + 0.03 * displaced)
    assert missing.error < 0.05 * displaced
    for radius in (row["force_radius"], row["count_radius"]):
        assert radius.value == pytest.approx(1.0, abs=4.0 * radius.error + 0.1)
        assert 0.0 < radius.error < 0.25 and radius.freedom == 7
    assert row["radius_expected"] == pytest.approx(1.0, abs=0.05)
    assert row["packing_fraction"].value == pytest.approx(density * np.pi / 4.0, rel=0.05)


def test_a_free_disc_is_lifted_by_what_it_displaces(points, runs):
    rng = np.random.default_rng(2)
    for _ in range(8):
        # So light a gas carries nothing: the disc's own weight alone counts, M g / T = 0.025.
        chance = rng.random(400)
        low, high = RADIUS - SMALL, HEIGHT - RADIUS + SMALL
        height = low - np.log1p(-chance * -np.expm1(-0.025 * (high - low))) / 0.025
        place = np.stack([WIDTH * rng.random(400), height], axis=-1)
        runs.append(stretch(dilute_fluid(rng, 400, COUNT, place), 0.0))
    row = measure._free(points[1], SETTINGS)
    bare = low + 1.0 / 0.025 - (high - low) / np.expm1(0.025 * (high - low))
    assert row["height"].value == pytest.approx(bare, abs=4.0 * row["height"].error)
    assert row["lowest"] == low and row["mass"] == 0.5
    # Theory knows of the gas, thin as it is: a disc of mass 0.5 displaces 1.4 at the floor, and rises.
    assert row["expected"] > bare + 1.0
    assert row["expected_spread"] == pytest.approx(row["spread"][0], rel=0.1)


def test_the_source_s_discs_are_apart_from_those_in_the_fluid_of_the_fixed_ones(points, runs):
    rng = np.random.default_rng(3)
    place = np.tile([12.0, 20.0], (20, 1))
    runs += [stretch(dilute_fluid(rng, 20, COUNT, place), 1.0 + n) for n in range(8)]
    own = replace(points[1], experiment="column_source", name="own")
    ds = measure.buoyancy([*points, own], SETTINGS)
    assert dict(ds.sizes) == {"fixed": 1, "free": 1, "source": 1, "height": 201}
    assert float(ds["source_density"][0]) == pytest.approx(0.5 / (np.pi * RADIUS**2))
    assert float(ds["source_highest"][0]) == HEIGHT - (RADIUS - SMALL)
    assert ds.attrs["source_density"] == 0.2
    assert "source" not in measure.buoyancy(points, SETTINGS).sizes


def test_theory_agrees_with_itself():
    found = judged(claims.buoyancy(measurement()))
    assert len(found) == 4 + 2 + 2
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("name", "change", "text"),
    [
        ("fixed_count_radius", 0.4, "small discs missing, height"),
        ("fixed_missing", 1.5, "over the weight"),
        ("fixed_force_radius", 0.4, "by the force"),
        ("fixed_force_radius", -0.5, "by the force"),
        ("free_height", 5.0, "of mass 5"),
        ("free_height", 5.0, "displaces less"),
    ],
)
def test_each_claim_can_fail(name, change, text):
    ds = measurement()
    ds[name] = ds[name] + change
    assert "disagrees" in about(claims.buoyancy(ds), text)


def test_the_source_s_discs_float_or_lie_where_theory_has_them():
    ds = with_source(measurement())
    found = claims.buoyancy(ds)
    assert len(found) == 8 + 6 + 2 + 1
    assert set(judged(found).values()) == {"agrees", "reproduced"}
    assert found[-1].measured.error == pytest.approx(0.3 * 0.005 / 8.0 / 2.0 / 0.2, rel=0.3)


@pytest.mark.parametrize(
    ("which", "name", "change", "text", "verdict"),
    [
        (3, "height", 2.0, "source's disc of mass", "disagrees"),
        (0, "height", -4.0, "below the ceiling", "disagrees"),
        (9, "height", 4.0, "above the floor", "disagrees"),
        (slice(None), "density", 0.02, "in the middle", "source in error"),
    ],
)
def test_each_claim_about_the_source_can_fail(which, name, change, text, verdict):
    ds = with_source(measurement())
    ds[f"source_{name}"][which] += change
    found = judged(claims.buoyancy(ds))
    assert verdict in {verdict for claim, verdict in found.items() if text in claim}


def test_too_short_runs_are_inconclusive():
    assert about(claims.buoyancy(measurement(error=0.6)), "radius") == {"inconclusive"}


def test_forces_radii_and_heights_are_drawn():
    ds = varied(with_source(measurement()))
    force, radius, height, own = draw(draw_buoyancy, ds).axes
    eta = "fixed_packing_fraction"
    shows(force, column(ds, eta, "fixed_force"), column(ds, eta, "fixed_missing"))
    shows(radius, column(ds, eta, "fixed_force_radius"), column(ds, eta, "fixed_count_radius"))
    shows(height, column(ds, "free_mass", "free_height"), Points(ds["free_mass"], ds["free_expected"]))
    relative = ds["source_density"] / ds.attrs["source_density"]
    shows(own, Points(relative, ds["source_height"], ds["source_height_error"]))
    assert len(draw(draw_buoyancy, measurement()).axes) == 3  # a source without discs of its own
