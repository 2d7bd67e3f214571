"""Claims about speed against accuracy."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.families.tradeoff import FREE_TIMES
from gaspart.reproduction.table import Row, Table, each
from gaspart.theory.discretisation import MISSED_CONTACTS, ONE_PASS

# Claims about the map of the cheapest engine: costs of collisions, and errors of engines.


THIN, THICK = 0.0011, 0.29
"""Packing fractions: a gas below THIN is dilute here, a gas above THICK is dense."""
KNOWN = 0.4
"""Largest packing fraction at which the loss of collisions in cells is known (docs/dsmc.md)."""
TESTED = 0.02
"""Smallest bound that runs of a few seconds can test."""
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

    The advantage grows with decreasing density.
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

    The diffusion coefficient D of the Enskog model differs from D of hard spheres.
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
        # at higher densities D divided by Enskog's D decreases again, and passes through 1
        if at.fraction > 0.35:
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
    """Return the claims that speeds relax equally in both models, in reduced time.

    The units of time differ by the contact value.
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


def relaxation_time(slower: float) -> float:
    """Compute the relaxation time of a gas with collisions rarer by a factor.

    The speeds of this gas follow the homogeneous Boltzmann equation.
    """
    times = np.linspace(0.0, FREE_TIMES / slower, 251)
    curve = theory.relaxation(3)
    end = theory.kurtosis(3)
    remainder = (end - curve.kurtosis(curve.collisions(times))) / (end - 1.0)
    return float(np.trapezoid(remainder, times) * slower)


def _cells(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on collisions that the Enskog model loses due to its cells.

    The loss is at most the allowance of `gaspart advise`.
    """
    gases = Table(ds, "fraction")
    measured = np.isfinite(gases.cells.value) & (gases.cells_bound > 0.0)  # a single cell loses no collisions
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


BAND = {1.0: 0.15, 2.0: 0.3, 3.0: 0.6}
"""Half width of the interval around an order."""
REQUIRED = {1.0: 0.1, 2.0: 0.2, 3.0: 0.4}
"""Largest uncertainty of a measured order that is conclusive."""
FLOOR = 1e-3
"""Smallest accuracy for which costs are predicted; step errors for smaller accuracies are below the measured
errors."""
FLUX = "flux of pairs through chords crossed within a step (docs/time-stepped.md)"


def speed_accuracy(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on error orders, missed contacts and the steady state.

    Contacts are missed in a dilute gas.
    """
    errors = Table(ds, "row")
    return [*_orders(errors), *_claims_on_misses(errors), *map(_steady, Table(ds, "steady"))]


def _of(row: Row, observable: str) -> Row:
    """Return a row restricted to one observable."""
    return Row(row.dataset.sel(observable=observable))


def _gas(dimension: int, fraction: float) -> str:
    return f"{PARTICLES[dimension]}, packing fraction {fraction:g}"


def _orders(errors: Table) -> list[Claim]:
    claims = []
    for row in errors:
        setting, fraction = row.setting, row.packing_fraction
        if setting == "4 passes, float32":
            continue
        rewound = "no rewinding" not in setting
        expected = [("collision_rate", 2.0)] if rewound else [("Z", 1.0)]
        if rewound and fraction <= 0.01:
            expected.append(("Z", 3.0))
        source = (
            "contacts at their true positions; grazing ones are missed"
            if rewound
            else "contacts late by half a step"
        )
        claims += [
            Claim.within(
                claim=f"order of the error of {observable} in the time step, {setting}, "
                f"{_gas(row.dimension, fraction)}",
                measured=_of(row, observable).order,
                expected=order,
                half_width=BAND[order],
                required=REQUIRED[order],
                source=source,
                fails_if="a contact is resolved at the wrong place or time, or lost",
            )
            for observable, order in expected
        ]
    return claims


def _claims_on_misses(errors: Table) -> list[Claim]:
    """Return the claims on the collision rate of a dilute gas, at a long step.

    This step is the longest step that loses at most 2 % of the contacts.
    """
    claims = []
    for row in errors[errors.packing_fraction <= 0.01]:
        setting = row.setting
        if setting not in ("4 passes", "1 pass"):
            continue
        factor = MISSED_CONTACTS[row.dimension] * (1.0 if setting == "4 passes" else ONE_PASS)
        lost = factor * row.time_step**2  # in units with v_th = sigma = 1
        at = int(np.argmax(np.where(lost <= 0.02, lost, -1.0)))
        claims.append(
            Claim(
                claim=f"collisions lost to steps of {row.time_step[at]:g}, {setting}, "
                f"{_gas(row.dimension, row.packing_fraction)}",
                measured=-_of(row, "collision_rate").bias[at],
                expected=lost[at],
                required=0.1 * lost[at],
                source=FLUX,
                fails_if="contacts that touch and part within a step are found, or others are not",
            )
        )
    return claims


def _steady(at: Row) -> Claim:
    """Return the claim that long runs have the errors that short paired runs measure.

    A single pass leaves pairs that overlap. In the steady state there are more of these pairs.
    """
    setting = at.steady_setting
    is_converged = setting.startswith("4 passes")
    return Claim(
        claim=f"error of Z in the steady state minus that of paired runs, dt = {at.steady_step:g}, "
        f"{setting}, {_gas(at.steady_dimension, at.steady_packing_fraction)}",
        measured=at.build_up,
        expected=0.0,
        required=FLOOR,
        source="[Kolafa 2004], first order in 1/N",
        no_verdict="" if is_converged else "what one pass leaves builds up; advice takes several passes",
        fails_if="errors accumulate over many steps",
    )


def time_to_accuracy(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on predicted costs, chosen settings, and the map.

    The model predicts the cost of two engines, and chooses the setting that was measured to be the best. The
    map is of the cheapest engine.
    """
    claims = of_map(ds)
    for engine in Table(ds, "engine"):
        ratio = np.log(engine.model / engine.measured)  # gas, observable, count, accuracy
        ratio, independent = ratio[..., engine.accuracy >= FLOOR], ratio.shape[0] * ratio.shape[1]
        ratio = ratio[np.isfinite(ratio)]
        measured = Estimate(np.nan, np.nan)
        if ratio.size:
            measured = Estimate(ratio.mean(), ratio.std() / independent**0.5)
        claims.append(
            Claim.within(
                claim=f"ln of the model's cost over that measured, mean for {FLOOR:g} and more, "
                f"{engine.engine} engine",
                measured=measured,
                expected=0.0,
                half_width=0.5,
                source="gaspart.accuracy, fitted to other gases",
                fails_if="cost or errors do not lie between those of the neighbouring gases",
            )
        )
    worst = Row(ds.isel(ds.regret.where(np.isfinite(ds.regret)).argmax(...)))
    return [
        *claims,
        Claim.at_most(
            claim="measured cost of the setting that the model chooses over the best one's, the worst of all",
            measured=worst.regret,
            bound=1.5,
            required=0.3,
            source="what `gaspart advise` promises",
            fails_if="the model chooses the wrong engine or time step",
        ),
    ]
