"""Made-up measurements of structure and chemical potential, of fluids that are as theory says."""

import numpy as np

from gaspart import theory
from gaspart.analysis.estimate import Estimate
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
