"""Figures about gases behind a piston."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import mean_of, means_of
from gaspart.rendering import style
from gaspart.reproduction.families.piston.claims import isothermal_variance
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table

_DOUBLED = 2.0
"""Volume after free expansion divided by the volume before."""
_EXPONENTS = {2: "2", 3: "5/3"}


def piston(ds: xr.Dataset) -> Figure:
    """Draw temperature along adiabats, factors at constant pressure, and variances of the volume."""
    figure, (upper, middle, lower) = style.new((2.6,), (1.9, 1.9))
    paths, states, gases = (Table.from_prefixed(ds, kind) for kind in ("path", "state", "expansion"))
    for path in paths:
        _draw_path(upper, path)
    for gas in gases[:1]:
        style.points(upper, _DOUBLED, mean_of(gas.speed**2), kind=4, label="free expansion")
    labels = r"volume $V/V_0$", r"temperature $T/T_0$"
    style.label_axes(upper, *labels, legend="best", xscale="log", yscale="log")
    style.level(lower, 1.0)
    for dimension, part in states.by("dimension"):
        _draw_states(middle, lower, part, dimension)
    style.label_axes(middle, y=r"$P/nk_{\mathrm{B}}T$ / reference", legend="best")
    labels = r"packing fraction $\eta$", r"variance of $V$ / theory"
    style.label_axes(lower, *labels, legend="best", xlim=(0.0, None))
    style.letters(upper, middle, lower)
    return figure


def _draw_path(axis: Axes, path: Row) -> None:
    dimension, first, kind = path.dimension, path.packing_fraction, path.dimension - 2
    volume, temperature = path.volume.mean(axis=0), Estimate(*means_of(path.temperature))
    style.points(axis, volume, temperature, kind=kind, label=PARTICLES[dimension])
    fine = np.geomspace(volume.min(), _DOUBLED, 60)
    expected = theory.adiabatic_temperature(first / fine, first, dimension)
    label = rf"adiabat, $\gamma={_EXPONENTS[dimension]}$"
    axis.plot(fine, expected, color=style.COLOURS[kind], zorder=1, label=label)


def _draw_states(middle: Axes, lower: Axes, states: Table, dimension: int) -> None:
    eta, name = np.array([state.density.mean() for state in states]), PARTICLES[dimension]
    factor = [
        mean_of(state.factor / theory.compressibility_factor(state.density, dimension)) for state in states
    ]
    variance = Estimate.stack([mean_of(state.fluctuation) for state in states])
    variance = variance * theory.speed_of_sound(eta, dimension) ** 2
    for axis, ratio in ((middle, Estimate.stack(factor)), (lower, variance)):
        style.points(axis, eta, ratio, kind=dimension - 2, label=name)
    fine, colour = np.linspace(0.0, eta.max(), 60), style.COLOURS[dimension - 2]
    finite = theory.constant_enthalpy_factor(fine, dimension, states.count[0])
    middle.plot(fine, finite, color=colour, zorder=1, label=f"{name}, finite $N$")
    isothermal = isothermal_variance(fine, dimension) * theory.speed_of_sound(fine, dimension) ** 2
    lower.plot(fine, isothermal, color=colour, linestyle="--", label=f"{name}, constant $T$")
