"""Figure of how long a gas remembers its initial state."""

from __future__ import annotations

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.claims import PARTICLES
from gaspart.reproduction.families.shared.rows import estimates

LINES_OF_ENGINES = {
    ("event", "float64"): ("event-driven", "-"),
    ("step", "float64"): ("time-stepped", "--"),
    ("step", "float32"): ("time-stepped, float32", ":"),
}


def reversibility(ds: xr.Dataset) -> Figure:
    """Echoes against collisions, their growth against density, and the memory of each engine."""
    figure, axes = style.new((2.8,), (2.1,), (2.1,))
    gases = sorted(set(zip(ds.dimension.values.tolist(), ds.packing_fraction.values.tolist(), strict=True)))
    for n in range(ds.sizes["row"]):
        row = ds.isel(row=n)
        gas = int(row.dimension), float(row.packing_fraction)
        _, line = LINES_OF_ENGINES[str(row.engine.values), str(row.precision.values)]
        label = f"{gas[0]}D, {gas[1]:g}" if line == "-" else None
        colour = style.COLOURS[gases.index(gas) % len(style.COLOURS)]
        axes[0].plot(row.collisions, row.echo, color=colour, ls=line, label=label)
    for name, line in LINES_OF_ENGINES.values():
        axes[0].plot([], [], color=style.GREY, ls=line, label=name)
    axes[0].set(
        xscale="log",
        yscale="log",
        xlabel="collisions per particle before the reversal",
        ylabel=r"echo: distance / $\sigma$",
    )
    axes[0].set_ylim(1e-20, 1e3)
    axes[0].legend(title=r"$\eta$", ncols=2, loc="lower right", columnspacing=0.6, handletextpad=0.4)
    _growth(axes[1], ds)
    _memory(axes[2], ds)
    style.letters(*axes)
    return figure


def _growth(axis: Axes, ds: xr.Dataset) -> None:
    exact = ds.isel(row=(ds.engine == "event").values)
    for kind, dimension in enumerate((2, 3)):
        of = exact.isel(row=(exact.dimension == dimension).values)
        name = PARTICLES[dimension]
        if not of.sizes["row"]:
            continue
        eta = of.packing_fraction.values
        style.measured(axis, eta, estimates(of, "growth"), kind=kind, label=f"{name}, echo")
        style.measured(
            axis, 1.12 * eta, estimates(of, "divergence"), kind=kind, hollow=True, label=f"{name}, two runs"
        )
        label = "tangent space" if kind else None
        axis.errorbar(eta, of.exponent, of.exponent_error, color=style.GREY, zorder=1, label=label)
    axis.set(xscale="log", yscale="log", xlabel=r"packing fraction $\eta$", ylabel="growth per collision")
    if exact.sizes["row"]:
        eta = exact.packing_fraction.values
        axis.set_xlim(0.5 * eta.min(), 2.0 * eta.max())
    axis.legend()


def _memory(axis: Axes, ds: xr.Dataset) -> None:
    for kind, ((engine, precision), (label, _)) in enumerate(LINES_OF_ENGINES.items()):
        of = ds.isel(row=((ds.engine == engine) & (ds.precision == precision)).values)
        for dimension in (2, 3):
            rows = of.isel(row=(of.dimension == dimension).values)
            style.measured(
                axis,
                rows.packing_fraction,
                estimates(rows, "memory"),
                kind=kind,
                hollow=dimension == 2,
                label=label if dimension == 3 else None,
            )
    axis.set(xscale="log", yscale="log", xlabel=r"packing fraction $\eta$", ylabel="memory (collisions)")
    axis.legend(title="spheres; discs hollow")
