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
"""Function that raises SceneError if an observable is undefined for a scene and a selection, whatever the
length of the run.
"""
BASE = {"length": (1, 0, 0), "mass": (0, 1, 0), "time": (0, 0, 1), "energy": (2, 1, -2)}
"""Powers of length, mass and time that each word in a unit string stands for, with k_B = 1."""
_FACTOR = re.compile(r"([a-z]+)(?:\^(-?\d+))?")
_EXPONENT = re.compile(r"\^(?:\((\d*d?)-(\d*d?)\)|d)")


def units_in(units: str, dimension: int) -> str:
    """Replace exponents with d by numbers: in 3D `mass length^(2-d) / time` becomes `mass length^-1
    / time`.
    """

    def number(match: re.Match[str]) -> str:
        if match[1] is None:
            return f"^{dimension}"
        first, second = (dimension if part == "d" else int(part) for part in match.groups())
        return f"^{first - second}"

    return _EXPONENT.sub(number, units)


def powers_of(units: str, dimension: int) -> tuple[int, int, int]:
    """Return the powers of length, mass and time in the declared units, by which a value changes
    with units.
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
    names : True if the coordinate labels each value with a name.
    exchanged : effect of exchanging two axes. "": none. "names": the axes in the names are exchanged.
        "chosen": the values then belong to the other axis.
    mirrored : effect of a mirror image across an axis. "": none. "ends": the values of the low and the high
        face are exchanged. "reversed": the values along this axis are in reverse order. "signs": the sign of
        a component changes once for each occurrence of the axis in the component's name.
    shifted : effect of a shift of all particles along a periodic axis. "": none. "moved": the values are
        shifted along the axis.
    relabelled : True if the names change when the species are renumbered.
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
    """Declaration of a named observable. Description:

    title : name of the observable in words. With the symbol, it is the label of a plotted axis.
    definition : definition in one sentence.
    symbol : the symbol.
    units : units as powers of length, mass, time and energy with k_B = 1 (`units_in`).
    function : name of the function in `gaspart.analysis`, and its `arguments`.
    along : dimensions of the result, as names in `DIMENSIONS`; empty for a scalar.
    selections : keyword arguments that restrict the observable to some particles or positions, or resolve it
        along axes.

    Conditions of definition:

    needs : data that the run must have stored. "": none. "paths": paths of particles. "pairs": numbers of
        collisions of each pair of species. "fluxes": correlations of the stress and the heat flux. "shear":
        tangential momentum given to faces, which only some engines tally.
    conditions : conditions on a scene, see `Condition`.
    needs_all_particles : when the file must contain all particles. "always", "never", "mixed" (if there are
        several kinds of particles), or "unless fluxes" (always, except if the run stores fluxes, because
        these data include the temperature).
    varying : True if the observable is also defined in scenes with open faces, where the number of particles
        varies.
    ends : keyword argument of the function that sets the upper end of its bins, if the default depends on the
        run.
    nothing : equations (`Engine.equation`) that do not determine the observable, each with the reason.

    Theory for comparison:

    theory : function in `analysis.expected` that computes the theory for the equation of the engine.
    discretised : errors of the cells and steps of an engine that change the observable: "rates", "paths",
        "fluxes" or "walls" (`Engine.bias`); "" if they do not change it.
    bulk : function of `theory.bulk` that computes the observable of an infinite plain gas for each equation.
    source : source of the theoretical value for the exact dynamics; {state} stands for the equation of state.
    mixture : function of `gaspart.theory` that computes the theory for a mixture; "" without a theory.

    Symmetries (the effects of changes of units, exchanges of axes, mirror images and shifts follow from
    `units` and `along`):

    moving : True if the observable is the same in a uniformly moving frame of reference.
    scatter : samples whose scatter gives the uncertainty. "run": parts of the run. "particles": groups of
        particles, which depend on the order of the particles.
    merged : effect of splitting a species into two equal species. "": none. "split": the result has a value
        for each pair of the two new species. "lost": the observable is undefined for one of the two new
        species.

    Planning of runs:

    power : power of the temperature to which the observable is proportional.
    memory : True if the observable depends on correlations between collisions, which kinetic equations
        neglect.
    lags : number of lags of the correlations that a pilot run stores for it; 0 if it needs no correlations.
    samples : criterion for the time between frames. "": no criterion, because the observable is an average
        over time. "structure": positions in consecutive frames should be independent. "paths": frames must
        resolve the lags.
    of_impulses : True if the observable is computed from the impulses on all walls.
    by_impulses : True if stored impulses make the observable more accurate.
    ends_runs : True if `--until` accepts the observable, so that its accuracy can end a run.
    drives : conditions under which the observable is nonzero in the steady state. They are tested in addition
        to `conditions` before a run is planned.
    tabulated : True if the accuracy table contains costs and errors of the observable.
    relative_to : quantity by which an error is divided to obtain the relative accuracy: each "value", or the
        "norm" of all values if some values vanish on average.
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
    discretised: str = ""
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
        """Definition of the observable, with the option that the run needs."""
        options = {"pairs": ", of a run with --pairs", "fluxes": ", of a run with --stress"}
        return self.definition + options.get(self.needs, "")

    def powers(self, dimension: int) -> tuple[int, int, int]:
        """Return the powers of length, mass and time in the units of the observable."""
        return powers_of(self.units, dimension)
