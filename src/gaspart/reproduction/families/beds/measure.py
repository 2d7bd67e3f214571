"""Measurements of piles at rest, discharge and vibrated beds.

Piles of discs that come to rest, and the flow of discs through an orifice.

Units of all results: the mean diameter d of the discs, their mass m and the strength g of gravity.

Steady beds of inelastic discs over a vibrating floor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import fit_curve, means_of
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import entries, from_rows, table
from gaspart.scene.faces import Vibrating
from gaspart.scene.scene import Scene
from gaspart.theory.granular import DISCHARGE_EXPONENT

_FILLED = 0.84  # packing fraction of randomly packed discs of two sizes (random close packing)


def settling(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure piles and flows through the orifice between two walls.

    Points without interior walls are piles; the other points are flows. The settings are `gap`, `start` and
    `head` (see FIGURES).

    Variables of the result:

    time, kinetic, contacts : time; kinetic energy and contacts (also with walls) per disc (`pile`, `frame`)
    duration : duration of contacts, over `pile`
    rest : time after which nothing moves, over `pile`; NaN if discs never come to rest
    final_contacts : contacts per disc at the end
    residual : kinetic energy at the end divided by `_lasting`
    displacement : largest displacement after `rest`; 0 without rest
    rise : largest rise of the energy between frames, divided by its initial value
    width, rate : width of the orifice, and flow rate with its error, over `orifice`
    head_ratio : flow rate of the first half of the discs divided by the rate of the second half
    liquid_ratio : `head_ratio` of a liquid
    left, flow_time : discs above the orifice, and time, over `orifice` and `flow_frame`

    The result also has the parameters of `_fit`.
    """
    hoppers = [point for point in points if point.scene.walls]
    floors = [point for point in points if not point.scene.walls]
    piles = [_pile(run, settings["gap"]) for point in floors for run in runs(point, first=0)]
    flows = [_flow(point, settings) for point in hoppers]
    return from_rows("pile", piles, ("frame",)).merge(_flows(flows), join="outer", compat="no_conflicts")


def _diameter(radii: np.ndarray) -> float:
    return float(2.0 * radii.mean())


def _pile(run: Run, gap: float) -> dict:
    """Measure one pile; see `settling`.

    Gravity is along -y.
    """
    scene, time, positions = run.scene, run.time, run.positions
    radii = run.data["radius"].values.astype(float)  # in single precision, like the positions
    diameter, strength = _diameter(radii), math.hypot(*(scene.gravity or ()))
    mass = scene.species[0].mass
    kinetic = 0.5 * mass * (run.velocities**2).sum(axis=(1, 2))
    energy = kinetic - mass * positions.sum(axis=1) @ np.array(scene.gravity)
    # the first frame at rest whose later frames are all at rest
    still = np.flatnonzero(kinetic > 0.0)[-1] + 1
    rests = still < len(time)
    contacts = np.array([count_contacts(scene, frame, radii, gap * diameter) for frame in positions])
    unit = math.sqrt(diameter / strength)
    return {
        "time": time / unit,
        "kinetic": kinetic / (len(radii) * mass * strength * diameter),
        "contacts": contacts / len(radii),
        "duration": scene.contact_duration / unit,
        "rest": time[still] / unit if rests else math.nan,
        "final_contacts": contacts[-1] / len(radii),
        "residual": kinetic[-1] / (len(radii) * _lasting(scene, positions[-1])),
        "displacement": np.abs(positions[still:] - positions[-1]).max(initial=0.0) / diameter,
        "rise": max(np.diff(energy).max(), 0.0) / energy[0],
    }


def _lasting(scene: Scene, positions: np.ndarray) -> float:
    """Compute the mean kinetic energy of discs with speed g h t_c at depth h.

    The depth is measured from the surface of the pile, and t_c is the duration of a contact. Two neighbours
    with gap s and relative speed v collide after the time s / v. At depth h a disc carries the weight of h
    discs. For the force m v^2 / s between neighbours to carry this weight, s / v = v / (g h). Slower discs
    collide again within t_c, and lose no energy.
    """
    height = 2.0 * positions[:, 1].mean()
    speed = math.hypot(*(scene.gravity or ())) * height * scene.contact_duration
    return scene.species[0].mass * speed**2 / 6.0


def count_contacts(scene: Scene, positions: np.ndarray, radii: np.ndarray, gap: float) -> int:
    """Count the contacts between discs, and between discs and faces.

    Two surfaces are in contact if their gap is below `gap`. Positions (N, 2), radii (N,) and gap are in the
    scene's units.
    """
    apart = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1)) - radii[:, None] - radii
    low, high = positions - radii[:, None], positions + radii[:, None] - np.array(scene.container.lengths)
    return int((apart[np.triu_indices(len(radii), 1)] < gap).sum() + (low < gap).sum() + (high > -gap).sum())


@dataclass(frozen=True)
class Flow:
    """Flow through one orifice, R replicas.

    width : width of the orifice.
    count : number of discs whose passage is timed.
    rates : (R,), rates of flow.
    ratios : (R,), rate in the first half of the discs divided by the rate in the second half.
    liquid : this ratio for a liquid, whose rate is proportional to the square root of its height.
    time, remaining : (frames,), times and number of discs above the orifice, in the first replica.
    """

    width: float
    count: float
    rates: np.ndarray
    ratios: np.ndarray
    liquid: float
    time: np.ndarray
    remaining: np.ndarray


def _flow(point: Point, settings: dict) -> Flow:
    """Measure the flow of a point.

    Raises ValueError if too few discs leave the hopper.
    """
    scene = point.scene
    _, left_end, right_end, _ = sorted(end for wall in scene.walls for end in wall.corners.values())
    height, width = left_end[1], right_end[0] - left_end[0]
    filled = _FILLED * scene.container.lengths[0]  # area of discs per unit of height
    intervals, seen = [], []
    for run in runs(point, first=0):
        time, radii = run.time, run.data["radius"].values.astype(float)
        remaining = (run.data["coordinates"].values[..., 1] > height).sum(axis=1)
        first = settings["start"] * len(radii)
        last = settings["head"] * width * filled / (math.pi * (radii**2).mean())
        levels = np.array([first, 0.5 * (first + last), last])
        if not remaining[-1] < last < first:
            raise ValueError(
                f"duration: {remaining[-1]} discs are left in the hopper of {point.path} (must be below "
                f"{last:.0f}, and that below {first:.0f})"
            )
        intervals.append(np.diff(np.interp(-levels, -remaining, time)))
        seen.append((time, remaining))
    diameter, strength = _diameter(radii), math.hypot(*(scene.gravity or ()))
    unit = math.sqrt(diameter / strength)
    early, late = np.array(intervals).T
    heads = 0.5 * (levels[:-1] + levels[1:])
    return Flow(
        width=width / diameter,
        count=first - last,
        rates=(first - last) / (early + late) * unit,
        ratios=late / early,
        liquid=math.sqrt(heads[0] / heads[1]),
        time=seen[0][0] / unit,
        remaining=seen[0][1],
    )


def _flows(flows: list[Flow]) -> xr.Dataset:
    """Return the variables over `orifice`, the narrowest first, and the results of the fits."""
    flows = sorted(flows, key=lambda flow: flow.width)
    rates = _mean_logarithms(flows, [flow.rates for flow in flows])
    ratios = _mean_logarithms(flows, [flow.ratios for flow in flows])
    rows = [
        {
            "width": flow.width,
            "rate": _exponential(rate),
            "head_ratio": _exponential(ratio),
            "liquid_ratio": flow.liquid,
            "flow_time": flow.time,
            "left": flow.remaining.astype(float),
        }
        for flow, rate, ratio in zip(flows, rates, ratios, strict=True)
    ]
    dataset = table("orifice", rows, dict, inner=("flow_frame",))
    dataset["width"].attrs["units"], dataset["rate"].attrs["units"] = "diameters", "sqrt(g / d)"
    return dataset.assign(_fit(dataset["width"].values, rates))


def _mean_logarithms(flows: list[Flow], replicas: list[np.ndarray]) -> Estimate:
    """Average the logarithms of the values (R,) of each flow; return (orifices,).

    The variance of a logarithm is assumed to be inversely proportional to the number of discs. All orifices
    have the same constant of proportionality. It is measured from all replicas.
    """
    logarithms = [np.log(values) for values in replicas]
    freedom = sum(len(values) - 1 for values in logarithms)
    scatter = sum(
        flow.count * ((values - values.mean()) ** 2).sum()
        for flow, values in zip(flows, logarithms, strict=True)
    )
    discs = np.array([flow.count * len(flow.rates) for flow in flows])
    means = [values.mean() for values in logarithms]
    return Estimate(means, np.sqrt(scatter / freedom / discs), freedom)


def _exponential(logarithm: Estimate) -> Estimate:
    value = math.exp(logarithm.value)
    return Estimate(value, value * logarithm.error, logarithm.freedom)


def _fit(width: np.ndarray, rate: Estimate) -> dict[str, tuple]:
    """Fit rate = amplitude (width - offset)^exponent, and return the variables.

    In a first fit the exponent is free. In a second fit it has the value of Beverloo's law
    (`beverloo_amplitude`, `beverloo_offset` and `chi_square`). `width` has the shape (orifices,); `rate`
    (orifices,) are logarithms. The offset is not negative.
    """

    def law(
        width: np.ndarray, amplitude: float, offset: float, exponent: float = DISCHARGE_EXPONENT
    ) -> np.ndarray:
        return np.log(amplitude) + exponent * np.log(width - offset)

    amplitude = math.exp(rate.value[-1]) / width[-1] ** DISCHARGE_EXPONENT
    start = (amplitude, 0.5 * width.min(), DISCHARGE_EXPONENT)
    bounds = ((0.0, 0.0, 0.0), (np.inf, 0.95 * width.min(), 2.0 * DISCHARGE_EXPONENT))
    fixed, _ = fit_curve(
        lambda width, amplitude, offset: law(width, amplitude, offset),
        width, rate, start[:2], (bounds[0][:2], bounds[1][:2]),
    )  # fmt: skip
    free, covariance = fit_curve(law, width, rate, start, bounds)
    deviations = (rate.value - law(width, *fixed)) / rate.error
    fitted = zip(free, np.sqrt(np.diag(covariance)), strict=True)
    variables = entries(dict(zip(("amplitude", "offset", "exponent"), fitted, strict=True)))
    variables |= {
        "exponent_freedom": rate.freedom[0],
        "beverloo_amplitude": fixed[0],
        "beverloo_offset": fixed[1],
        "chi_square": (deviations**2).sum(),
    }
    return {name: ((), value) for name, value in variables.items()}


_FLOOR = 2  # index of the face y_low


def vibrated_bed(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure temperature, energy flows and density of vibrated beds of one kind of discs.

    The discs have mass 1. The settings are `bins` of the density profile, and `highest`, the height of the
    profile in units of T/g.

    Variables over `bed`, with errors from replicas:

    sine : 1 if the floor moves as a sine, 0 for a sawtooth
    restitution : coefficient of restitution
    layers : (N - 1) d / width
    packing_fraction : packing fraction at the floor of an ideal gas with the measured temperature
    speed : speed of the sawtooth, or rms speed of the sine
    temperature : temperature, averaged over both components
    given, lost : power supplied by the floor, and power lost in collisions, divided by the weight
    height : mean height above the floor's lowest position, times g, divided by the vertical temperature
    density : fraction of discs per bin width, in units of T/g, over (bed, bin), at `place`
    """
    units = {"temperature": "energy", **dict.fromkeys(("speed", "given", "lost"), "length / time")}
    beds = table("bed", points, _measure_bed, settings, inner=("bin",), units=units)
    return beds.assign_coords(place=("bin", _grid(settings).middles[0]))


def _grid(settings: dict) -> Grid:
    return Grid.line(0.0, settings["highest"], settings["bins"])


def _measure_bed(point: Point, settings: dict) -> dict[str, Any]:
    scene = point.scene
    floor, species, law = scene.faces["y_low"], scene.species[0], scene.restitution
    assert isinstance(floor, Vibrating) and law is not None and scene.gravity is not None
    width, sine = scene.container.lengths[0], floor.waveform == "sine"
    row: dict[str, Any] = {
        "sine": int(sine),
        "restitution": law.normal,
        "layers": (species.count - 1) * 2.0 * species.radius / width,
        "speed": floor.greatest_speed / math.sqrt(2.0) if sine else floor.greatest_speed,
    }
    replicas = [means(run, settings) for run in runs(point)]
    for name in replicas[0]:
        row[name] = Estimate(*means_of([replica[name] for replica in replicas]), len(replicas) - 1)
    weight = species.count * -scene.gravity[1] / width
    row["packing_fraction"] = math.pi * species.radius**2 * weight / row["temperature"].value
    return row


def means(run: Run, settings: dict) -> dict[str, Any]:
    """Measure the numbers of a run, by the names of `vibrated_bed`."""
    scene = run.scene
    assert scene.gravity is not None
    gravity = -scene.gravity[1]
    heights = run.positions[..., 1] - scene.species[0].radius
    across, along = (run.velocities**2).mean(axis=(0, 1))
    temperature = 0.5 * (across + along)
    weight = scene.count * gravity
    grid = _grid(settings)
    counts = grid.sums(grid.cells((heights * gravity / temperature)[..., None]))
    return {
        "temperature": temperature,
        "given": -run.growth("wall_energy")[_FLOOR] / weight,
        "lost": run.growth("dissipated_energy") / weight,
        "height": heights.mean() * gravity / along,
        "density": counts / (heights.size * grid.volume),
    }
