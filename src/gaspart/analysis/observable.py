"""Measured quantity: an xarray.Dataset with uncertainties, units, theory and a plot method."""

from __future__ import annotations

import base64
import html
import io
from textwrap import wrap
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import concise
from gaspart.analysis.observables import name_of
from gaspart.analysis.statistics import correlated_mean, slow_mean
from gaspart.errors import SceneError
from gaspart.scene.surfaces import wall_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEAST_INTERVALS = 16
"""Minimum number of intervals between frames for the uncertainty of a mean."""
_ROUNDING = 1e-12
"""Relative scatter below which a series counts as constant."""
_LONG = 32  # number of characters above which a label has two lines
_FEW = 12
"""Maximum number of values that a summary lists one by one."""
_WIDE = 60
"""Number of characters in a line of a remark in a plot."""
_PLANE = 2
"""Maximum number of axes of a field that can be plotted."""
STRETCHES = 20
"""Number of blocks of a run whose means are plotted for a scalar."""


class ByFace(xr.Dataset):
    """Dataset that may have the dimension `face`, whose coordinate contains names such as `x low`."""

    __slots__ = ()

    def sel(self, *indexers: Any, **named: Any) -> Self:
        """Select as from a Dataset; a face can be named `x_low` or `x low`.

        Parameters
        ----------
        *indexers
            Arguments of `xarray.Dataset.sel`.
        **named
            Keyword arguments of `xarray.Dataset.sel`.

        Returns
        -------
        ByFace
            The selection.
        """
        for selection in (*(item for item in indexers if isinstance(item, dict)), named):
            if "face" in selection:
                selection["face"] = wall_of(selection["face"])
        return super().sel(*indexers, **named)


class Observable(ByFace):
    """Result of a function of `gaspart.analysis`, a Dataset.

    Variables: the attribute `quantity` contains the name of the variable with the measured values. The suffix
    _error is added to this name for the standard errors. If theory exists, the suffixes _theory and
    _theory_error are added for the theoretical values and their uncertainties. An uncertainty of theory is
    NaN if it is unknown, for example for an approximation. A scalar also has the variable `stretches` (time),
    which contains the means over consecutive blocks of the run. Its attribute `freedom` is the number of
    degrees of freedom of its error. Every variable has `units`.

    Parameters
    ----------
    data_vars : mapping, optional
        Variables, as for `xarray.Dataset`.
    coords : mapping, optional
        Coordinates, as for `xarray.Dataset`.
    attrs : mapping, optional
        Attributes, as for `xarray.Dataset`.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> measured = gp.measure(simulation, "Z")
    >>> sorted(name for name in measured if name.startswith("comp"))[:2]
    ['compressibility_factor', 'compressibility_factor_error']
    """

    __slots__ = ()

    @property
    def estimate(self) -> xr.DataArray:
        """Measured values."""
        return self[self.attrs["quantity"]]

    @property
    def error(self) -> xr.DataArray:
        """Standard uncertainties of the measured values."""
        return self[f"{self.attrs['quantity']}_error"]

    @property
    def theory(self) -> xr.DataArray | None:
        """Theoretical values; None if there is no theory for this scene."""
        return self.get(f"{self.attrs['quantity']}_theory")

    @property
    def deviation(self) -> xr.DataArray | None:
        """Measured value minus theory, in standard deviations of the difference; None if there is no theory.

        The result is NaN if the standard deviation is 0, for example for a constant quantity, because the
        probability of a difference is then unknown.
        """
        if self.theory is None:
            return None
        unsure = self[f"{self.attrs['quantity']}_theory_error"]
        scale = (self.error**2 + unsure**2) ** 0.5
        return (self.estimate - self.theory) / scale.where(scale > 0.0)

    @property
    def summary(self) -> str:
        """Result as text, such as `Z = 1.242(20), theory 1.227`.

        The text contains the short name of the quantity, if it has one. Several values are listed one by one.
        For a curve, only the number of values and the axis are stated.
        """
        quantity, estimate = self.attrs["quantity"], self.estimate
        name = name_of(quantity)
        if estimate.size > _FEW:
            axis = estimate.dims[-1]
            along = label_of(self[axis]) if axis in self.coords else str(axis)
            return f"{name}: {estimate.size} values along {along}"
        return "\n".join(_values(self, str(name)))

    def __repr__(self) -> str:
        text = "\n".join(filter(None, (self.summary, remark_of(self))))
        return text if self.estimate.size <= _FEW else f"{text}\n{super().__repr__()}"

    def _repr_html_(self) -> str:
        """Return HTML with the `summary`, a plot of a curve, and the collapsed data set."""
        text, remark = (html.escape(line).replace("\n", "<br>") for line in (self.summary, remark_of(self)))
        is_plotted = self.estimate.size > _FEW and len(_cells(self)) <= _PLANE
        drawn = f'<br><img src="{_embed_plot(self)}" alt="{text}">' if is_plotted else ""
        text = f"<b>{text}</b>" + (f"<br>{remark}" if remark else "")
        return f"{text}{drawn}<details><summary>data set</summary>{super()._repr_html_()}</details>"

    def plot(self, theory: bool = False, axis: Axes | None = None) -> Axes:  # type: ignore[override]
        """Plot the values with error bars of one standard deviation.

        For a scalar, the means of consecutive blocks of the run are plotted; for a field, a colour map or
        arrows.

        A notebook displays the Axes. In a script, use ``plot().figure.savefig("z.png")`` to write a file, or
        ``matplotlib.pyplot.show()`` to open a window.

        Parameters
        ----------
        theory : bool, default False
            If True, also draw the theoretical curve. If no theory exists for this scene, the legend says so.
        axis : matplotlib Axes, optional
            Axes to draw in. Default: a new one.

        Returns
        -------
        matplotlib Axes
            The Axes.

        Raises
        ------
        SceneError
            If the field has three axes.
        """
        import matplotlib.pyplot as plt

        if axis is None:
            axis = plt.figure(layout="constrained").add_subplot()
        has_theory = theory and self.theory is not None
        cells = _cells(self)
        if remark := remark_of(self):
            axis.set_title("\n".join(wrap(remark, _WIDE)), fontsize="small", loc="left")
        if len(cells) > 1:
            _plot_field(self, axis, cells)
            return axis
        if self.estimate.ndim:
            _plot_curve(self, axis, has_theory)
        else:
            _plot_scalar(self, axis, has_theory)
        if theory and not has_theory:
            axis.plot([], [], " ", label="no theory for this scene")
        axis.set_ylabel(label_of(self.estimate))
        axis.legend(frameon=False)
        return axis


def remark_of(result: xr.Dataset) -> str:
    """Return a remark if the measured part of the run drifts, otherwise ""."""
    drift = result.attrs.get("drift")
    return f"(not steady: {drift})" if drift else ""


def _values(result: Observable, name: str) -> list[str]:
    """Return each value with its uncertainty and, if it exists, its theory."""
    estimate, lines = result.estimate, []
    errors = np.broadcast_to(result.error.values, estimate.shape)
    theory = unsure = np.full(estimate.shape, np.nan)
    if result.theory is not None:
        theory, unsure = result.theory.values, result[f"{estimate.name}_theory_error"].values
    for index in np.ndindex(estimate.shape):
        indices = zip(estimate.dims, index, strict=True)
        words = [name, *(str(result[dim].values[n]) for dim, n in indices if dim in result.coords)]
        expected = _theory_text(float(theory[index]), float(unsure[index]))
        value = concise(float(estimate.values[index]), float(errors[index]))
        lines.append(f"{', '.join(words)} = {value}{expected}")
    return lines


_SHOWN = 5e-4
"""Relative uncertainty of a theory below which a summary does not show it."""


def _theory_text(theory: float, error: float) -> str:
    """Return a theory with its uncertainty as a part of a summary."""
    if not np.isfinite(theory):
        return ""
    return f", theory {concise(theory, error) if error > _SHOWN * abs(theory) else format(theory, '.4g')}"


def _embed_plot(result: Observable) -> str:
    """Return a plot of a curve as a data URL of the image."""
    from matplotlib.figure import Figure

    figure, content = Figure(figsize=(4.8, 3.0), layout="constrained"), io.BytesIO()
    result.plot(result.theory is not None, figure.add_subplot())
    figure.savefig(content, format="png", dpi=100)
    return f"data:image/png;base64,{base64.b64encode(content.getvalue()).decode()}"


def _plot_scalar(result: Observable, axis: Axes, theory: bool) -> None:
    value, error = float(result.estimate), float(result.error)
    label = result["stretches"].attrs.get("long_name", "stretches of the run")
    axis.plot(result["time"], result["stretches"], "o", markersize=3, label=label)
    axis.axhspan(value - error, value + error, alpha=0.3, label=f"measured, {value:.5g} ± {error:.1g}")
    if theory:
        assert result.theory is not None
        axis.axhline(float(result.theory), color="black", label=f"theory, {float(result.theory):.5g}")
    axis.set_xlabel(label_of(result["time"]))


def _plot_curve(result: Observable, axis: Axes, theory: bool) -> None:
    name = result.estimate.dims[-1]
    x = result[name]
    names = result[result.estimate.dims[0]].values if result.estimate.ndim > 1 else ["measured"]
    parts, errors = (variable.values.reshape(-1, x.size) for variable in (result.estimate, result.error))
    for part, error, label in zip(parts, errors, names, strict=True):
        if x.dtype.kind in "US":  # names, such as those of faces
            axis.errorbar(np.arange(x.size), part, error, fmt="o", capsize=2, label=label)
            axis.set_xticks(np.arange(x.size), [str(text) for text in x.values])
        else:
            axis.errorbar(x, part, error, fmt="o", markersize=3, label=label)
    if theory:
        assert result.theory is not None
        positions = np.arange(x.size) if x.dtype.kind in "US" else x
        marker = "" if result.theory.notnull().sum() > 2 else "x"  # for few values, such as contact values
        curves = np.unique(result.theory.values.reshape(-1, x.size), axis=0).T  # one curve if all are equal
        lines = axis.plot(positions, curves, color="black", marker=marker, zorder=3)
        lines[0].set_label("theory")
    axis.set_xlabel(label_of(x))


def _cells(result: Observable) -> list[str]:
    """Return the axes of a field; () for other results."""
    return [name for name in result.estimate.dims if name in ("x", "y", "z")]


def _plot_field(result: Observable, axis: Axes, cells: list[str]) -> None:
    """Draw a scalar field as a colour map, or a flow as arrows."""
    if len(cells) > _PLANE:
        raise SceneError("axes", "".join(cells), "a plot has two; choose a layer: .isel(z=0)")
    x, y = (result[name] for name in cells)
    if "component" in result.estimate.dims:
        u, v = (result.estimate.sel(component=name).transpose(*reversed(cells)) for name in cells)
        axis.quiver(x, y, u, v, np.hypot(u, v), pivot="mid")
    else:
        axis.pcolormesh(x, y, result.estimate.transpose(*reversed(cells)), shading="nearest")
    text = "speed of the flow (length / time)" if "component" in result.dims else label_of(result.estimate)
    axis.figure.colorbar(axis.collections[-1], ax=axis, label=text)
    axis.set(aspect="equal", xlabel=label_of(x), ylabel=label_of(y))


def label_of(values: xr.DataArray) -> str:
    """Return the label of a plotted axis: the meaning and the unit of a variable."""
    text = values.attrs.get("long_name", str(values.name))
    units = values.attrs.get("units", "1")
    between = "\n" if len(text) + len(units) > _LONG else " "
    return str(text) if units == "1" else f"{text}{between}({units})"


def scalar(
    name: str, series: np.ndarray, edges: np.ndarray, *, slow: bool = False, **about: Any
) -> Observable:
    """Return the mean of a correlated series over the intervals between frames, with its error. `series`:
    (M,), the values in the intervals. `edges`: (M + 1,), the times of the frames. `slow`: True if
    correlations may decay as slowly as 1 / t. `about`: attributes `units` and `long_name`, and optionally
    `theory` (a value and its uncertainty) and its `source`. Raises SceneError for fewer values than
    `LEAST_INTERVALS`.
    """
    if len(series) < LEAST_INTERVALS:
        raise SceneError("frames", len(series) + 1, f"an error needs {LEAST_INTERVALS + 1} or more")
    plain = correlated_mean(series, LEAST_INTERVALS).estimate
    estimate = slow_mean(series, LEAST_INTERVALS) if slow else plain
    error = estimate.error if np.ptp(series) > _ROUNDING * abs(estimate.value) else 0.0
    stretches = [part.mean() for part in np.array_split(series, min(STRETCHES, len(series)))]
    ends = [part[[0, -1]].mean() for part in np.array_split(0.5 * (edges[1:] + edges[:-1]), len(stretches))]
    result = observable(name, {}, estimate.value, error, **about)
    result["stretches"] = ("time", np.array(stretches), {"units": about["units"]})
    result["time"] = ("time", np.array(ends), {"units": "time", "long_name": "time"})
    result.attrs["freedom"] = estimate.freedom
    return result.set_coords("time")


def observable(
    name: str,
    along: dict[str, tuple[np.ndarray, dict]],
    values: np.ndarray | float,
    errors: np.ndarray | float,
    *,
    units: str,
    long_name: str,
    theory: tuple[Any, Any] | None = None,
    source: str | None = None,
) -> Observable:
    """Build a result from its parts; `along` has each dimension's coordinate and its attributes."""
    dims = tuple(along)
    parts = {name: (values, long_name), f"{name}_error": (errors, "standard uncertainty")}
    if theory is not None:
        shape = np.shape(values)
        parts[f"{name}_theory"] = np.broadcast_to(theory[0], shape), f"theory: {source}"
        parts[f"{name}_theory_error"] = np.broadcast_to(theory[1], shape), "uncertainty of theory"
    return Observable(
        {key: (dims, value, {"units": units, "long_name": text}) for key, (value, text) in parts.items()},
        coords={key: (key, coordinate, attributes) for key, (coordinate, attributes) in along.items()},
        attrs={"quantity": name} | ({"source": source} if source else {}),
    )


def with_freedom(result: Observable, freedom: np.ndarray | float) -> Observable:
    """Add the degrees of freedom of the errors to a result, with the suffix _freedom. `freedom`: degrees of
    freedom of each value, or one number for all values with a known error.
    """
    if not isinstance(freedom, np.ndarray):
        freedom = np.where(np.isnan(result.error), np.nan, freedom)
    about = {"units": "1", "long_name": "degrees of freedom of the uncertainty"}
    result[f"{result.attrs['quantity']}_freedom"] = result.estimate.dims, freedom, about
    return result
