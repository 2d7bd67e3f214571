"""Declaration of an observable: units, form of the result, conditions, and symmetries.

The module `observables` contains all declarations.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from gaspart.scene.scene import Scene

Condition: TypeAlias = Callable[[Scene, Mapping[str, Any]], None]
"""Function that raises SceneError if an observable is undefined for a scene and a selection, for runs of any
length.
"""
BASE = {"length": (1, 0, 0), "mass": (0, 1, 0), "time": (0, 0, 1), "energy": (2, 1, -2)}
"""Powers of length, mass and time for each word in unit strings; k_B = 1."""
_FACTOR = re.compile(r"([a-z]+)(?:\^(-?\d+))?")
_EXPONENT = re.compile(r"\^(?:\((\d*d?)-(\d*d?)\)|d)")


def units_in(units: str, dimension: int) -> str:
    """Replace exponents that depend on the dimension d by numbers.

    For example, `mass length^(2-d) / time` becomes `mass length^-1 / time` in three dimensions.
    """

    def number(match: re.Match[str]) -> str:
        if match[1] is None:
            return f"^{dimension}"
        first, second = (dimension if part == "d" else int(part) for part in match.groups())
        return f"^{first - second}"

    return _EXPONENT.sub(number, units)


def powers_of(units: str, dimension: int) -> tuple[int, int, int]:
    """Return the powers of length, mass and time in the declared units.

    If the units become smaller, the numerical value grows with these powers.
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
    """Dimension of a result, and how its values change when the scene is transformed.

    units : units of the coordinate.
    names : True if the coordinate consists of names, one for each value.
    exchanged : effect of exchanging axes. "": none. "names": the names follow the axes. "chosen": the values
        belong to the other axis.
    mirrored : effect of a mirror image across an axis. "": none. "ends": the low and the high face are
        exchanged. "reversed": the values along this axis are in reverse order. "signs": a component changes
        its sign once for each occurrence of the axis in its name.
    shifted : effect of a shift of all particles along a periodic axis. "": none. "moved": the values move
        along the axis.
    relabelled : True if the names follow the species numbers.
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
"""Dimensions of all results, by name."""


@dataclass(frozen=True)
class Named:
    """Declaration of a named observable.

    Description:

    title : name in words, and label of its values on an axis, with the symbol.
    definition : definition in one sentence.
    symbol : the symbol.
    units : units as powers of length, mass, time and energy with k_B = 1 (`units_in`).
    function : name of the function in `gaspart.analysis`, and its `arguments`.
    along : dimensions of the result, names in `DIMENSIONS`; empty for a scalar.
    selections : keyword arguments that restrict the observable, or resolve it along axes.

    Conditions of definition:

    needs : stored data that the observable needs. "": none. "paths": paths of particles. "pairs": numbers of
        collisions of each pair of species. "fluxes": correlations of the stress and the heat flux. "shear":
        momentum along faces, which only some engines tally.
    conditions : conditions on a scene, see `Condition`.
    needs_all_particles : when the file must contain all particles. "always", "never", "mixed" (with several
        kinds of particles), or "unless fluxes" (unless the run stores fluxes, which include the temperature).
    varying : True if the observable is defined in scenes with open faces.
    ends : keyword argument of the function for the end of its bins, if this follows from the run.
    nothing : equations (`Engine.equation`) that do not determine the observable, with a reason for each
        equation.

    Theory for comparison:

    theory : function in `analysis.expected` that computes the theory for the equation of the engine.
    bulk : function of `theory.bulk` for an infinite plain gas and each equation.
    source : source of the theoretical value for the exact dynamics; {state} stands for the equation of state.
    mixture : function of `gaspart.theory` for a mixture; "" without one.

    Symmetries (units and `along` determine changes of units, exchanges of axes, mirror images and shifts):

    moving : True if the observable is the same in a uniformly moving frame of reference.
    scatter : samples whose scatter gives the uncertainty: parts of the "run", or groups of "particles". The
        groups depend on the order of the particles.
    merged : effect of splitting a species into two equal species. "": none. "split": a value for each of
        their pairs. "lost": undefined for one of the two.

    Planning of runs:

    power : power of the temperature to which the observable is proportional.
    memory : True if the observable depends on correlated collisions, which no kinetic equation includes.
    lags : number of lags of its correlations in a pilot run, 0 without correlations.
    samples : criterion for the time between frames. "": average over time. "structure": independent
        positions. "paths": lags.
    of_impulses : True if the observable is computed from the impulses on all walls.
    by_impulses : True if stored impulses make the observable more accurate.
    ends_runs : True if `--until` may require an accuracy of the observable.
    drives : conditions under which the observable is nonzero in the steady state. They are tested in addition
        to `conditions` before a run is planned.
    tabulated : True if the table contains costs and errors.
    relative_to : reference of the relative accuracy: each "value", or the "norm" of all values if some vanish
        on average.
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
        """Form of the result: "number", "names" (one value per name), or "curve"."""
        if not self.along:
            return "number"
        return "names" if DIMENSIONS[self.along[-1]].names else "curve"

    @property
    def label(self) -> str:
        """Title with the symbol."""
        return f"{self.title} {self.symbol}".rstrip()

    @property
    def listed(self) -> str:
        """Definition, with the option that the run needs."""
        options = {"pairs": ", of a run with --pairs", "fluxes": ", of a run with --stress"}
        return self.definition + options.get(self.needs, "")

    def powers(self, dimension: int) -> tuple[int, int, int]:
        """Return the powers of length, mass and time in its units."""
        return powers_of(self.units, dimension)
