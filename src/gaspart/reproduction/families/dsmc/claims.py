"""Claims about the DSMC engine: its discretisation errors, its dense gas, and its fluxes between plates."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import rows, weighted_mean
from gaspart.theory.dsmc import CELL_COEFFICIENTS, STEP_COEFFICIENTS, cell_factor, step_factor

CELLS = "[Alexander 1998]"
STEPS = "[Hadjiconstantinou 2000]; [Garcia 2000]"
POWER = 0.1
"""Of a coefficient: the largest uncertainty with which it is tested."""
SEEN = 0.02
"""Change of a transport coefficient from which on a point tests the coefficient of that change."""
WIDE = 1.5
"""Mean free paths: cells in which the diffusion coefficient is tested."""
POINTLIKE = 0.003
"""Packing fraction up to which the volume of the spheres does not matter for the flux between plates, by
less than 4 of it."""


def dsmc_convergence(ds: xr.Dataset) -> list[Claim]:
    """Of cells and steps, of the dense gas, and of plates."""
    return [*_limits(ds), *_coefficients(ds), _wide_cells(ds), *_dense(ds), *_plates(ds)]


def _of(ds: xr.Dataset, *parts: str) -> list[xr.Dataset]:
    """The points of some parts."""
    return rows(ds.isel(point=np.flatnonzero(np.isin(ds["part"], parts))), "point")


def _predicted(row: xr.Dataset, quantity: str) -> float:
    """A transport coefficient over the exact one, by cells and steps."""
    cells = cell_factor(quantity, float(row["width"]))
    return float(cells * step_factor(quantity, float(row["step"])))


def _limits(ds: xr.Dataset) -> list[Claim]:
    """The coefficients of narrow cells and short steps."""
    claims = []
    for part, quantity in (("fluxes", "viscosity"), ("fluxes", "conductivity"), ("paths", "diffusion")):
        fine = [row for row in _of(ds, part) if _predicted(row, quantity) < 1.0 + SEEN]
        ratios = [Estimate.of(row, quantity) / _predicted(row, quantity) for row in fine]
        claims.append(
            Claim(
                claim=f"{quantity} over Chapman and Enskog's, with narrow cells and short steps",
                measured=weighted_mean(ratios),
                expected=1.0,
                required=0.02,
                source="[Chapman 1970], with the Sonine polynomials that matter",
                alternative=1.0 / 1.016,
                fails_if="pairs drawn with a wrong chance, or scattering that is not isotropic",
            )
        )
    return claims


def _coefficients(ds: xr.Dataset) -> list[Claim]:
    """What cells and steps add, over what the literature states."""
    cells = CELL_COEFFICIENTS["viscosity"]
    claims = [
        Claim(
            claim="coefficient of (width/l)^2 in the viscosity, narrow cells",
            measured=Estimate.of(ds, "coefficient"),
            expected=cells,
            required=POWER * cells,
            source=CELLS,
            alternative=0.0,
            fails_if="partners that are not drawn from the whole cell, or momentum that is not conserved",
        )
    ]
    for quantity, coefficient in STEP_COEFFICIENTS.items():
        strengths = []
        for row in _of(ds, "paths" if quantity == "diffusion" else "fluxes"):
            added = float(step_factor(quantity, float(row["step"]))) - 1.0
            if added > SEEN:
                rest = float(cell_factor(quantity, float(row["width"])))
                strengths.append((Estimate.of(row, quantity) / rest - 1.0) / added)
        measured = weighted_mean(strengths)
        claims.append(
            Claim(
                claim=f"coefficient of (c step/l)^2 in the {quantity}",
                measured=measured * coefficient,
                expected=coefficient,
                required=POWER * coefficient,
                source=STEPS,
                alternative=0.0,
                fails_if="particles that fly for other times than a step between their collisions",
            )
        )
    return claims


def _wide_cells(ds: xr.Dataset) -> Claim:
    """D does not depend on cells."""
    wide = [row for row in _of(ds, "paths") if float(row["width"]) > WIDE]
    ratios = [Estimate.of(row, "diffusion") / _predicted(row, "diffusion") for row in wide]
    return Claim(
        claim=f"diffusion over Chapman and Enskog's, with cells wider than {WIDE:g} mean free paths",
        measured=weighted_mean(ratios),
        expected=1.0,
        required=0.01,
        source="a particle's own displacement passes nothing on",
        alternative=float(cell_factor("conductivity", WIDE)),
        fails_if="collisions that move particles, or whose number depends on the cell",
    )


def _dense(ds: xr.Dataset) -> list[Claim]:
    """The Enskog model against its own equation; and Enskog's theory against what spheres do."""
    claims = []
    for row in _of(ds, "dense"):
        eta = float(row["packing_fraction"])
        names = {"excess": "Z - 1 over Carnahan and Starling's", "rate": "collision rate over Enskog's"}
        claims += [
            Claim(
                claim=f"{title} in the Enskog model at packing fraction {eta:g}",
                measured=Estimate.of(row, name),
                expected=1.0,
                required=0.003,
                source="the contact value of Carnahan and Starling, which the model is given",
                fails_if="a wrong chance to collide, or a loss of pairs that approach",
            )
            for name, title in names.items()
        ]
        claims.append(
            Claim(
                claim=f"diffusion over Enskog's in the Enskog model at packing fraction {eta:g}",
                measured=Estimate.of(row, "diffusion"),
                expected=1.0,
                required=0.01,
                source="Enskog theory, 1.01895 times the first Sonine approximation",
                alternative=float(theory.erpenbeck_wood_ratio(eta)),
                fails_if="correlated collisions, which this model does not have",
            )
        )
    return claims


def _plates(ds: xr.Dataset) -> list[Claim]:
    """The flux at each Knudsen number against that of the event-driven engine."""
    claims = []
    event = _of(ds, "event_plates")
    for row in _of(ds, "plates"):
        knudsen = float(row["knudsen"])
        beside = [one for one in event if abs(float(one["knudsen"]) / knudsen - 1.0) < 0.02]
        if not beside or float(beside[0]["packing_fraction"]) > POINTLIKE:
            continue
        allowance = 4.0 * float(beside[0]["packing_fraction"])
        claims.append(
            Claim(
                claim=f"heat flux by DSMC over that of the event-driven engine at Kn = {knudsen:.2g}",
                measured=Estimate.of(row, "flux") / Estimate.of(beside[0], "flux"),
                expected=Estimate(1.0, allowance / 3.0),
                required=0.03,
                source="the Boltzmann equation is that of hard spheres in the dilute limit",
                allowance_source="the first order in the density: 4 times the packing fraction, as 3 sigma",
                fails_if="wrong draws at thermal faces, wrong mean free path",
            )
        )
    return claims
