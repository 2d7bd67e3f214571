"""Claims about speed and accuracy."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import PARTICLES, rows
from gaspart.reproduction.families.tradeoff.map_claims import of_map

MISSED = {2: 1.0 / 4.0, 3: 2.0 / 3.0}
"""The part of all contacts of a dilute gas that touch and part within a step, over (v_th dt / sigma)^2."""
BAND = {1.0: 0.15, 2.0: 0.3, 3.0: 0.6}
"""Half-width of the band around an order."""
REQUIRED = {1.0: 0.1, 2.0: 0.2, 3.0: 0.4}
"""Largest uncertainty at which a measured order means anything."""
FLOOR = 1e-3
"""Finer accuracies are not predicted: the errors of steps that reach them are below those measured."""
FLUX = "flux of pairs through chords crossed within a step (docs/time-stepped.md)"


def speed_accuracy(ds: xr.Dataset) -> list[Claim]:
    """Orders of the errors, the contacts missed in a dilute gas, the frontier, and the steady state."""
    steady = [_steady(at) for at in rows(ds, "steady")]
    frontier = [claim for gas in rows(ds, "gas") for claim in _frontier(gas.sel(observable="Z"))]
    return [*_orders(ds), *_missed(ds), *frontier, *steady]


def _gas(dimension: xr.DataArray, fraction: xr.DataArray) -> str:
    return f"{PARTICLES[int(dimension)]}, packing fraction {float(fraction):g}"


def _orders(ds: xr.Dataset) -> list[Claim]:
    claims = []
    for row in rows(ds, "row"):
        setting, fraction = str(row.setting.values), float(row.packing_fraction)
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
                f"{_gas(row.dimension, row.packing_fraction)}",
                measured=Estimate.of(row.sel(observable=observable), "order"),
                expected=order,
                half_width=BAND[order],
                required=REQUIRED[order],
                source=source,
                fails_if="a contact is resolved at the wrong place or time, or lost",
            )
            for observable, order in expected
        ]
    return claims


def _missed(ds: xr.Dataset) -> list[Claim]:
    """The rate of a dilute gas, at the longest step that loses 2 % at most."""
    claims = []
    for row in rows(ds, "row"):
        setting = str(row.setting.values)
        if float(row.packing_fraction) > 0.01 or setting not in ("4 passes", "1 pass"):
            continue
        factor = MISSED[int(row.dimension)] * (1.0 if setting == "4 passes" else 4.0)
        lost = factor * row.time_step.values**2  # v_th and sigma are 1
        at = int(np.argmax(np.where(lost <= 0.02, lost, -1.0)))
        claims.append(
            Claim(
                claim=f"collisions lost to steps of {float(row.time_step[at]):g}, {setting}, "
                f"{_gas(row.dimension, row.packing_fraction)}",
                measured=-Estimate.of(row.sel(observable="collision_rate").isel(step=at), "bias"),
                expected=lost[at],
                required=0.1 * lost[at],
                source=FLUX,
                fails_if="contacts that touch and part within a step are found, or others are not",
            )
        )
    return claims


def _frontier(z: xr.Dataset) -> list[Claim]:
    """In a dense gas, accuracy requires more steps, so that events are cheaper where 0.1 % is wanted.

    Elsewhere the cheaper engine depends on the machine: see `gaspart advise`. z: one gas, its Z.
    """
    if float(z.gas_packing_fraction) < 0.3 or int(z.gas_dimension) == 2:
        return []
    where = _gas(z.gas_dimension, z.gas_packing_fraction)
    claims = [
        Claim.at_least(
            claim=f"time of steps over that of events for {100 * float(at.accuracy):g} % of Z, {where}",
            measured=Estimate.of(at, "best_ratio"),
            bound=1.0,
            required=0.2 * float(at.best_ratio),
            source="cost of a collision by each engine, on this machine",
            no_verdict="which engine is cheaper depends on the machine and on both programs",
            fails_if="time steps are nevertheless cheaper than events",
        )
        for at in rows(z, "accuracy")
        if at.accuracy <= 0.001
    ]
    reached = z.isel(accuracy=np.isfinite(z.best_seconds.values))  # no step is known to be more accurate
    if reached.sizes["accuracy"] < 2:
        return claims
    relative = (reached.best_ratio_error / reached.best_ratio).values
    seconds = reached.best_seconds.values
    coarse, fine = (Estimate(seconds[k], seconds[k] * relative[k]) for k in (0, -1))
    claims.append(
        Claim.at_least(
            claim=f"time of steps for {100 * float(reached.accuracy[-1]):g} % of Z over that for "
            f"{100 * float(reached.accuracy[0]):g} %, {where}",
            measured=fine / coarse,
            bound=1.0,
            required=0.1,
            source="shorter steps, more of them; by how much depends on what a collision costs",
            fails_if="the cost does not depend on the length of a step",
        )
    )
    return claims


def _steady(at: xr.Dataset) -> Claim:
    """Long runs have the errors that the short, paired ones measure. One pass leaves pairs that overlap, and
    there are more of them in the steady state."""
    setting = str(at.steady_setting.values)
    return Claim(
        claim=f"error of Z in the steady state minus that of paired runs, dt = {float(at.steady_step):g}, "
        f"{setting}, {_gas(at.steady_dimension, at.steady_packing_fraction)}",
        measured=Estimate.of(at, "build_up"),
        expected=0.0,
        required=FLOOR,
        source="[Kolafa 2004], first order in 1/N",
        no_verdict=""
        if setting.startswith("4 passes")
        else "what one pass leaves builds up; the frontier allows for it",
        fails_if="errors accumulate over many steps",
    )


def time_to_accuracy(ds: xr.Dataset) -> list[Claim]:
    """The model predicts the cost of two engines, and chooses the setting measured to be the best; and what
    makes the map of the cheapest engine."""
    claims = of_map(ds)
    for engine in ds.engine.values:
        at = ds.sel(engine=engine, accuracy=ds.accuracy[ds.accuracy >= FLOOR])
        ratio = np.log(at.model / at.measured).values
        ratio = ratio[np.isfinite(ratio)]
        measured = Estimate(np.nan, np.nan)
        if ratio.size:
            independent = ds.sizes["gas"] * ds.sizes["observable"]
            measured = Estimate(ratio.mean(), ratio.std() / independent**0.5)
        claims.append(
            Claim.within(
                claim=f"ln of the model's cost over that measured, mean for {FLOOR:g} and more, {engine} "
                "engine",
                measured=measured,
                expected=0.0,
                half_width=0.5,
                source="gaspart.accuracy, fitted to other gases",
                fails_if="cost or errors do not lie between those of the neighbouring gases",
            )
        )
    worst = ds.isel(ds.regret.where(np.isfinite(ds.regret)).argmax(...))
    return [
        *claims,
        Claim.at_most(
            claim="measured cost of the setting that the model chooses over the best one's, the worst of all",
            measured=Estimate.of(worst, "regret"),
            bound=1.5,
            required=0.3,
            source="what `gaspart advise` promises",
            fails_if="the model chooses the wrong engine or time step",
        ),
    ]
