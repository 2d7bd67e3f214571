"""Claims about the map of the cheapest engine: costs of collisions, and errors of engines."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.tradeoff.relaxation import relaxation_time
from gaspart.reproduction.table import Row, Table, each

THIN, THICK = 0.0011, 0.29
"""Packing fractions: up to which a gas is called dilute here, and from which dense."""
KNOWN = 0.4
"""Packing fraction up to which the loss of collisions in cells is known (docs/dsmc.md)."""
TESTED = 0.02
"""The smallest bound that runs of a few seconds can test."""
FLOW_NAMES = {"heat_flux": "heat flux between plates", "relaxation": "relaxation time of speeds"}
SOLVERS = {"step": "time steps", "boltzmann": "the Boltzmann model", "enskog": "the Enskog model"}


def of_map(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on dilute and dense gases, both flows, and cells of the Enskog model."""
    return [*_dilute(ds), *_dense(ds), *_flows(ds), *_relaxation(ds), *_cells(ds)]


def _by_engine(at: Row, name: str) -> dict[str, Estimate]:
    """Compute a column over the engines."""
    return dict(zip(at.solver.tolist(), at[name], strict=True))


def _dilute(ds: xr.Dataset) -> list[Claim]:
    """Return the claims that DSMC is much cheaper in a dilute gas.

    It is the cheaper the more dilute the gas.
    """
    claims = []
    gases = Table(ds.sel(quantity="collision_rate"), "fraction")
    for at in gases[gases.fraction <= THIN]:
        accuracies = Table(at.dataset, "accuracy")
        for row in accuracies[np.isclose(accuracies.accuracy, 0.01)]:
            cost = _by_engine(row, "cost")
            if not np.isfinite(cost["event"].value):
                continue
            claims.append(
                Claim.at_most(
                    claim="time of DSMC over that of events for 1 % of the collision rate, packing fraction "
                    f"{at.fraction:g}",
                    measured=cost["boltzmann"] / cost["event"],
                    bound=0.1,
                    required=0.03,
                    source="between two collisions a particle crosses many boxes by events, and none by DSMC",
                    fails_if="a collision of DSMC costs as much as tens of box crossings",
                )
            )
    thin, other = (gases[np.isclose(gases.fraction, eta)] for eta in (1e-4, 1e-2))
    if thin and other:
        ratio = [
            costs["event"] / costs["boltzmann"]
            for costs in (_by_engine(of[0], "each") for of in (thin, other))
        ]
        claims.append(
            Claim.at_least(
                claim="time of a collision by events over that by DSMC, at packing fraction 0.0001 over 0.01",
                measured=ratio[0] / ratio[1],
                bound=3.0,
                required=1.0,
                source="box crossings in a free path grow as the packing fraction to the power -2/3, by 22",
                fails_if="a particle's flight is followed through few boxes",
            )
        )
    return claims


def _dense(ds: xr.Dataset) -> list[Claim]:
    """Return the claims that the Enskog model costs more than events in a dense gas.

    It has another D.
    """
    claims, gases = [], Table(ds, "fraction")
    for at in gases[gases.fraction >= THICK]:
        where, seconds = f"packing fraction {at.fraction:g}", _by_engine(at, "each")
        claims.append(
            Claim.at_least(
                claim=f"time of a collision by the Enskog model over that by events, {where}",
                measured=seconds["enskog"] / seconds["event"],
                bound=1.0,
                required=0.2,
                source="the model tries several pairs for one that collides; by events few are tested",
                fails_if="a search for contacts costs more than random trials",
            )
        )
        if at.fraction > 0.35:  # beyond, D / Enskog's falls again and passes through 1
            continue
        model = float(at.dataset.error.sel(quantity="D", solver="enskog", part="model").isel(accuracy=0))
        claims.append(
            Claim.at_least(
                claim=f"error of the Enskog model in D, {where}",
                measured=Estimate(model, 0.0),
                bound=0.01,
                required=0.001,
                source="[Erpenbeck 1991]",
                kind="identity",
                fails_if="the map offers the model for 1 % of D",
            )
        )
    return claims


def _flows(ds: xr.Dataset) -> list[Claim]:
    """Return the claims that fluxes and relaxation are within the bounds of `gaspart advise`."""
    claims = []
    for quantity in ds.flow_quantity.values:
        for at in Table(ds.sel(flow_quantity=quantity), "fraction"):
            flow, bounds = _by_engine(at, "flow"), dict(zip(at.solver, at.flow_bound, strict=True))
            claims += [
                Claim.within(
                    claim=f"{FLOW_NAMES[quantity]} by {name} over that by events, packing fraction "
                    f"{at.fraction:g}",
                    measured=flow[solver] / flow["event"],
                    expected=1.0,
                    half_width=bounds[solver],
                    source="gaspart.accuracy.option: excluded volume, memory, cells, steps",
                    fails_if="a bound leaves out what makes an error",
                )
                for solver, name in SOLVERS.items()
                if TESTED <= bounds[solver] < 1.0
            ]
    return claims


def _relaxation(ds: xr.Dataset) -> list[Claim]:
    """Return the claims that speeds relax equally in both models, by clocks.

    The clocks differ by the contact value.
    """
    claims = []
    for at in Table(ds.sel(flow_quantity="relaxation"), "fraction"):
        flow, eta = _by_engine(at, "flow"), at.fraction
        boltzmann, enskog = flow["boltzmann"], flow["enskog"]
        if eta < 0.05 or not np.isfinite(boltzmann.value + enskog.value):
            continue
        exact, later = (relaxation_time(factor) for factor in (1.0, float(theory.contact_value(eta, 3))))
        claims.append(
            Claim(
                claim="relaxation time of speeds by the Boltzmann model over that by the Enskog model, "
                f"packing fraction {eta:g}",
                measured=boltzmann / enskog,
                expected=later / exact,
                required=0.01,
                source="Enskog's equation of a uniform gas is Boltzmann's with the contact value as a factor",
                alternative=1.0,
                fails_if="few in a cell meet again and again; a wrong contact value",
            )
        )
    return claims


def _cells(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on collisions that the Enskog model loses to its cells.

    It loses no more than `gaspart advise` allows for.
    """
    gases = Table(ds, "fraction")
    measured = np.isfinite(gases.cells.value) & (gases.cells_bound > 0.0)  # a single cell loses nothing
    rows = gases[measured & (gases.fraction <= KNOWN)]
    return each(
        rows,
        "collision rate of the Enskog model in default cells over that of its equation, packing fraction "
        "{fraction:g}",
        form=Claim.within,
        measured=rows.cells,
        expected=1.0,
        half_width=rows.cells_bound,
        source="docs/dsmc.md: at most 0.5 over the particles in a cell",
        fails_if="pairs that approach become rarer in a cell than they are",
    )
