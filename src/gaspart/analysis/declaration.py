"""The form in which an observable is declared: its units, its result, where it is defined, how it transforms.

The declarations are in `observables`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from gaspart.scene.scene import Scene

Condition: TypeAlias = Callable[[Scene, Mapping[str, Any]], None]
"""Raises SceneError for a scene, and a selection, that an observable is not defined for, however long the
run."""
BASE = {"length": (1, 0, 0), "mass": (0, 1, 0), "time": (0, 0, 1), "energy": (2, 1, -2)}
"""The powers of length, mass and time of each word in units; k_B = 1."""
_FACTOR = re.compile(r"([a-z]+)(?:\^(-?\d+))?")
_EXPONENT = re.compile(r"\^(?:\((\d*d?)-(\d*d?)\)|d)")


def units_in(units: str, dimension: int) -> str:
    """Units as declared, with exponents that depend on the dimension d as numbers: `mass length^(2-d) / time`
    is `mass length^-1 / time` in three."""

    def number(found: re.Match[str]) -> str:
        if found[1] is None:
            return f"^{dimension}"
        first, second = (dimension if part == "d" else int(part) for part in found.groups())
        return f"^{first - second}"

    return _EXPONENT.sub(number, units)


def powers_of(units: str, dimension: int) -> tuple[int, int, int]:
    """The powers of length, mass and time in units as declared: by which a value grows if these units become
    smaller."""
    total = [0, 0, 0]
    above, _, below = units_in(units, dimension).partition(" / ")
    for sign, part in ((1, above), (-1, below)):
        for word, exponent in _FACTOR.findall(part):
            for n, power in enumerate(BASE[word]):
                total[n] += sign * power * int(exponent or 1)
    return total[0], total[1], total[2]


@dataclass(frozen=True)
class Along:
    """A dimension of a result, and what a change of the description does to it.

    units: of its coordinate; names: whether its coordinate has names, one value for each. exchanged: what an
    exchange of axes does: "" nothing, "names" the names follow the axes, "chosen" the values are those along
    the other axis. mirrored: what a mirror across an axis does: "" nothing, "ends" the low and the high face
    change places, "reversed" the values along this axis are in reverse order, "signs" a component changes
    its sign for each time that it names the axis. shifted: what a shift of all particles along a periodic
    axis does: "" nothing, "moved" the values move along the axis. relabelled: whether the names follow the
    numbers of the species.
    """

    meaning: str
    units: str = "1"
    names: bool = False
    exchanged: str = ""
    mirrored: str = ""
    shifted: str = ""
    relabelled: bool = False


DIMENSIONS: dict[str, Along] = {
    "lag": Along("lag", "time"),
    "speed": Along("speed", "length / time"),
    "distance": Along("distance", "length"),
    "wave_number": Along("wave number", "1 / length"),
    "position": Along("position", "length", exchanged="chosen", mirrored="reversed", shifted="moved"),
    "axis": Along("axis", names=True, exchanged="names"),
    "face": Along("face of the container", names=True, exchanged="names", mirrored="ends"),
    "component": Along("component", names=True, exchanged="names", mirrored="signs"),
    "pair": Along("numbers of two species, from 0", names=True, relabelled=True),
}
"""All dimensions of results."""


@dataclass(frozen=True)
class Named:
    """An observable that has a name.

    What it is. title: its name in words, and of its values on an axis, with its symbol; definition: in a
    sentence, for a list; symbol; units, in powers of length, mass, time and energy with k_B = 1 (`units_in`);
    function: of `gaspart.analysis`, with `arguments`; along: dimensions of the result, none of a number (of
    `DIMENSIONS`); selections: keyword arguments that restrict it, or give it along axes.

    Where it is. needs: what a run must have kept: "" nothing, "paths" of particles, "pairs" the collisions of
    each pair of species, "fluxes" correlations of the stress and the heat flux, or "shear" the momentum along
    faces, which some engines tally; conditions: of a scene, see `Condition`; whole: whether the file must
    have all particles: "always", "never", "mixed", of several kinds of them, or "unless fluxes" are kept,
    which have the temperature; varying: whether it is defined where particles come and go through open faces;
    ends: keyword argument of the function with the end of its bins, if that follows from the run; nothing:
    equations that an engine solves (`Engine.equation`) whose runs say nothing of it, each with the reason.

    What it is compared with. theory: a function in `analysis.expected`, which knows the equation of the
    engine; bulk: a function of `analysis.bulk`, of an infinite plain gas by each equation, and source: where
    its value for particles that touch is from, with {state} for the equation of state; mixture: a function of
    `gaspart.theory` of a mixture; "" without one.

    How it transforms. Units and `along` state it for changes of units, exchanges of axes, mirrors and shifts.
    moving: whether it is the same in a frame that moves uniformly; scatter: what its uncertainty is the
    scatter of, parts of the "run", or groups of "particles", which other numbers of the particles change;
    merged: what becomes of it if one species is stated as two that are equal: "" nothing, "split" a value for
    each of their pairs, or "lost" it is not defined for one of the two.

    How it is planned. power: of the temperature that it grows with; memory: whether it depends on the memory
    of collisions, which no kinetic equation has; lags: of its correlations in a pilot, 0 without; samples:
    what frames are spaced for: "" a mean over time, "structure" independent positions, "paths" lags;
    of_impulses: whether it is of the impulses that all walls are given; by_impulses: whether impulses that a
    run keeps make it more accurate; ends_runs: whether `--until` may require it; drives: conditions of a
    scene in whose steady state it is not 0, asked besides `conditions` before an accuracy is; tabulated:
    whether costs and errors are in the table; relative_to: what its accuracy is relative to, each "value",
    or their "norm" where some vanish on average.
    """

    title: str
    definition: str
    units: str
    function: str
    arguments: dict[str, Any] = field(default_factory=dict)
    symbol: str = ""
    along: tuple[str, ...] = ()
    selections: tuple[str, ...] = ()
    needs: str = ""
    conditions: tuple[Condition, ...] = ()
    whole: str = "always"
    varying: bool = False
    ends: str = ""
    nothing: dict[str, str] = field(default_factory=dict)
    theory: str = ""
    bulk: str = ""
    source: str = ""
    mixture: str = ""
    moving: bool = True
    scatter: str = "run"
    merged: str = ""
    power: float = 0.0
    memory: bool = False
    lags: int = 0
    samples: str = ""
    of_impulses: bool = False
    by_impulses: bool = False
    ends_runs: bool = False
    drives: tuple[Condition, ...] = ()
    tabulated: bool = False
    relative_to: str = "value"

    @property
    def form(self) -> str:
        """ "number", "names" (one for each of some names), or "curve"."""
        if not self.along:
            return "number"
        return "names" if DIMENSIONS[self.along[-1]].names else "curve"

    @property
    def label(self) -> str:
        """The title with the symbol."""
        return f"{self.title} {self.symbol}".rstrip()

    @property
    def listed(self) -> str:
        """The definition, with the option of the run that it needs."""
        options = {"pairs": ", of a run with --pairs", "fluxes": ", of a run with --stress"}
        return self.definition + options.get(self.needs, "")

    def powers(self, dimension: int) -> tuple[int, int, int]:
        """Of length, mass and time in its units."""
        return powers_of(self.units, dimension)
