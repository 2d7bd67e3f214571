"""Made-up slits with known answers, in the form that `measure.film` gives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, column, draw, shows, varied

from gaspart import run, theory
from gaspart.reproduction.families.film import claims, measure
from gaspart.reproduction.families.film.figure import thin_film
from gaspart.reproduction.points.point import Point

BULK = 0.35
WIDTHS = np.array([2.25, 2.5, 3.0, 3.5, 4.0, 5.0, 12.0])


def slits(error=0.003, seed=1):
    """Slits in equilibrium with a bulk; solvation pressure a damped cosine of period 1."""
    rng = np.random.default_rng(seed)
    density = theory.number_density(BULK, 3)
    bulk = density * float(theory.compressibility_factor(BULK, 3))
    solvation = 1.5 * np.exp(2.0 - WIDTHS) * np.cos(2.0 * np.pi * WIDTHS)
    pressure, one = bulk + solvation, np.ones(WIDTHS.size)
    potential = np.log(density) + theory.excess_chemical_potential(BULK, 3)

    def noisy(values, scale):
        return values + scale * rng.standard_normal(values.shape)

    place = np.linspace(0.05, 5.45, 55)
    profile = density * (1.0 + 4.0 * np.exp(-3.0 * place))
    columns = {
        "pressure": noisy(pressure, error * pressure), "pressure_error": error * pressure,
        "contact": noisy(pressure, 2.0 * error * pressure), "contact_error": 2.0 * error * pressure,
        "truncation": 5e-4 * pressure, "functional_pressure": pressure - 0.01,
        "chemical_potential": noisy(potential * one, 0.04), "chemical_potential_error": 0.04 * one,
        "at_bulk": pressure, "at_bulk_error": 0.03 * one,
    }  # fmt: skip
    return xr.Dataset(
        {
            **{name: ("width", values) for name, values in columns.items()},
            "curve": ("theory_width", bulk - 0.01 + np.zeros(20)),
            "place": ("bin", place),
            "density": ("bin", profile),
            "density_error": ("bin", 0.01 * profile),
            "functional": ("bin", profile),
            "middle": float(density * (1.0 + 1e-3 * rng.standard_normal())),
            "middle_error": 1e-3 * density,
        },
        coords={"width": WIDTHS, "theory_width": np.linspace(2.0, 5.5, 20)},
        attrs={
            "bulk_density": density, "bulk_pressure": bulk, "functional_bulk_pressure": bulk - 0.01,
            "bulk_chemical_potential": potential, "period": 1.01, "period_error": 0.01,
            "functional_period": 1.02,
        },
    )  # fmt: skip


def slit(rng, density, width, samples, side=6.0):
    """Particles that do not interact, uniform between the walls, and the pressure that they exert."""
    count = round(density * side**2 * (width - 1.0))
    positions = rng.random((samples, count, 3)) * [side, side, width - 1.0] + [0.0, 0.0, 0.5]
    height = np.minimum(positions[..., 2], width - positions[..., 2]) - 0.5
    sides = np.array([side, side, width])
    return measure.Slit(rng.normal(density, 0.01, samples), height, width, side**2, positions, sides)


def test_contact_density_of_uniform_particles_is_their_density():
    rng = np.random.default_rng(1)
    one = slit(rng, 0.5, 5.0, 600)
    density = measure._contact(one)
    assert abs(density.value - 0.5) < 4.0 * density.error < 0.2


def test_insertion_into_a_dilute_gas_of_points_counts_their_spheres():
    # Each of the 29 points forbids a ball of radius 1, on average 3/16 less of it within 1 of either wall.
    rng = np.random.default_rng(2)
    one = slit(rng, 0.1, 9.0, 64)
    potential = measure._widom(one, 64_000, 3)
    forbidden = 4.0 / 3.0 * np.pi * (1.0 - 2.0 * (3.0 / 16.0) / 8.0)
    expected = np.log(30 / 288.0) - 29 * np.log(1.0 - forbidden / 288.0)
    assert potential.value == pytest.approx(expected, abs=4.0 * potential.error + 0.005)
    assert potential.error < 0.01


def test_a_real_slit_obeys_the_contact_theorem(tmp_path):
    settings = {
        "dimension": 3, "count": 60, "radius": 0.5, "side": [5.0, 5.0, 5.0], "temperature": 2.0,
        "boundary": ["periodic", "periodic", "wall"], "arrangement": "lattice",
        "duration": 120, "equilibration": 5, "samples": 256,
    }  # fmt: skip
    point = Point("test", "single", "simulate", settings, str(tmp_path), 7)
    path = point.replica_path(0)
    Path(path).parent.mkdir(parents=True)
    schedule = point.schedule
    run(
        point.scene,
        point.engine,
        point.seed(0),
        schedule.duration,
        schedule.sample_interval,
        path,
    )
    dataset = measure.thin_film(
        [point], {"bulk_packing_fraction": 0.3, "insertions": 6400, "theory_widths": [2.0, 3.0, 2]}
    )
    error = float(np.hypot(dataset["contact_error"], dataset["pressure_error"])[0])
    assert abs(float(dataset["contact"][0] - dataset["pressure"][0])) < 4.0 * error
    assert error < 0.1 * float(dataset["pressure"][0])
    mean = float((dataset["density"] * 2.0 * (dataset["place"][1] - dataset["place"][0])).sum())
    assert mean == pytest.approx(60 / 25.0, rel=1e-6)
    assert dataset.attrs["bulk_density"] == pytest.approx(theory.number_density(0.3, 3))


def verdicts(dataset):
    return judged(claims.thin_film(dataset))


def verdict(found, text):
    return next(verdict for claim, verdict in found.items() if text in claim)


def test_slits_as_theory_says_agree():
    found = verdicts(slits())
    assert len(found) == 6
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("name", "factor", "text"),
    [
        ("contact", 1.05, "on it, width 12"),
        ("contact", 1.02, "all widths"),
        ("pressure", 1.02, "bulk's at the density"),
        ("chemical_potential", 1.04, "by insertion"),
    ],
)
def test_each_claim_can_fail(name, factor, text):
    dataset = slits()
    dataset[name] = dataset[name] * factor
    assert verdict(verdicts(dataset), text) == "disagrees"


def test_a_solvation_pressure_unlike_the_functionals_is_found():
    dataset = slits()
    dataset["at_bulk"] = 1.5 * dataset["at_bulk"] - 0.5 * dataset.attrs["bulk_pressure"]
    assert verdict(verdicts(dataset), "over that of the density functional") == "disagrees"


def test_another_period_is_found():
    dataset = slits()
    dataset.attrs["period"] = 1.3
    assert verdict(verdicts(dataset), "period") == "disagrees"


def test_few_widths_claim_no_oscillation():
    assert len(verdicts(slits().isel(width=[1, 2, 6]))) == 4


def test_density_contact_theorem_and_solvation_pressure_are_drawn():
    ds = varied(slits(), "place")
    profile, contact, solvation = draw(thin_film, ds).axes
    wall = Points([0.0], ds["pressure"][-1:], ds["pressure_error"][-1:])
    shows(profile, column(ds, "place", "density"), wall)
    width = ds["width"].values.copy()
    width[-1] = 5.8  # the widest at the end of the axis
    ratio = ds["contact"] / ds["pressure"]
    error = np.hypot(ds["contact_error"], ds["truncation"]) / ds["contact"]
    error = np.hypot(error, ds["pressure_error"] / ds["pressure"])
    shows(contact, Points(width, 100.0 * (ratio - 1.0), 100.0 * ratio * error))
    excess = ds["at_bulk"] - ds.attrs["bulk_pressure"]
    shows(solvation, Points(width, excess, ds["at_bulk_error"]))
