"""Fields: density, flow and temperature in cells along one or more axes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from gaspart.analysis.observable import Observable, observable
from gaspart.analysis.pairs import STRETCHES
from gaspart.analysis.run import Run, Source, measured, selected
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.scene.validation import choice, count_of

_Sums: TypeAlias = Callable[..., np.ndarray]
QUANTITIES = ("density", "velocity", "temperature")


def field(
    source: Source,
    of: str = "density",
    axes: str | None = None,
    cells: int | Sequence[int] = 20,
    start: float | None = None,
    species: int | None = None,
) -> Observable:
    """A property of the moving particles in equal cells along axes, ("x", "y"), mean over all frames.

    of: "density", particles per volume of the cell; "velocity", their mean velocity, ("component", "x", "y");
    "temperature", 2/d of their mean kinetic energy about the mean velocity of mass (NaN, as of the velocity,
    in cells that were empty during a sixteenth of the run). axes: such as "xy", by default the first two;
    cells: their number, of each axis; along the other axes a cell is as long as the container. start: the
    time from which frames count (by default a quarter of the run); species: of one alone, by its number in
    the scene.

    Raises SceneError for an unknown property or axis, a file without all particles, and too few frames.
    """
    choice("of", of, QUANTITIES)
    with measured(source, start, sheared=True) as run:
        along = _axes(run, axes)
        numbers = _numbers(cells, len(along))
        parts = np.array_split(np.arange(len(run.time)), min(STRETCHES, len(run.time)))
        if len(parts) < STRETCHES:
            raise SceneError("frames", len(run.time), f"an error needs {STRETCHES} or more")
        lengths = [run.scene.container.lengths[k] for k in along]
        edges = [np.linspace(0.0, length, n + 1) for length, n in zip(lengths, numbers, strict=True)]
        members = np.flatnonzero(run.moving)[selected(run, species, None)]
        cellwise = _Cells(run, members, along, edges)
        values, errors = means_of([getattr(cellwise, of)(part) for part in parts])
        coordinates: dict[str, Any] = {}
        if of == "velocity":
            coordinates["component"] = (np.array(list("xyz"[: run.dimension])), {"long_name": "component"})
        for k, edge in zip(along, edges, strict=True):
            middle = 0.5 * (edge[1:] + edge[:-1])
            coordinates["xyz"[k]] = (middle, {"units": "length", "long_name": "xyz"[k]})
        units, name = {
            "density": (f"1 / length^{run.dimension}", "number density"),
            "velocity": ("length / time", "velocity"),
            "temperature": ("energy", "temperature"),
        }[of]
        return observable(of, coordinates, values, errors, units=units, long_name=name)


def _axes(run: Run, axes: str | None) -> list[int]:
    """The numbers of the named axes. Raises SceneError."""
    names = "xyz"[: run.dimension]
    wanted = "xy" if axes is None else axes
    if not wanted or len(set(wanted)) < len(wanted) or not set(wanted) <= set(names):
        raise SceneError("axes", wanted, f"must be some of {names}, each once")
    return [names.index(axis) for axis in wanted]


def _numbers(cells: int | Sequence[int], axes: int) -> list[int]:
    """The number of cells along each axis. Raises SceneError."""
    each = [cells] * axes if isinstance(cells, int) else list(cells)
    if len(each) != axes:
        raise SceneError("cells", each, f"must be one number, or {axes}")
    return [count_of("cells", number, least=1) for number in each]


class _Cells:
    """Means of the chosen particles in cells, over a part of the frames, (cells, ...)."""

    def __init__(self, run: Run, members: np.ndarray, axes: list[int], edges: list[np.ndarray]) -> None:
        self._run, self._members, self._axes, self._edges = run, members, axes, edges
        sizes = [len(edge) - 1 for edge in edges]
        self._volume = run.scene.container.volume / np.prod(sizes)

    def _sums(self, part: np.ndarray) -> _Sums:
        """The function that adds weights (T, M) of the particles, or their number, in each cell."""
        positions = self._run.positions[part][:, self._members][:, :, self._axes]
        # Rounding may put a particle on, or a little beyond, a face.
        places = np.clip(positions.reshape(-1, len(self._axes)), 0.0, [edge[-1] for edge in self._edges])

        def sums(weights: np.ndarray | None = None) -> np.ndarray:
            flat = None if weights is None else weights.ravel()
            return np.histogramdd(places, self._edges, weights=flat)[0]

        return sums

    def density(self, part: np.ndarray) -> np.ndarray:
        """Particles per volume."""
        return self._sums(part)() / (len(part) * self._volume)

    def velocity(self, part: np.ndarray) -> np.ndarray:
        """(d, cells) mean velocity."""
        sums, velocities = self._sums(part), self._run.velocities[part][:, self._members]
        with np.errstate(invalid="ignore"):
            return np.stack([sums(component) for component in velocities.transpose(2, 0, 1)]) / sums()

    def temperature(self, part: np.ndarray) -> np.ndarray:
        """Twice the kinetic energy about the flow, per particle and dimension."""
        sums, weight, momenta, velocities = self._moments(part)
        masses = np.broadcast_to(self._run.masses[self._members], velocities.shape[:2])
        energy = sums(masses * (velocities**2).sum(axis=2))
        energy += ((self._flow * weight - 2.0 * momenta) * self._flow).sum(axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            return energy / (self._run.dimension * sums())

    @cached_property
    def _flow(self) -> np.ndarray:
        """(d, cells) mean velocity of mass in the whole run: that of a short part would take up fluctuations
        with the flow. 0 in cells that stay empty."""
        _, weight, momenta, _ = self._moments(np.arange(len(self._run.time)))
        return np.divide(momenta, weight, out=np.zeros_like(momenta), where=weight > 0.0)

    def _moments(self, part: np.ndarray) -> tuple[_Sums, np.ndarray, np.ndarray, np.ndarray]:
        """The sums over cells, in each the mass and momentum (d, cells), and the velocities (T, M, d)."""
        sums, velocities = self._sums(part), self._run.velocities[part][:, self._members]
        masses = np.broadcast_to(self._run.masses[self._members], velocities.shape[:2])
        momenta = np.stack([sums(masses * component) for component in velocities.transpose(2, 0, 1)])
        return sums, sums(masses), momenta, velocities
