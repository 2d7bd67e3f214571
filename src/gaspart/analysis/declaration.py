"""Declaration of an observable: its units, its result, its conditions, its transformations.

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
    """Replace exponents that depend on the dimension d by numbers.

    For example, `mass length^(2-d) / time` is `mass length^-1 / time` in three dimensions.
    """

    def number(match: re.Match[str]) -> str:
        if match[1] is None:
            return f"^{dimension}"
        first, second = (dimension if part == "d" else int(part) for part in match.groups())
        return f"^{first - second}"

    return _EXPONENT.sub(number, units)


def powers_of(units: str, dimension: int) -> tuple[int, int, int]:
    """Return the powers of length, mass and time in declared units.

    A value grows with these powers if the units become smaller.
    """
    total = [0, 0, 0]
    above, _, below = units_in(units, dimension).partition(" / ")
    for sign, part in ((1, above), (-1, below)):
        for unit, exponent in _FACTOR.findall(part):
            for n, power in enumerate(BASE[unit]):
                total[n] += sign * power * int(exponent or 1)
    return total[0], total[1], total[2]


@dataclass(frozen=True)
class Along:
    """Dimension of a result, and the effect of a change of the description on it.

    units : units of its coordinate.
    names : True if its coordinate has names, one value for each.
    exchanged : effect of an exchange of axes: "" none, "names" the names follow the axes, "chosen" the values
        are those along the other axis.
    mirrored : effect of a mirror across an axis: "" none, "ends" the low and the high face change places,
        "reversed" the values along this axis are in reverse order, "signs" a component changes its sign for
        each time that it names the axis.
    shifted : effect of a shift of all particles along a periodic axis: "" none, "moved" the values move along
        the axis.
    relabelled : True if the names follow the numbers of the species.
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
    """Observable that has a name.

    Its meaning:

    title : its name in words, and of its values on an axis, with its symbol.
    definition : a sentence, for a list.
    symbol : the symbol.
    units : powers of length, mass, time and energy with k_B = 1 (`units_in`).
    function : function of `gaspart.analysis`, called with `arguments`.
    along : dimensions of the result, from `DIMENSIONS`; empty for a number.
    selections : keyword arguments that restrict it, or give it along axes.

    Where it is defined:

    needs : data that a run must have stored: "" none, "paths" of particles, "pairs" the collisions of each
        pair of species, "fluxes" correlations of the stress and the heat flux, or "shear" the momentum along
        faces, which some engines tally.
    conditions : conditions of a scene, see `Condition`.
    needs_all_particles : requirement that the file has all particles: "always", "never", "mixed", if there
        are several kinds of particles, or "unless fluxes" are stored, which include the temperature.
    varying : True if it is defined where particles come and go through open faces.
    ends : keyword argument of the function with the end of its bins, if that follows from the run.
    nothing : equations that an engine solves (`Engine.equation`) whose runs do not determine it, each with
        the reason.

    The theory that it is compared with:

    theory : function in `analysis.expected`, which knows the equation of the engine.
    bulk : function of `analysis.bulk`, of an infinite plain gas by each equation.
    source : origin of its value for particles that touch, with {state} for the equation of state.
    mixture : function of `gaspart.theory` of a mixture; "" without one.

    Its transformations; units and `along` state changes of units, exchanges of axes, mirrors and shifts:

    moving : True if it is the same in a frame that moves uniformly.
    scatter : samples whose scatter is its uncertainty: parts of the "run", or groups of "particles", which
        other numbers of the particles change.
    merged : effect of stating one species as two equal ones: "" none, "split" a value for each of their
        pairs, or "lost" it is not defined for one of the two.

    The planning of runs:

    power : power of the temperature that it grows with.
    memory : True if it depends on the memory of collisions, which no kinetic equation has.
    lags : number of lags of its correlations in a pilot, 0 without.
    samples : purpose of the spacing of frames: "" a mean over time, "structure" independent positions,
        "paths" lags.
    of_impulses : True if it is computed from the impulses that all walls are given.
    by_impulses : True if impulses that a run stores make it more accurate.
    ends_runs : True if `--until` may require it.
    drives : conditions of a scene in whose steady state it is not 0, tested in addition to `conditions`
        before an accuracy is planned.
    tabulated : True if costs and errors are in the table.
    relative_to : reference of its relative accuracy, each "value", or their "norm" if some vanish on average.
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
    needs_all_particles: str = "always"
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
        """Form of the result: "number", "names" (a value for each of some names), or "curve"."""
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
        """Return the powers of length, mass and time in its units."""
        return powers_of(self.units, dimension)
