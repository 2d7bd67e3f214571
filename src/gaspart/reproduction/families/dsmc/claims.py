"""Claims about DSMC: discretisation errors, dense gases, and fluxes between plates."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import combine_estimates
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Table, each
from gaspart.theory.discretisation import CELL_COEFFICIENTS, STEP_COEFFICIENTS, cell_factor, step_factor

CELLS = "[Alexander 1998]"
STEPS = "[Hadjiconstantinou 2000]; [Garcia 2000]"
POWER = 0.1
"""Largest relative uncertainty with which a coefficient is tested."""
SEEN = 0.02
"""Smallest relative change of a transport coefficient with which a point tests the coefficient of the change.
"""
SONINE = {"viscosity": 1.0160, "conductivity": 1.0252, "diffusion": 1.01895}
"""Exact coefficients of dilute spheres divided by their first Sonine approximation."""
WIDE = 1.5
"""Width of cells, in mean free paths, in which the diffusion coefficient is tested."""
POINTLIKE = 0.003
"""Packing fraction below which the volume of the spheres is negligible for the flux between plates. The
volume changes the flux by less than 4 times the packing fraction."""


def dsmc_convergence(dataset: xr.Dataset) -> list[Claim]:
    """Return the claims on cells and steps, on the dense gas, and on plates."""
    gases = Table(dataset, "point")
    parts = {
        name: gases[gases.part == name] for name in ("fluxes", "paths", "dense", "plates", "event_plates")
    }
    of = {"viscosity": parts["fluxes"], "conductivity": parts["fluxes"], "diffusion": parts["paths"]}
    return [
        *(_limit(quantity, own) for quantity, own in of.items()),
        _narrow_cells(gases),
        *(
            _of_steps(quantity, of[quantity], coefficient)
            for quantity, coefficient in STEP_COEFFICIENTS.items()
        ),
        _wide_cells(parts["paths"]),
        *_dense(parts["dense"]),
        *_plates(parts["plates"], parts["event_plates"]),
    ]


def _predict(gases: Table, quantity: str) -> np.ndarray:
    """Compute a transport coefficient with cells and steps, divided by the exact one, (points,)."""
    return np.asarray(cell_factor(quantity, gases.width) * step_factor(quantity, gases.step))


def _limit(quantity: str, gases: Table) -> Claim:
    """Return the claim on a transport coefficient with narrow cells and short steps."""
    fine = gases[_predict(gases, quantity) < 1.0 + SEEN]
    return Claim(
        claim=f"{quantity} over Chapman and Enskog's, with narrow cells and short steps",
        measured=combine_estimates(getattr(fine, quantity) / _predict(fine, quantity)),
        expected=1.0,
        required=0.02,
        source="[Chapman 1970], with the Sonine polynomials that matter",
        alternative=1.0 / SONINE[quantity],
        fails_if="pairs drawn with a wrong chance, or scattering that is not isotropic",
    )


def _narrow_cells(gases: Table) -> Claim:
    """Return the claim on the increase of the viscosity by cells, compared with literature."""
    cells = CELL_COEFFICIENTS["viscosity"]
    return Claim(
        claim="coefficient of (width/l)^2 in the viscosity, narrow cells",
        measured=gases.coefficient,
        expected=cells,
        required=POWER * cells,
        source=CELLS,
        alternative=0.0,
        fails_if="partners that are not drawn from the whole cell, or momentum that is not conserved",
    )


def _of_steps(quantity: str, gases: Table, coefficient: float) -> Claim:
    """Return the claim on the increase of a transport coefficient by time steps."""
    long = gases[step_factor(quantity, gases.step) - 1.0 > SEEN]
    added = getattr(long, quantity) / cell_factor(quantity, long.width) - 1.0
    strength = combine_estimates(added / (step_factor(quantity, long.step) - 1.0))
    return Claim(
        claim=f"coefficient of (c step/l)^2 in the {quantity}",
        measured=strength * coefficient,
        expected=coefficient,
        required=POWER * coefficient,
        source=STEPS,
        alternative=0.0,
        fails_if="particles that fly for other times than a step between their collisions",
    )


def _wide_cells(paths: Table) -> Claim:
    """Return the claim that D does not depend on the width of the cells."""
    wide = paths[paths.width > WIDE]
    return Claim(
        claim=f"diffusion over Chapman and Enskog's, with cells wider than {WIDE:g} mean free paths",
        measured=combine_estimates(wide.diffusion / _predict(wide, "diffusion")),
        expected=1.0,
        required=0.01,
        source="a particle's own displacement passes nothing on",
        alternative=float(cell_factor("conductivity", WIDE)),
        fails_if="collisions that move particles, or whose number depends on the cell",
    )


def _dense(gases: Table) -> list[Claim]:
    """Return the claims on the dense-gas model, and on Enskog theory for spheres.

    The model is compared with its own equation of state.
    """
    where = "in the Enskog model at packing fraction {packing_fraction:g}"
    common: dict[str, Any] = {
        "expected": 1.0,
        "required": 0.003,
        "source": "the contact value of Carnahan and Starling, which the model is given",
        "fails_if": "a wrong chance to collide, or a loss of pairs that approach",
    }
    excess = each(gases, f"Z - 1 over Carnahan and Starling's {where}", measured=gases.excess, **common)
    rate = each(gases, f"collision rate over Enskog's {where}", measured=gases.rate, **common)
    diffusion = each(
        gases,
        f"diffusion over Enskog's {where}",
        measured=gases.diffusion,
        expected=1.0,
        required=0.01,
        source="Enskog theory, 1.01895 times the first Sonine approximation",
        alternative=theory.erpenbeck_wood_ratio(gases.packing_fraction),
        fails_if="correlated collisions, which this model does not have",
    )
    return [claim for of_one in zip(excess, rate, diffusion, strict=True) for claim in of_one]


def _plates(gases: Table, event: Table) -> list[Claim]:
    """Return the claims on the flux at each Knudsen number against the event-driven engine."""
    claims = []
    for gas in gases:
        beside = event[np.abs(event.knudsen / gas.knudsen - 1.0) < 0.02]
        if not beside or beside[0].packing_fraction > POINTLIKE:
            continue
        allowance = 4.0 * beside[0].packing_fraction
        claims.append(
            Claim(
                claim=f"heat flux by DSMC over that of the event-driven engine at Kn = {gas.knudsen:.2g}",
                measured=gas.flux / beside[0].flux,
                expected=Estimate(1.0, allowance / 3.0),
                required=0.03,
                source="the Boltzmann equation is that of hard spheres in the dilute limit",
                allowance_source="the first order in the density: 4 times the packing fraction, as 3 sigma",
                fails_if="wrong draws at thermal faces, wrong mean free path",
            )
        )
    return claims
