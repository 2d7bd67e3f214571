"""Cells of a scene, and the errors that cells and steps cause.

Every particle of a cell is a possible partner. Three errors follow:

- Partners at a distance exchange momentum and energy across a gradient. The excess of the viscosity is a
  (w/l)^2, where w is the side of a cell along which the gas varies and l the mean free path
  (`CELL_VISCOSITY`). In a dense gas the excess is smaller relative to the viscosity of Enskog's theory.
- Two particles that have collided may collide again at once, if no motion has separated them. The repeated
  collision changes nothing, because the direction of the relative velocity is already random. The number of
  repeated collisions per collision is nu / n times the time that a pair spends in a cell, where n is the
  number of particles in a cell and nu the collision rate. Diffusion, viscosity and relaxation times are too
  large by this fraction; collision rates are exact.
- In the Enskog model the particles of a pair have to approach along the line of centres, and after a
  collision they move apart. So the repeated collisions are missing.

Along an axis on which the gas does not vary there is a single cell. Along the other axes cells have the width
with the smallest sum of the errors of rates, paths and fluxes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.state.boxes import cube_side
from gaspart.theory.discretisation import CELL_VISCOSITY, DENSE_VISCOSITY, STEP_COEFFICIENTS, STRESS_TRANSFER
from gaspart.theory.rates import MEAN_SQUARE, Rates, accessible, rates, usual_count

if TYPE_CHECKING:
    from gaspart.engines.dsmc.settings import DsmcSettings

FULL = 64.0
"""Number of particles per cell if the width of cells has no effect."""
FEWEST = 8.0
"""Minimum number of particles per cell with `LAYERS` cells across the walls."""
LAYERS = 8
"""Minimum number of cells between walls across which the gas varies."""
CELL_LOSS = {2: 0.85, 3: 0.6}
"""Maximum fraction of collisions that the Enskog model misses, multiplied by the number of particles per
cell, by dimension (docs/dsmc.md).
"""
NOTABLE = 0.05
"""Error, and deficit of the Boltzmann model's collision rate, above which a run states it."""
_BETTER = 2.0 / 3.0
"""Largest ratio of the errors of other and of present cells at which the other cells are recommended."""
LONGEST = 0.2
"""Longest recommended step in mean free times."""
_STAY = {1: 4.0 / 3.0, 2: 2.0 / 3.0, 3: 2.0 / 3.0}
"""Mean time that a pair spends in a cell, by the number of axes along which it can leave.

The unit is the inverse of the sum over axes of mean relative velocity divided by width. The values are means
of the exact time over directions, 0.67 for cubes, 0.60 for squares and, with the collisions of both
particles as the limit, about 1.3 for layers.
"""
_FINER = 2.0**-0.125
"""Ratio of two widths of cells that are compared."""


def varying_axes(scene: Scene) -> tuple[bool, ...]:
    """Return flags (d,) of the axes along which the gas may vary. Between walls it varies across the walls
    alone, if no unstable layers, clusters or initial regions can change this.
    """
    walled = tuple(not around for around in scene.container.periodic)
    rolls = _falls(scene) and len(scene.face_temperatures) > 1
    if rolls or scene.particles or not spreads(scene) or not any(walled):
        return (True,) * scene.dimension
    return walled


def spreads(scene: Scene) -> bool:
    """Return True if nothing in a scene concentrates particles."""
    return not _starts_uneven(scene) and not _dissipates(scene)


def _starts_uneven(scene: Scene) -> bool:
    return any(kind.arrangement == "slab" or kind.region is not None for kind in scene.species)


def _dissipates(scene: Scene) -> bool:
    return scene.restitution is not None and scene.restitution.dissipative


def flows(scene: Scene) -> bool:
    """Return True if momentum, heat or particles flow in the steady state, or before it."""
    if len(scene.face_temperatures) > 1 or scene.sliding_faces or scene.is_open or _falls(scene):
        return True
    between_walls = _dissipates(scene) or bool(scene.driven_axes)
    return _starts_uneven(scene) or (between_walls and not scene.is_periodic)


def _falls(scene: Scene) -> bool:
    """Return True if gravity acts towards walls."""
    return falling_axis(scene) is not None


def falling_axis(scene: Scene) -> int | None:
    """Return the axis between walls along which gravity is strongest, or None."""
    periodic = scene.container.periodic
    pulls = [0.0 if around else abs(g) for g, around in zip(scene.gravity or (), periodic, strict=False)]
    return pulls.index(max(pulls)) if any(pulls) else None


# Errors of cells and steps, and the cells with the smallest error.


@dataclass(frozen=True)
class Errors:
    """Relative errors due to cells and steps; each makes a transport coefficient too high."""

    width: float = 0.0
    repeats: float = 0.0
    lost: float = 0.0
    step: float = 0.0
    path: float = 0.0

    @property
    def total(self) -> float:
        """Sum of the errors of rates, paths and fluxes."""
        return self.of("rates") + self.of("paths") + self.of("fluxes")

    def of(self, kind: str) -> float:
        """Return the error of a kind of quantity, see `Engine.bias`."""
        if kind in ("rates", "walls"):
            return self.lost
        return self.repeats + (self.path if kind == "paths" else self.width + self.step)


@dataclass(frozen=True)
class Medium:
    """Gas of a scene as a collision model sees it."""

    model: str
    scene: Scene
    gas_rates: Rates
    number: float

    @property
    def dense(self) -> bool:
        """True for the Enskog model."""
        return self.model == "enskog"

    @cached_property
    def resolves(self) -> bool:
        """True if results depend on the width of cells. Without flows they do so only in elastic gases of the
        Boltzmann model, whose stress includes transfers between the partners in a cell. The Enskog model
        tallies transfers over a diameter.
        """
        return flows(self.scene) or not (self.dense or _dissipates(self.scene))

    @cached_property
    def varying(self) -> tuple[bool, ...]:
        """See `varying_axes`."""
        return varying_axes(self.scene)

    @cached_property
    def _of_width(self) -> float:
        """Error of fluxes divided by the squared width of cells in mean free paths."""
        if not self.resolves:
            return 0.0
        return CELL_VISCOSITY[self.scene.dimension] * (_share_of_flights(self.scene) if self.dense else 1.0)

    def errors(self, cells: tuple[int, ...], step: float) -> Errors:
        """Return the errors of cells and a step; for discs the coefficients of the step are estimates."""
        gas_rates, d = self.gas_rates, self.scene.dimension
        if not gas_rates.path < math.inf:
            return Errors()
        widths, repeats, several = widths_of(cells, self.scene), 0.0, math.prod(cells)
        width = self._of_width * (float(widths[list(self.varying)].max()) / gas_rates.path) ** 2
        if several > 1:
            left = widths[np.array(cells) > 1]
            together = CELL_LOSS[d] if self.dense else _collisions_together(left, step, d, gas_rates)
            repeats = together * several / self.number
        lost = repeats if self.dense or _dissipates(self.scene) else 0.0
        thermal = math.sqrt(2.0) * gas_rates.speed / math.sqrt(MEAN_SQUARE[d]) * step / gas_rates.path
        steps = [STEP_COEFFICIENTS[name] * thermal**2 for name in ("viscosity", "diffusion")]
        return Errors(width, repeats, lost, *steps)

    def bulk_viscosity(self, cells: tuple[int, ...]) -> float:
        """Return the bulk viscosity due to the distance of partners in cells, see `STRESS_TRANSFER`."""
        d, widths = self.scene.dimension, widths_of(cells, self.scene)
        mass = self.scene.number_density * self.scene.moving_kinds[0].mass
        return STRESS_TRANSFER[d] / d**2 * mass * self.gas_rates.frequency * float((widths**2).sum())

    def recommended(self, step: float) -> tuple[int, ...]:
        """Return the recommended number of cells along each axis (d,). Across walls between which the gas
        varies there are `LAYERS` cells, if there are enough particles. The remaining cells are divided among
        the other axes.
        """
        fit, axis = self._fitting(step, {}), falling_axis(self.scene)
        if axis is None and flows(self.scene) and sum(self.varying) == 1:
            axis = self.varying.index(True)
        layers = min(LAYERS, math.floor(self.number / FEWEST))
        return fit if axis is None or layers <= fit[axis] else self._fitting(step, {axis: layers})

    def _fitting(self, step: float, given: dict[int, int]) -> tuple[int, ...]:
        """Return the cells with the smallest sum of errors, with a given number along some axes."""
        lower, upper = accessible(self.scene)
        lengths = tuple(float(length) for length in upper - lower)
        free = [axis for axis, varies in enumerate(self.varying) if varies and axis not in given]

        def cells_of(width: float) -> tuple[int, ...]:
            number = {axis: max(1, math.floor(lengths[axis] / width + 1e-9)) for axis in free} | given
            return tuple(number.get(axis, 1) for axis in range(len(lengths)))

        sides, filled = tuple(lengths[axis] for axis in free), self.number / math.prod(given.values())
        if not free or not self.gas_rates.path < math.inf:
            return cells_of(math.inf)
        if not self.resolves:
            return cells_of(cube_side(sides, filled / FULL))
        widest, narrowest = max(sides), cube_side(sides, filled)
        steps = max(0, math.ceil(math.log(widest / narrowest) / -math.log(_FINER)))
        choices = [cells_of(widest * _FINER**n) for n in range(steps + 1)]
        return min(choices, key=lambda cells: self.errors(cells, step).total)


def _collisions_together(widths: np.ndarray, step: float, dimension: int, gas_rates: Rates) -> float:
    """Return the number of collisions of a particle while a pair that has collided stays together. The pair
    leaves its cell, or another collision of one of them ends the time. The sum over whole steps replaces the
    integral over an exponential decay.
    """
    across = math.sqrt(2.0) * {2: 2.0 / math.pi, 3: 0.5}[dimension] * gas_rates.path
    left = across * float((1.0 / widths).sum()) / _STAY[len(widths)] + 2.0
    half = max(0.5 * step * gas_rates.frequency, 1e-9)  # the limit of gases at rest
    return half / math.tanh(half * left)


def _contact(scene: Scene) -> float:
    """Return the mean contact value of a scene that fills its container homogeneously."""
    dilute, dense = (rates(scene, is_dense).frequency for is_dense in (False, True))
    return dense / dilute if dilute > 0.0 else 1.0


def _share_of_flights(scene: Scene) -> float:
    """Return the viscosity of flights without collisional transfer, divided by Enskog's viscosity."""
    excess = 2.0 ** (scene.dimension - 1) * scene.packing_fraction * _contact(scene)
    linear, square = DENSE_VISCOSITY[scene.dimension]
    return 1.0 / (1.0 + linear * excess + square * excess**2)


def widths_of(cells: tuple[int, ...], scene: Scene) -> np.ndarray:
    """Return the sides (d,) of a cell."""
    lower, upper = accessible(scene)
    return (upper - lower) / np.array(cells)


def medium_for(
    engine: DsmcSettings, scene: Scene, gas_rates: Rates | None = None, crowding: float = 1.0
) -> Medium:
    """Return the gas of a scene for an engine, with `gas_rates` at the mean density (default: at the start)
    and the relative `crowding` around a particle.
    """
    found = gas_rates or rates(scene, engine.model == "enskog")
    return Medium(engine.model, scene, found.at_density(crowding), crowding * usual_count(scene))


def cells_for(engine: DsmcSettings, medium: Medium, step: float, crowding: float = 1.0) -> tuple[int, ...]:
    """Return the prescribed or recommended number of cells along each axis (d,)."""
    prescribed, d = engine.cells_per_side, medium.scene.dimension
    if prescribed is None or (engine.adapts_cells and crowding > 1.0):
        return medium.recommended(step)
    sides = tuple(prescribed) if isinstance(prescribed, (tuple, list)) else (prescribed,) * d
    if len(sides) != d:
        raise SceneError("cells_per_side", prescribed, f"must be one number, or one for each of {d} axes")
    return sides


# Remarks about settings and about the model.


def remarks(
    engine: DsmcSettings, medium: Medium, cells: tuple[int, ...], step: float, when: str = ""
) -> dict[str, str]:
    """Return a remark, by setting, on notable errors, with better values; `when` describes the time."""
    texts, gas_rates = {}, medium.gas_rates
    error, shorter = medium.errors(cells, step).of("fluxes"), step
    if not engine.adapts_steps and step * gas_rates.frequency > LONGEST:
        shorter = LONGEST / gas_rates.frequency
    of_cells = medium.errors(cells, shorter)
    rest = of_cells.of("fluxes")
    if error - rest > NOTABLE:
        texts["time_step"] = (
            f"time_step = {step:g} is {step * gas_rates.frequency:.2g} mean free times{when} and"
            f" makes the viscosity {100.0 * error:.2g} % too high: {100.0 * rest:.2g} % with a step of"
            f" {shorter:.2g}"
        )
    if rest > NOTABLE:
        wide = float(widths_of(cells, medium.scene)[list(medium.varying)].max()) / gas_rates.path
        effect = f"make the viscosity {100.0 * rest:.2g} % too high"
        if medium.dense and 2.0 * of_cells.lost > rest:
            effect = f"lose up to {100.0 * of_cells.lost:.2g} % of the collisions"
        fit = medium.recommended(shorter)
        fitting, remedy = medium.errors(fit, shorter).of("fluxes"), "more particles make it less"
        if fitting < _BETTER * rest:
            remedy = f"{100.0 * fitting:.2g} % with cells_per_side = {fit}"
        texts["cells_per_side"] = (
            f"cells {wide:.2g} mean free paths wide, with {medium.number / math.prod(cells):.2g}"
            f" particles each,{when} {effect}: {remedy}"
        )
    return texts


def neglected(engine: DsmcSettings, scene: Scene) -> str | None:
    """Return a remark about the excluded volume if the model neglects a notable part of the collisions."""
    if engine.model == "enskog" or (contact := _contact(scene)) < 1.0 / (1.0 - NOTABLE):
        return None
    excess = 2.0 ** (scene.dimension - 1) * scene.packing_fraction * contact
    return (
        f"model = boltzmann neglects the size of particles: at a packing fraction of"
        f" {scene.packing_fraction:.2g} it gives a collision rate {100.0 * (1.0 - 1.0 / contact):.2g} % and a"
        f" pressure {100.0 * excess / (1.0 + excess):.2g} % too low"
        + ("" if scene.is_open else "; model = enskog includes both")
    )
