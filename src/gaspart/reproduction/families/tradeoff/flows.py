"""Choices for two gases out of equilibrium: heat flux between plates, relaxation of speeds.

Neither has a theory that is exact in a dense gas, so that each engine is run, and its difference from the
event-driven one, with two standard errors, bounds its error; theory's own bound is taken where it is lower,
as in a dilute gas. Runs are of about the number of particles that costs are stated for.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from gaspart import theory
from gaspart.accuracy.conditions import even_conditions
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import mean_of
from gaspart.engines.dsmc.accuracy import boltzmann_error, enskog_error
from gaspart.engines.dsmc.defaults import rates
from gaspart.engines.engine import AccuracyRequest
from gaspart.reproduction.families.heat.gap import Gap, averages
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.families.speeds.measure import kurtosis
from gaspart.reproduction.families.tradeoff.choices import Choice
from gaspart.reproduction.families.tradeoff.relaxation import FREE_TIMES
from gaspart.reproduction.families.tradeoff.uniform import BOUND
from gaspart.reproduction.points.point import Point
from gaspart.theory.dsmc import cell_factor, step_factor

FLOWS = ("heat_flux", "relaxation")
SETTLED = 5.0
"""Decay times of the slowest wave of temperature between plates before the flux is measured."""


@dataclass(frozen=True)
class Flow:
    """Measurement by one engine.

    engine : one of `choices.ENGINES`.
    time_step : time step, 0 without.
    count : number of particles.
    value : value of the flux, or the relaxation time over the mean free time.
    variance : relative variance, times the time of simulation.
    contacts : contacts per time.
    decay : time in which the slowest trace of the initial state falls to 1/e, 0 if that is what is measured.
    shortest : minimum time that is simulated.
    bounds : theory's, on the errors of model and discretisation.
    """

    observable: str
    packing_fraction: float
    engine: str
    time_step: float
    count: int
    value: Estimate
    variance: float
    contacts: float
    decay: float
    shortest: float
    bounds: tuple[float, float]


def flux_of(point: Point, blocks: int) -> Flow:
    """Measure the heat flux between plates, averaged over both and over `blocks` blocks of the run.

    The slowest wave between them is the wave of the temperature, whose decay time is (gap / pi)^2 n c_p /
    kappa, c_p = 5/2 k_B, kappa Enskog's at the mean temperature.
    """
    scene, gap = point.scene, Gap.of(point.scene)
    flux = averages(point, gap, blocks, 1).flux()
    length = point.schedule.samples * point.schedule.sample_interval
    contacts = sum(int(np.diff(run.data["collisions"].values[[0, -1]])[0]) for run in runs(point))
    density = scene.count / (gap.length * gap.area)
    warm = 0.5 * (gap.hot + gap.cold)
    conductivity = float(theory.enskog_conductivity(scene.packing_fraction, 3, temperature=warm))
    decay = (gap.length / math.pi) ** 2 * 2.5 * density / conductivity
    return Flow(
        observable="heat_flux",
        packing_fraction=fraction_of(point),
        engine=engine_of(point),
        time_step=_step(point),
        count=point.scene.count,
        value=flux,
        variance=(flux.error / flux.value) ** 2 * length,
        contacts=contacts / length,
        decay=decay,
        shortest=decay,
        bounds=_bounds(point, "conductivity"),
    )


def relaxation_of(point: Point) -> Flow:
    """Return the time in which speeds, equal at first, become Maxwell's, over the mean free time.

    It is the integral of the kurtosis' part that is still to come, (K_end - K) / (K_end - 1), up to
    `FREE_TIMES`, of the mean over replicas. In a uniform gas steps and cells of the DSMC engine change
    nothing but positions, if all particles are in one cell.
    """
    values, contacts, rate = [], 0, float(theory.collision_rate(point.scene.packing_fraction, 3))
    for run in runs(point, first=0):
        speeds = np.sqrt((run.data["velocities"].values.astype(float) ** 2).sum(axis=2))
        end = theory.kurtosis(3, run.count)
        remainder = (end - kurtosis(speeds)) / (end - 1.0)
        free_times = (run.time - run.time[0]) * rate
        fine = np.linspace(0.0, FREE_TIMES, 1 + round(FREE_TIMES / 0.01))
        values.append(float(np.trapezoid(np.interp(fine, free_times, remainder), fine)))
        contacts += int(run.data["collisions"].values[-1])
    value = mean_of(values)
    length = FREE_TIMES / rate
    model, steps = _bounds(point, "diffusion")
    return Flow(
        observable="relaxation",
        packing_fraction=fraction_of(point),
        engine=engine_of(point),
        time_step=_step(point),
        count=point.scene.count,
        value=value,
        variance=(value.error / value.value) ** 2 * len(values) * length,
        contacts=contacts / (len(values) * (run.time[-1] - run.time[0])),
        decay=0.0,
        shortest=length,
        bounds=(model, steps if engine_of(point) == "step" else 0.0),
    )


def fraction_of(point: Point) -> float:
    """Compute the packing fraction, to two digits."""
    return float(f"{point.scene.packing_fraction:.2g}")


def engine_of(point: Point) -> str:
    """Return the engine of a point, one of `choices.ENGINES`."""
    return point.engine.name if point.engine.equation == "exact" else point.engine.equation


def _step(point: Point) -> float:
    """Compute the length of a step, 0 of the event-driven engine."""
    return point.engine.for_scene(point.scene, point.schedule.sample_interval).quantum or 0.0


def _bounds(point: Point, coefficient: str) -> tuple[float, float]:
    """Return theory's bounds on the errors of model and discretisation; infinite without one.

    Time steps lose 2/3 (v_th dt / sigma)^2 of the contacts of a dilute gas, and no more of what these pass
    on; of a dense gas no theory states their error. Cells and steps of the DSMC engine change a transport
    coefficient, `coefficient`, and the flux by that at most.
    """
    scene, name = point.scene, engine_of(point)
    if name == "event":
        return 0.0, 0.0
    kinetics = rates(scene, dense=True)
    if name == "step":
        speed = kinetics.speed / math.sqrt(8.0 / math.pi)
        lost = 2.0 / 3.0 * (speed * _step(point) / (2.0 * scene.largest_radius)) ** 2
        return 0.0, lost if scene.packing_fraction <= 0.01 * 1.05 else math.inf
    engine = point.engine.for_scene(scene, point.schedule.sample_interval)
    cells = asdict(engine)["cells_per_side"]
    width = max(
        (length / n for length, n in zip(scene.container.lengths, cells, strict=True) if n > 1), default=0.0
    )
    step = _step(point) * kinetics.speed / math.sqrt(8.0 / math.pi) * math.sqrt(2.0)
    grown = cell_factor(coefficient, width / kinetics.path) * step_factor(coefficient, step / kinetics.path)
    bound = boltzmann_error if name == "boltzmann" else enskog_error
    even = even_conditions(scene, 1.0)
    model = bound(AccuracyRequest("D", 1.0, even, transported=True, memory=even.memory))
    return model, float(grown) - 1.0


def choices(flows: Sequence[Flow], count: int, speeds: Mapping[str, Estimate]) -> Iterator[Choice]:
    """Yield the choices for the engines that have measured one observable of one gas.

    count : number of particles that costs are for.
    speeds : CPU time per time of simulation by engine, of the runs' particles.
    """
    event = next(flow for flow in flows if flow.engine == "event")
    # One equation governs what fluctuates, so that all runs together tell its variance.
    pooled = float(np.mean([flow.variance for flow in flows]))
    for flow in flows:
        if flow.engine not in speeds:
            continue
        seconds = speeds[flow.engine].value
        scaled = seconds * count / flow.count
        model, discretisation = errors_of(flow, event)
        yield Choice(
            engine=flow.engine,
            model=model,
            discretisation=discretisation,
            finite_size=0.0,
            unit=pooled * seconds,
            least=flow.shortest * scaled,
            equilibration=SETTLED * flow.decay * scaled,
            decay=flow.decay * scaled,
            trace=1.0,
            uncertainty=speeds[flow.engine].error / seconds,
        )


def errors_of(flow: Flow, event: Flow) -> tuple[float, float]:
    """Return bounds on the errors of model and discretisation.

    They are theory's bounds, or less if the runs differ by less in all.
    """
    if flow.engine == "event":
        return 0.0, 0.0
    ratio = flow.value / event.value
    seen = abs(ratio.value - 1.0) + BOUND * ratio.error
    if flow.engine == "step":
        return 0.0, min(flow.bounds[1], seen)
    discretisation = min(flow.bounds[1], seen)
    return min(flow.bounds[0], seen - discretisation), discretisation
