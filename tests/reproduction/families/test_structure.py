"""Made-up measurements of structure and chemical potential, of fluids that are as theory says."""

from __future__ import annotations

import numpy as np
import pytest
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, draw, estimates, shows, varied

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import fit_polynomial
from gaspart.reproduction.families.structure import claims, figure, measure, potential
from gaspart.reproduction.families.structure.figure import SHIFT
from gaspart.reproduction.families.structure.potential import POWERS, MeasuredState
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import entries, from_rows

RATIOS = ("s0_ratio", "g_ratio", "rate_ratio")
POINTS = ((3, 0.1), (3, 0.3), (3, 0.45), (2, 0.3), (2, 0.6))


def structure(error=0.002, seed=1):
    """Ratios of 1 and curves of Verlet and Weis (discs: without oscillations), each off by a random error."""
    rng, rows = np.random.default_rng(seed), []
    r, k = 0.02 * (np.arange(200) + 0.5), 0.25 * (np.arange(80) + 0.5)
    for dimension, eta in POINTS:
        spheres = dimension == 3
        g = theory.verlet_weis_rdf(r, eta) if spheres else np.where(r < 1.0, 0.0, 1.0 + np.exp(-r))
        s = theory.verlet_weis_structure_factor(k, eta) if spheres else 1.0 - 0.5 * np.exp(-k)
        numbers = {name: Estimate(1.0 + error * rng.normal(), error, 19) for name in RATIOS}
        s0 = float(theory.reduced_compressibility(eta, dimension))
        numbers |= {"s0": Estimate(s0, error * s0, 19), "state_s0": Estimate(s0, 1e-4 * s0)}
        contact = float(theory.contact_value(eta, dimension))
        for route in ("g", "z", "rate"):
            numbers[f"contact_{route}"] = Estimate(contact, error * contact, 19)
        if spheres:
            numbers |= {"g_gain": Estimate(0.2, 0.02, 19), "s_gain": Estimate(0.3, 0.03, 19)}
        rows.append(
            {
                "dimension": dimension,
                "packing_fraction": eta,
                "count": 500,
                **entries(numbers),
                **entries({"g": (g, np.full(200, 0.01)), "s": (s, np.full(80, 0.02))}),
                "distance": r,
                "wave_number": k,
            }
        )
    inner = {"g": ("bin",), "distance": ("bin",), "s": ("shell",), "wave_number": ("shell",)}
    return from_rows("point", rows, inner)


def chemical_potential(error=0.004, seed=1):
    """Insertion that gives the reference's chemical potential, and hardly any success at the last point."""
    rng, rows = np.random.default_rng(seed), []
    for dimension, eta in ((2, 0.3), (2, 0.5), (2, 0.6), (3, 0.2), (3, 0.3), (3, 0.4), (3, 0.5)):
        mu = float(theory.excess_chemical_potential(eta, dimension))
        works = eta < 0.5 or dimension == 2
        off = error * rng.normal() if works else 0.1
        ratio = Estimate(1.0 + off, error if works else 0.1, 12)
        inserted = ratio * mu
        chance = np.exp(-inserted.value)
        row = {
            "dimension": dimension,
            "packing_fraction": eta,
            "count": 500,
            **entries({
                "probability": Estimate(chance, chance * inserted.error, 12),
                "expected": Estimate(np.exp(-mu), 1e-4 * np.exp(-mu)),
                "inserted": inserted,
                "integrated": Estimate(mu, 1e-4 * mu),
                "ratio": ratio,
            }),
            "reference": mu,
            "reference_error": 1e-4,
            "successes": 10_000 if works else 3,
            "hit_frames": 900 if works else 2,
            "frames": 1000,
            "places": 1e9,
            "resolution": 1e-9,
            "works": int(works),
        }  # fmt: skip
        if works:
            free = float(theory.excess_free_energy(eta, dimension))
            numbers = {"ln_q": ratio * free, "ln_q_integrated": Estimate(free, 1e-4), "ln_q_ratio": ratio}
            row.update(entries(numbers))
        rows.append(row)
    return from_rows("point", rows).assign_attrs(enough=400)


# Small fluids, and an equation of state that is known.


GAS = {
    "dimension": 3,
    "count": 108,
    "radius": 0.5,
    "boundary": "periodic",
    "temperature": 1.0,
    "arrangement": "lattice",
    "engine": "event",
    "collisions_per_particle": 400,
    "equilibration": 20,
    "samples": 200,
}


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    """Spheres at three packing fractions, of which the last two are measured."""
    folder = tmp_path_factory.mktemp("points")
    made = []
    for name, eta in (("a", 0.05), ("b", 0.12), ("c", 0.2)):
        settings = GAS | {"packing_fraction": eta}
        point = Point("states" if name == "a" else "frames", name, "simulate", settings, str(folder), 1)
        (folder / point.experiment).mkdir(exist_ok=True)
        simulate(folder / point.experiment / name, **point.arguments)
        made.append(point)
    return made


def test_the_routes_agree(points):
    settings = {"measured": ["frames"], "small": 4.0, "highest": 12.0, "furthest": 2.5, "frames": 100}
    ds = measure.structure(points, settings)
    assert ds["packing_fraction"].values == pytest.approx([0.12, 0.2])
    for name, most in (("s0_ratio", 0.12), ("g_ratio", 0.12), ("rate_ratio", 0.02)):
        error = ds[f"{name}_error"].values
        assert (error < most).all() and (abs(ds[name].values - 1.0) < 4.5 * error).all()
        assert (ds[f"{name}_freedom"].values >= 9).all()
    contact = theory.contact_value(np.array([0.12, 0.2]), 3)
    assert ds["contact_z"].values == pytest.approx(contact, rel=0.03)
    assert ds["g"].values[:, ds["distance"].values[0] < 0.97].max() == 0.0
    dense = ds.isel(point=1).dropna("shell", subset=["s"])
    law = theory.verlet_weis_structure_factor(dense["wave_number"].values, 0.2)
    chi = float((((dense["s"] - law) / dense["s_error"]) ** 2).mean())
    assert chi < 2.0


def test_insertion_agrees_with_the_integrated_pressure(points):
    settings = {"measured": ["frames"], "trials": 64, "frames": 100, "enough": 90}
    ds = potential.chemical_potential(points, settings)
    assert (ds["works"] == 1).all() and (ds["hit_frames"] > 90).all()
    assert (ds["ratio_error"].values < 0.03).all()
    assert (abs(ds["ratio"].values - 1.0) < 4.5 * ds["ratio_error"].values).all()
    assert ds["resolution"].values == pytest.approx(1.0 / ds["places"].values)
    assert (abs(ds["integrated"] - ds["reference"]) < 4.5 * ds["integrated_error"]).all()
    assert "ln_q" not in ds  # of two points no curve is made


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_thermodynamics_of_a_known_equation_of_state(dimension):
    """Z_ref (1 + 0.02 eta): what the fit adds to the reference, by differences of its integrals."""
    eta = np.linspace(0.05, 0.45, 9)
    fit = fit_polynomial(eta, 0.02 * eta, np.full(9, 1e-6), powers=POWERS)
    state, at = MeasuredState(dimension, fit), 0.4

    def z(x):
        return theory.compressibility_factor(x, dimension) * (1.0 + 0.02 * x)

    slope = ((at + 1e-4) * z(at + 1e-4) - (at - 1e-4) * z(at - 1e-4)) / 2e-4
    assert state.inverse_compressibility(at).value == pytest.approx(slope, rel=1e-5)
    inner = np.linspace(1e-6, at, 4001)
    free = np.trapezoid((z(inner) - 1.0) / inner, inner)
    assert state.free_energy(at).value == pytest.approx(free, rel=1e-4)
    assert state.chemical_potential(at).value == pytest.approx(free + z(at) - 1.0, rel=1e-4)
    assert 0.0 < state.chemical_potential(at).error < 1e-4


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_configuration_integral_of_a_known_chemical_potential(dimension):
    eta = np.array([0.1, 0.2, 0.3, 0.4])
    inserted = Estimate(theory.excess_chemical_potential(eta, dimension), 0.01, 20.0)
    fit_eta = np.linspace(0.05, 0.45, 9)
    state = MeasuredState(dimension, fit_polynomial(fit_eta, 0.0 * fit_eta, np.full(9, 1e-6), powers=POWERS))
    found = potential.ln_q(eta, inserted, dimension)
    free = theory.excess_free_energy(eta, dimension)
    assert found.value == pytest.approx(free, rel=1e-6)
    assert [state.free_energy(one).value for one in eta] == pytest.approx(free, rel=1e-6)
    assert (found.error > 0.0).all() and (found.error < 0.05).all()


def changed(ds, name, point, value):
    values = ds[name].values.copy()
    values[point] = value
    return ds.assign({name: (ds[name].dims, values)})


def test_true_structure_agrees():
    found = judged(claims.structure(structure()))
    assert len(found) == 5 * 3 + 2
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize("name", RATIOS)
def test_each_route_can_disagree(name):
    found = judged(claims.structure(changed(structure(), name, 4, 1.02)))
    assert list(found.values()).count("disagrees") == 1


@pytest.mark.parametrize("name", ["g_gain", "s_gain"])
def test_curves_that_are_no_better_than_percus_and_yevicks_disagree(name):
    found = judged(claims.structure(changed(structure(), name, 2, 0.9)))
    assert [verdict for claim, verdict in found.items() if "Weis" in claim].count("disagrees") == 1


def test_noise_is_inconclusive():
    found = judged(claims.structure(structure(error=0.05)))
    assert {verdict for claim, verdict in found.items() if "over" in claim and "Weis" not in claim} == {
        "inconclusive"
    }


def test_true_insertion_agrees_and_few_successes_give_no_verdict():
    found = judged(claims.chemical_potential(chemical_potential()))
    assert len(found) == 6 + 1 + 2 * 2
    assert set(found.values()) == {"agrees", "no verdict"}
    (failed,) = (claim for claim, verdict in found.items() if verdict == "no verdict")
    assert "spheres, packing fraction 0.5" in failed


def test_a_wrong_chance_disagrees():
    ds = chemical_potential()
    found = judged(claims.chemical_potential(changed(ds, "ratio", 1, 1.05)))
    assert list(found.values()).count("disagrees") == 1
    shifted = ds["inserted"].values + 5.0 * ds["inserted_error"].values
    found = judged(claims.chemical_potential(ds.assign(inserted=("point", shifted))))
    assert {verdict for claim, verdict in found.items() if "all packing" in claim} == {"disagrees"}
    found = judged(claims.chemical_potential(changed(ds, "ln_q_ratio", 2, 0.9)))
    assert [verdict for claim, verdict in found.items() if "ln Q" in claim].count("disagrees") == 1
    assert np.isnan(ds["ln_q_ratio"].values[-1])


ETA = "packing_fraction"


def of(ds, dimension):
    return ds.isel(point=np.flatnonzero(ds["dimension"].values == dimension))


def test_curves_and_ratios_are_drawn():
    ds = varied(structure(), "packing_fraction", "distance", "wave_number")
    g, s, zero, contact = draw(figure.structure, ds).axes
    parts = [of(ds, 3), of(ds, 2)]
    last = [part.isel(point=-1) for part in parts]
    beyond = last[0]["distance"].values >= 1.0
    shows(g, *(Points(one["distance"][beyond], *estimates(one, "g")[:, beyond]) for one in last))
    shows(s, *(Points(one["wave_number"], *estimates(one, "s")) for one in last))
    expected = [
        Points(part[ETA].values + SHIFT * (kind - 0.5), *estimates(part, "s0_ratio"))
        for kind, part in enumerate(parts)
    ]
    shows(zero, *expected)
    expected = [
        Points(part[ETA].values + SHIFT * (kind - 0.5 + 0.4 * n), *estimates(part, name))
        for kind, part in enumerate(parts)
        for n, name in enumerate(("g_ratio", "rate_ratio"))
    ]
    shows(contact, *expected)


def test_the_chemical_potential_and_its_chance_are_drawn():
    ds = varied(chemical_potential(), "packing_fraction")
    upper, ratio, chance, partition = draw(figure.chemical_potential, ds).axes
    panels = {"inserted": upper, "ratio": ratio, "probability": chance, "ln_q": partition}
    for name, axis in panels.items():
        shows(axis, *(Points(part[ETA], *estimates(part, name)) for part in (of(ds, 3), of(ds, 2))))
