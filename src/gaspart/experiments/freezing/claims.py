"""What the freezing figures claim.

A run that has not come to equilibrium is no evidence: its drift is part of its uncertainty, so that its
claims are inconclusive, not right.
"""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.claims import Claim

PART = 0.02
"""How well a coexistence pressure is to be met, relative to it."""
SETTLED = 3.0
"""Deviations between starts and halves, in standard errors, above which a run counts as not in
equilibrium."""
FREE_VOLUME_ERROR = 3e-3
"""Relative uncertainty taken for Alder, Hoover and Young's fit of discs (recalled; their stated scatter)."""
LIQUID_ERROR = 1e-3
"""Relative uncertainty taken for Erpenbeck and Luban's Z, 1/N corrections included."""
SPEEDY_ERROR = 3e-4
"""Relative uncertainty taken for Speedy's fit (recalled)."""
DISCS_SOURCE = "Bernard and Krauth 2011, Engel and others 2013 (recalled)"
SPHERES_SOURCE = "Fernandez and others 2012 (recalled)"


def freezing_discs(dataset: xr.Dataset) -> list[Claim]:
    """Plateau pressure from each start and their difference; melting and freezing; both branches;
    equilibrium."""
    expected = theory.COEXISTENCE_PRESSURE[2]
    claims = [_plateau(dataset.sel(start=start), str(start), expected) for start in dataset["start"].values]
    if dataset.sizes["start"] == 2:
        first, second = (dataset.isel(start=k) for k in (0, 1))
        claims.append(
            Claim(
                "plateau pressure from the crystal minus that from the fluid, k_B T / sigma^2",
                "test",
                float(first["plateau"] - second["plateau"]),
                float(np.hypot(first["plateau_error"], second["plateau_error"])),
                PART * expected / 2.0,
                0.0,
                "one equation of state, whatever the start",
                fails_if="one of the starts has kept a memory of itself",
            )
        )
    low, high = (dataset.isel(packing_fraction=k) for k in (0, -1))
    claims += [_order(low, "at most"), _order(high, "at least"), *_liquid(low), _crystal(high)]
    return [*claims, _settled(dataset)]


def freezing_spheres(dataset: xr.Dataset) -> list[Claim]:
    """Where a crystal melts and where it lasts; both branches of Z; the pressure of crystal beside fluid."""
    crystal = dataset.sel(start="crystal").dropna("packing_fraction", subset=["order"])
    eta = crystal["packing_fraction"].values
    claims = []
    for mask, most in ((eta <= 0.4501, True), (eta >= 0.5599, False)):
        at = crystal.isel(packing_fraction=mask)
        if at.sizes["packing_fraction"]:
            claims.append(_lattice(at, most))
    melting = theory.coexistence_packing_fractions(3)[1]
    for k, start in enumerate(dataset["start"].values):
        for at in (
            dataset.isel(start=k, packing_fraction=j) for j in range(dataset.sizes["packing_fraction"])
        ):
            superheated = int(at["crystalline"]) and float(at["packing_fraction"]) < melting
            if np.isfinite(at["pressure"] * at["reference"]) and not superheated:
                claims.append(_branch(at, str(start)))
    return [*claims, *_slab(dataset)]


def _plateau(side: xr.Dataset, start: str, expected: float) -> Claim:
    return Claim.within(
        f"plateau pressure of discs in k_B T / sigma^2, from the {start}",
        "test",
        float(side["plateau"]),
        float(side["plateau_error"]),
        expected,
        PART * expected,
        DISCS_SOURCE,
        "runs not in equilibrium, a loop too coarse, or far too few discs (the pressure falls with 1/N)",
    )


def _order(at: xr.Dataset, bound: str) -> Claim:
    """The start furthest from what equilibrium wants is the one that is judged."""
    melted = bound == "at most"
    side = at.isel(start=int((np.argmax if melted else np.argmin)(at["order"].values)))
    make, limit = (Claim.at_most, 0.3) if melted else (Claim.at_least, 0.6)
    return make(
        f"global |psi_6| at packing fraction {float(at['packing_fraction']):.4g}, "
        f"of the start that is {'most' if melted else 'least'} ordered",
        "test",
        float(side["order"]),
        float(side["order_error"]),
        0.1,
        limit,
        "liquid below 0.700, one orientation throughout above 0.720 (Bernard and Krauth 2011; recalled)",
        "the crystal has not melted" if melted else "the fluid has not frozen, or into several grains",
    )


def _liquid(at: xr.Dataset) -> list[Claim]:
    """Only at the packing fraction for which there is a reference: the virial series is not one so close."""
    known, z = theory.DENSE_LIQUID_DISCS
    if abs(float(at["packing_fraction"]) - known) > 1e-4:
        return []
    side, density = at.isel(start=0), float(at["density"])
    return [
        Claim(
            f"Z of the disc liquid at packing fraction {known:.4g}",
            "test",
            float(side["pressure"]) / density,
            _uncertainty(side, "pressure") / density,
            0.003 * z,
            z,
            "Erpenbeck and Luban 1985 (recalled)",
            expected_uncertainty=LIQUID_ERROR * z,
            fails_if="the crystal has not melted, or contacts are missed",
        )
    ]


def _crystal(at: xr.Dataset) -> Claim:
    eta, side = float(at["packing_fraction"]), at.isel(start=0)
    z = float(theory.alder_hoover_young_crystal(eta, 2))
    finite = float(theory.crystal_finite_size_correction(z, int(at["count"])))
    expected = float(at["density"]) * (z + finite)
    return Claim(
        f"pressure of the crystal at packing fraction {eta:.4g}, k_B T / sigma^2",
        "test",
        float(side["pressure"]),
        _uncertainty(side, "pressure"),
        0.005 * expected,
        expected,
        "Alder, Hoover and Young 1968 (recalled)",
        expected_uncertainty=FREE_VOLUME_ERROR * expected,
        fails_if="the crystal is strained or defective, or contacts are missed",
    )


def _settled(dataset: xr.Dataset) -> Claim:
    found = int((dataset["disagreement"] > SETTLED).sum())
    return Claim.at_most(
        f"packing fractions of {dataset.sizes['packing_fraction']} whose starts or halves differ "
        f"by more than {SETTLED:g} standard errors",
        "test",
        found,
        math.sqrt(max(found, 1)),
        dataset.sizes["packing_fraction"],
        1,
        "in equilibrium the past is forgotten; one may differ by chance",
        "runs too short to forget their start",
    )


def _uncertainty(side: xr.Dataset, what: str) -> float:
    """Standard error, and the drift between the halves if that is significant."""
    drift, error = float(side[f"{what}_drift"]), float(side[f"{what}_drift_error"])
    return float(np.hypot(side[f"{what}_error"], 0.5 * drift if abs(drift) > SETTLED * error else 0.0))


def _lattice(at: xr.Dataset, melted: bool) -> Claim:
    eta = at["packing_fraction"].values
    worst = at.isel(packing_fraction=int((np.argmax if melted else np.argmin)(at["order"].values)))
    make, limit = (Claim.at_most, 0.1) if melted else (Claim.at_least, 0.4)
    where = f"up to {eta.max():.4g}" if melted else f"from {eta.min():.4g}"
    return make(
        f"{'largest' if melted else 'smallest'} global Q_6 from a face-centred cubic start, "
        f"packing fractions {where}",
        "test",
        float(worst["order"]),
        float(worst["order_error"]),
        0.02,
        limit,
        "spheres melt below 0.492 and are stable above 0.543 (Fernandez and others 2012; recalled)",
        "a crystal that cannot melt, or one that falls apart: contacts are wrong",
    )


def _branch(at: xr.Dataset, start: str) -> Claim:
    """Z on the branch that a run is on. A superheated crystal claims nothing: it may be melting."""
    solid, reference = bool(at["crystalline"]), float(at["reference"])
    eta = float(at["packing_fraction"])
    relative = SPEEDY_ERROR if solid else float(theory.compressibility_uncertainty(eta, 3)) / reference
    scaled = at.assign(
        Z_drift=at["pressure_drift"] / at["density"], Z_drift_error=at["pressure_drift_error"] / at["density"]
    )
    return Claim(
        f"Z of the {'crystal' if solid else 'fluid'} at packing fraction {eta:.4g}, from the {start}",
        "test",
        float(at["Z"]),
        _uncertainty(scaled, "Z"),
        2e-3 * reference,
        reference,
        "Speedy 1998 (recalled)" if solid else "Kolafa, Labík and Malijevský 2004",
        expected_uncertainty=relative * reference,
        fails_if="contacts are missed, defects, or the other phase has begun to grow",
    )


def _slab(dataset: xr.Dataset) -> list[Claim]:
    expected = theory.COEXISTENCE_PRESSURE[3]
    drift = Claim(
        "pressure of crystal beside fluid: second half of the run minus the first, k_B T / sigma^3",
        "test",
        float(dataset["slab_drift"]),
        float(dataset["slab_drift_error"]),
        PART * expected,
        0.0,
        "a stationary state",
        fails_if="one phase is still growing",
    )
    pressure = Claim.within(
        "pressure of crystal beside fluid, k_B T / sigma^3",
        "test",
        float(dataset["slab_pressure"]),
        float(np.hypot(dataset["slab_error"], 0.5 * dataset["slab_drift"])),
        expected,
        PART * expected,
        SPHERES_SOURCE,
        "one phase has eaten the other, the crystal is strained, or contacts are missed",
    )
    fraction = dataset["crystal_fraction"].values
    both = Claim.within(
        "part of the spheres that are crystalline at the end of the run",
        "test",
        float(fraction[-1]),
        float(abs(fraction[-1] - fraction[0])),
        0.5,
        0.3,
        "the container holds both phases at the mean of their densities (lever rule)",
        "one phase has eaten the other",
    )
    return [pressure, drift, both]
