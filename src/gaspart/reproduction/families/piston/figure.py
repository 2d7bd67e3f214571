"""Figures about gases behind a piston."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.piston.claims import isothermal_variance
from gaspart.reproduction.families.shared.claims import PARTICLES, rows

_DOUBLED = 2.0
"""The volume after free expansion, over that before."""
_EXPONENTS = {2: "2", 3: "5/3"}


def piston(ds: xr.Dataset) -> Figure:
    """Three panels: temperature along adiabats, factors at constant pressure, variances of the volume."""
    figure, (upper, middle, lower) = style.new((2.6,), (1.9, 1.9))
    for path in rows(ds, "path"):
        _draw_path(upper, path)
    for gas in rows(ds, "expansion")[:1]:
        speed = gas["expansion_speed"].values ** 2
        error = speed.std(ddof=1) / np.sqrt(speed.size)
        style.points(upper, _DOUBLED, speed.mean(), error, 4, label="free expansion")
    upper.set_xscale("log")
    upper.set_yscale("log")
    upper.set_xlabel(r"volume $V/V_0$")
    upper.set_ylabel(r"temperature $T/T_0$")
    upper.legend()
    style.level(lower, 1.0)
    for dimension in (2, 3):
        states = ds.isel(state=(ds["state_dimension"] == dimension).values)
        if states.sizes["state"]:
            _draw_states(middle, lower, states, dimension)
    middle.set_ylabel(r"$P/nk_{\mathrm{B}}T$ / reference")
    lower.set_ylabel(r"variance of $V$ / theory")
    lower.set_xlabel(r"packing fraction $\eta$")
    lower.set_xlim(0.0, None)
    middle.legend()
    lower.legend()
    style.letters(upper, middle, lower)
    return figure


def _draw_path(axis: Axes, path: xr.Dataset) -> None:
    dimension, first = int(path["path_dimension"]), float(path["path_packing_fraction"])
    volume, temperature = path["path_volume"].mean("path_replica"), path["path_temperature"]
    scatter, replicas = temperature.std("path_replica", ddof=1), temperature.sizes["path_replica"]
    kind, error = dimension - 2, scatter / np.sqrt(replicas)
    style.points(axis, volume, temperature.mean("path_replica"), error, kind, label=PARTICLES[dimension])
    fine = np.geomspace(float(volume.min()), _DOUBLED, 60)
    expected = theory.adiabatic_temperature(first / fine, first, dimension)
    label = rf"adiabat, $\gamma={_EXPONENTS[dimension]}$"
    axis.plot(fine, expected, color=style.COLOURS[kind], zorder=1, label=label)


def _draw_states(middle: Axes, lower: Axes, states: xr.Dataset, dimension: int) -> None:
    eta, kind = states["state_density"].mean("state_replica").values, dimension - 2
    factor = states["state_factor"] / theory.compressibility_factor(states["state_density"].values, dimension)
    sound = np.asarray(theory.speed_of_sound(eta, dimension))
    variance = states["state_fluctuation"] * sound[:, None] ** 2
    root = np.sqrt(states.sizes["state_replica"])
    for axis, ratio in ((middle, factor), (lower, variance)):
        mean, error = ratio.mean("state_replica"), ratio.std("state_replica", ddof=1) / root
        style.points(axis, eta, mean, error, kind, label=PARTICLES[dimension])
    fine = np.linspace(0.0, eta.max(), 60)
    finite = theory.constant_enthalpy_factor(fine, dimension, int(states["state_count"][0]))
    middle.plot(
        fine, finite, color=style.COLOURS[kind], zorder=1, label=f"{PARTICLES[dimension]}, finite $N$"
    )
    isothermal = [
        isothermal_variance(one, dimension) * theory.speed_of_sound(one, dimension) ** 2 for one in fine
    ]
    label = f"{PARTICLES[dimension]}, constant $T$"
    lower.plot(fine, isothermal, color=style.COLOURS[kind], linestyle="--", label=label)
