"""Grains under gravity: piles that come to rest, discharge through an orifice, and vibrated beds.

Units of piles and flows: the discs' mean diameter d, their mass and the strength g of gravity.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import Fit, combine, fit_curve, fit_polynomial, mean_of, means_of
from gaspart.keys import count, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, entries, from_rows, table
from gaspart.scene.faces import Vibrating
from gaspart.scene.scene import Scene
from gaspart.theory.granular import DISCHARGE_EXPONENT

TITLE, CHAPTER = "Settling, discharge and vibrated beds", "Granular matter"
SETTLING = {
    "gap": positive("two discs with a smaller gap, in mean diameters, are in contact"),
    "start": positive("share of the discs in the hopper from which on the flow is measured", maximum=1),
    "head": positive("height of the filling down to which it is measured, in widths of the orifice"),
}
BED = {
    "bins": count("bins of the density profile", least=4),
    "highest": positive("height up to which the profile reaches, over T/g"),
}
FILLED = 0.84  # packing fraction of randomly packed discs of two sizes (random close packing)
FLOOR = 2  # index of the face y_low
WAVEFORMS = {0: "sawtooth", 1: "sine"}


def measure_settling(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure piles (points without interior walls), and flows through the orifice between two walls."""
    hoppers = [point for point in points if point.scene.walls]
    floors = [point for point in points if not point.scene.walls]
    piles = [_pile(run, settings["gap"]) for point in floors for run in runs(point, first=0)]
    flows = _flows([Flow(point, settings) for point in hoppers])
    return from_rows("pile", piles, ("frame",)).merge(flows, join="outer", compat="no_conflicts")


def _units(scene: Scene, radii: np.ndarray) -> tuple[float, float, float]:
    """Return mean diameter, strength of gravity and unit of time."""
    diameter, strength = float(2.0 * radii.mean()), math.hypot(*(scene.gravity or ()))
    return diameter, strength, math.sqrt(diameter / strength)


def _pile(run: Run, gap: float) -> dict:
    """Measure kinetic energy and contacts against time, and what is left in the end; gravity is along -y."""
    scene, time, positions, mass = run.scene, run.time, run.positions, run.scene.species[0].mass
    radii = run.data["radius"].values.astype(float)  # in single precision, like the positions
    diameter, strength, unit = _units(scene, radii)
    kinetic = 0.5 * mass * (run.velocities**2).sum(axis=(1, 2))
    energy = kinetic - mass * positions.sum(axis=1) @ np.array(scene.gravity)
    still = np.flatnonzero(kinetic > 0.0)[-1] + 1  # the first of the frames at rest until the end
    contacts = np.array([count_contacts(scene, frame, radii, gap * diameter) for frame in positions])
    return {
        "time": time / unit,
        "kinetic": kinetic / (len(radii) * mass * strength * diameter),
        "contacts": contacts / len(radii),
        "duration": scene.contact_duration / unit,
        "rest": time[still] / unit if still < len(time) else math.nan,
        "final_contacts": contacts[-1] / len(radii),
        "residual": kinetic[-1] / (len(radii) * _lasting(scene, positions[-1])),
        "displacement": np.abs(positions[still:] - positions[-1]).max(initial=0.0) / diameter,
        "rise": max(np.diff(energy).max(), 0.0) / energy[0],
    }


def _lasting(scene: Scene, positions: np.ndarray) -> float:
    """Compute the mean kinetic energy of discs with speed g h t_c at depth h, t_c the duration of a contact.
    Neighbours with gap s and relative speed v collide after s / v. For their force m v^2 / s to carry the
    weight of h discs, s / v = v / (g h). Slower discs collide again within t_c, and lose no energy.
    """
    height = 2.0 * positions[:, 1].mean()
    speed = math.hypot(*(scene.gravity or ())) * height * scene.contact_duration
    return scene.species[0].mass * speed**2 / 6.0


def count_contacts(scene: Scene, positions: np.ndarray, radii: np.ndarray, gap: float) -> int:
    """Count the contacts between discs, and of discs with faces: surfaces with a smaller gap than `gap`."""
    apart = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1)) - radii[:, None] - radii
    low, high = positions - radii[:, None], positions + radii[:, None] - np.array(scene.container.lengths)
    return int((apart[np.triu_indices(len(radii), 1)] < gap).sum() + (low < gap).sum() + (high > -gap).sum())


class Flow:
    """Flow through one orifice: rates (R,), and ratios of the first half's rate to the second's (R,).
    `liquid` is this ratio for a liquid, whose rate is as the square root of its height; `remaining`, the
    discs above the orifice in the first replica; `count`, the number of discs whose passage is timed.
    """

    def __init__(self, point: Point, settings: dict) -> None:
        scene = point.scene
        _, left_end, right_end, _ = sorted(end for wall in scene.walls for end in wall.corners.values())
        height, width = left_end[1], right_end[0] - left_end[0]
        intervals, seen = [], []
        for run in runs(point, first=0):
            radii = run.data["radius"].values.astype(float)
            remaining = (run.data["coordinates"].values[..., 1] > height).sum(axis=1)
            first = settings["start"] * len(radii)
            filled = FILLED * scene.container.lengths[0]  # area of discs per unit of height
            last = settings["head"] * width * filled / (math.pi * (radii**2).mean())
            levels = np.array([first, 0.5 * (first + last), last])
            if not remaining[-1] < last < first:
                raise ValueError(
                    f"duration: {remaining[-1]} discs are left in the hopper of {point.path} (must be below "
                    f"{last:.0f}, and that below {first:.0f})"
                )
            intervals.append(np.diff(np.interp(-levels, -remaining, run.time)))
            seen.append((run.time, remaining))
        diameter, _, unit = _units(scene, radii)
        early, late = np.array(intervals).T
        heads = 0.5 * (levels[:-1] + levels[1:])
        self.width, self.count = width / diameter, first - last
        self.rates, self.ratios = (first - last) / (early + late) * unit, late / early
        self.liquid = math.sqrt(heads[0] / heads[1])
        self.time, self.remaining = seen[0][0] / unit, seen[0][1]


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
    return dataset.assign(fit_discharge(dataset["width"].values, rates))


def _mean_logarithms(flows: list[Flow], replicas: list[np.ndarray]) -> Estimate:
    """Average the logarithms of the values (R,) of each flow. Their variance is as 1 / (number of discs),
    with one factor for all orifices, from all replicas.
    """
    logarithms = [np.log(values) for values in replicas]
    freedom = sum(len(values) - 1 for values in logarithms)
    scatter = sum(
        flow.count * ((values - values.mean()) ** 2).sum()
        for flow, values in zip(flows, logarithms, strict=True)
    )
    discs = np.array([flow.count * len(flow.rates) for flow in flows])
    return Estimate([values.mean() for values in logarithms], np.sqrt(scatter / freedom / discs), freedom)


def _exponential(logarithm: Estimate) -> Estimate:
    value = math.exp(logarithm.value)
    return Estimate(value, value * logarithm.error, logarithm.freedom)


def fit_discharge(width: np.ndarray, rate: Estimate) -> dict[str, float]:
    """Fit ln rate = ln(amplitude (width - offset)^exponent), with any exponent and with Beverloo's."""

    def law(width: np.ndarray, amplitude: float, offset: float, exponent: float) -> np.ndarray:
        return np.log(amplitude) + exponent * np.log(width - offset)

    amplitude = math.exp(rate.value[-1]) / width[-1] ** DISCHARGE_EXPONENT
    start = (amplitude, 0.5 * width.min(), DISCHARGE_EXPONENT)
    bounds = ((0.0, 0.0, 0.0), (np.inf, 0.95 * width.min(), 2.0 * DISCHARGE_EXPONENT))
    fixed, _ = fit_curve(
        lambda width, amplitude, offset: law(width, amplitude, offset, DISCHARGE_EXPONENT),
        width, rate, start[:2], (bounds[0][:2], bounds[1][:2]),
    )  # fmt: skip
    free, covariance = fit_curve(law, width, rate, start, bounds)
    deviations = (rate.value - law(width, fixed[0], fixed[1], DISCHARGE_EXPONENT)) / rate.error
    fitted = zip(free, np.sqrt(np.diag(covariance)), strict=True)
    return entries(dict(zip(("amplitude", "offset", "exponent"), fitted, strict=True))) | {
        "exponent_freedom": rate.freedom[0],
        "beverloo_amplitude": fixed[0],
        "beverloo_offset": fixed[1],
        "chi_square": (deviations**2).sum(),
    }


def measure_beds(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure temperature, energy flows over the weight, height and density of beds of discs of mass 1."""
    units = {"temperature": "energy", **dict.fromkeys(("speed", "given", "lost"), "length / time")}
    beds = table("bed", points, _bed, settings, inner=("bin",), units=units)
    return beds.assign_coords(place=("bin", _grid(settings).middles[0]))


def _grid(settings: dict) -> Grid:
    return Grid.line(0.0, settings["highest"], settings["bins"])


def _bed(point: Point, settings: dict) -> dict[str, Any]:
    scene = point.scene
    floor, species, law = scene.faces["y_low"], scene.species[0], scene.restitution
    assert isinstance(floor, Vibrating) and law is not None and scene.gravity is not None
    width, sine = scene.container.lengths[0], floor.waveform == "sine"
    row: dict[str, Any] = {
        "sine": int(sine),
        "restitution": law.normal,
        "layers": (species.count - 1) * 2.0 * species.radius / width,
        "speed": floor.greatest_speed / math.sqrt(2.0) if sine else floor.greatest_speed,  # rms of a sine
    }
    replicas = [bed_means(run, settings) for run in runs(point)]
    for name in replicas[0]:
        row[name] = Estimate(*means_of([replica[name] for replica in replicas]), len(replicas) - 1)
    weight = species.count * -scene.gravity[1] / width
    row["packing_fraction"] = math.pi * species.radius**2 * weight / row["temperature"].value  # at the floor
    return row


def bed_means(run: Run, settings: dict) -> dict[str, Any]:
    """Measure the numbers of a run; the mean height is over the vertical temperature."""
    scene = run.scene
    assert scene.gravity is not None
    gravity, heights = -scene.gravity[1], run.positions[..., 1] - scene.species[0].radius
    across, along = (run.velocities**2).mean(axis=(0, 1))
    temperature, weight, grid = 0.5 * (across + along), scene.count * gravity, _grid(settings)
    counts = grid.sums(grid.cells((heights * gravity / temperature)[..., None]))
    return {
        "temperature": temperature,
        "given": -run.growth("wall_energy")[FLOOR] / weight,
        "lost": run.growth("dissipated_energy") / weight,
        "height": heights.mean() * gravity / along,
        "density": counts / (heights.size * grid.volume),
    }


BEVERLOO = "[Beverloo 1961], in two dimensions: free fall from an arch as wide as the orifice"
BALANCE = (
    "energy balance of an isothermal, nearly elastic bed, to first order in the density "
    "(gaspart.theory.granular), losses at the floor included; the form is that of [Kumaran 1998] and of "
    "[McNamara 1998]"
)


def claim_settling(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on rest and contacts of piles, and on the law of discharge."""
    piles, flows = Table(dataset, "pile"), Table(dataset, "orifice")
    yield Claim.at_most(
        "kinetic energy of a pile in the end over m (g h t_c)^2 / 2, that of contacts that last",
        Estimate(piles.residual.max()), 1.0, 0.0,
        "contacts dissipate until each follows the last one within t_c (estimate, row of discs)",
        "contacts that last give energy, or keep more of it than they must",
    )  # fmt: skip
    yield Claim.at_most(
        "largest displacement of a disc after rest, in diameters",
        Estimate(piles.displacement.max()), 0.0, 0.0,
        "rest is rest (by construction)", "a pile at rest moves again", kind="identity",
    )  # fmt: skip
    yield Claim.at_most(
        "largest rise of the energy of a pile between two frames, over its initial energy",
        Estimate(piles.rise.max()), 1e-6, 0.0,
        "contacts never give energy; the frames have seven digits",
        "contacts that last, or rest, give energy",
    )  # fmt: skip
    for duration, alike in piles.by("duration"):
        yield Claim.within(
            f"contacts of a disc of a pile at rest, those with walls too, t_c = {duration:g}",
            mean_of(alike.final_contacts), 2.0, 0.1,
            "Maxwell's count: two forces on each smooth disc vanish, and discs of unequal sizes "
            "have no more contacts than these equations need",
            "discs that are held by less than equilibrium needs, or rest that depends on t_c; a "
            "triangular lattice would have 3",
        )  # fmt: skip
    yield Claim(
        "exponent of the rate of flow against the width of the orifice less k diameters, k fitted",
        flows.exponent, DISCHARGE_EXPONENT, 0.25, BEVERLOO,
        "a flow whose speed does not depend on the width, as that of a liquid", alternative=1.0,
    )  # fmt: skip
    ratio = flows.head_ratio  # all errors are from one scatter, whose degrees of freedom their mean has
    mean = combine(np.log(ratio.value), ratio.error / ratio.value)
    liquid = float(np.log(flows.liquid_ratio).mean())
    yield Claim.at_most(
        "ln of the rate of flow in the first half over that in the second, over a liquid's",
        Estimate(mean.value, mean.error, ratio.freedom[0]) / liquid, 0.5, 0.15,
        "walls carry most of what lies above, as in an hourglass (Beverloo et al.), less so in "
        "a filling that is not high; 1 of a liquid, which has the square root of its height",
        "a flow that is driven by the weight of what lies above, as that of a liquid",
    )  # fmt: skip
    if (freedom := len(flows) - 2) > 0:
        yield Claim.chi_square(
            claim="deviations from Beverloo's law, exponent 3/2 (chi-square per degree of freedom)",
            chi_square=flows.chi_square, degrees_of_freedom=freedom, error_freedom=flows.exponent.freedom,
            source=BEVERLOO, fails_if="another law",
        )  # fmt: skip


def small_parameter(beds: Table) -> np.ndarray:
    """Compute the power that each bed would lose, over its weight and sqrt(T)."""
    return np.asarray(theory.bed_loss(beds.layers, beds.restitution, beds.packing_fraction))


def expected_temperature(beds: Table) -> np.ndarray:
    """Compute the temperature of each bed in the limit of small `small_parameter`."""
    of = beds.layers, beds.restitution, beds.packing_fraction
    sawtooth, sine = theory.sawtooth_temperature(*of), theory.sine_temperature(*of)
    return np.where(beds.sine == 1, sine, sawtooth) * beds.speed**2


def extrapolation(beds: Table) -> Fit:
    """Fit measured over theoretical temperature by a parabola in `small_parameter`."""
    ratio = beds.temperature / expected_temperature(beds)
    return fit_polynomial(small_parameter(beds), ratio, powers=(0, 1, 2))


def claim_beds(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims on energy balance, temperature and height: the floor gives what collisions lose."""
    for name, beds in _by_waveform(dataset):
        if len(beds) > 2:
            yield Claim(
                f"temperature over that of theory in the limit of elastic discs, {name}",
                extrapolation(beds).estimate(0), 1.0, 0.03, BALANCE,
                "a floor that gives another energy, contacts that lose another, or a law of "
                "another power of the speed or of the number of layers",
            )  # fmt: skip
        for bed in beds:
            yield from _claims_of_bed(bed, name)


def _by_waveform(dataset: xr.Dataset) -> Iterator[tuple[str, Table]]:
    for kind, beds in Table(dataset, "bed").by("sine"):
        yield WAVEFORMS[kind], beds


def _claims_of_bed(bed: Row, name: str) -> Iterator[Claim]:
    which = f"{name}, restitution {bed.restitution:g}"
    yield Claim(
        f"energy lost in contacts over that which the floor gives, {which}",
        bed.lost / bed.given.value, 1.0, 0.01,
        "conservation of energy in a steady state (the difference is what the bed stores)",
        "a bed that still cools or warms, or work that is not counted", kind="identity",
    )  # fmt: skip
    yield Claim(
        f"mean height times weight over the vertical temperature, {which}",
        bed.height, float(theory.bed_height(bed.packing_fraction)), 0.01,
        "the virial of a gas under gravity, to first order in its density",
        "falls or bounces that are not those of mechanics, discs of another size",
    )  # fmt: skip
    if name == "sawtooth":
        yield Claim(
            f"energy given over weight and speed of the floor, {which}", bed.given / bed.speed, 1.0, 0.01,
            "exact: a floor that always moves at one speed gives it times the force, the weight",
            "bounces in which the floor has another speed, or is missed", kind="identity",
        )  # fmt: skip


def draw_settling(dataset: xr.Dataset) -> Figure:
    """Draw energy and contacts of piles, discs that remain in the hopper, and rates of flow."""
    figure, axes = style.new((2.4,), (2.4,), (2.4,), (2.4,))
    flows, time = Table(dataset, "orifice"), r"time $t\,\sqrt{g/d}$"
    _piles(axes[0], axes[1], Table(dataset, "pile"), time)
    for kind, flow in enumerate(flows):
        label = rf"$D={flow.width:.3g}\,d$"
        axes[2].plot(flow.flow_time, flow.left, color=style.COLOURS[kind], label=label)
    style.label_axes(
        axes[2], time, "discs left in the hopper", "upper right",
        xlim=(0.0, np.nanmax(flows.flow_time)), ylim=(0.0, 1.15 * np.nanmax(flows.left)),
    )  # fmt: skip
    offset = flows.beverloo_offset  # Beverloo's law is a straight line in the width less the offset
    apart = flows.width - offset
    line = np.array([0.85 * apart.min(), 1.15 * apart.max()])
    law = flows.beverloo_amplitude * line**DISCHARGE_EXPONENT
    axes[3].plot(line, law, color=style.REFERENCE, zorder=1, label="slope 3/2 (Beverloo)")
    style.points(axes[3], apart, flows.rate, color=style.DATA, label="measured")
    axes[3].set(xscale="log", yscale="log")
    x = rf"$D/d-k$, $k={offset:.2f}$"
    style.label_axes(axes[3], x, r"rate of flow / $\sqrt{g/d}$", "upper left")
    style.letters(*axes)
    return figure


def _piles(energies: Axes, contacts: Axes, piles: Table, time: str) -> None:
    """Draw the first pile of each contact duration; a cross marks the time of rest."""
    style.level(contacts, 2.0)
    for kind, (duration, alike) in enumerate(piles.by("duration")):
        pile, colour = alike[0], style.COLOURS[kind]
        moving = pile.kinetic > 0.0
        at, kinetic = pile.time[moving], pile.kinetic[moving]
        energies.plot(at, kinetic, color=colour, label=rf"$t_c={duration:g}$")
        if np.isfinite(pile.rest):
            energies.plot(at[-1:], kinetic[-1:], color=colour, marker="x")
        contacts.plot(pile.time, pile.contacts, color=colour)
    energies.set_yscale("log")
    limits = 0.0, np.nanmax(piles.time)
    style.label_axes(energies, time, "kinetic energy per disc ($mgd$)", "upper right", xlim=limits)
    style.label_axes(contacts, time, "contacts per disc", xlim=limits, ylim=(0.0, 2.4))


def draw_beds(dataset: xr.Dataset) -> Figure:
    """Draw temperature over theory with fits, and the density of the most elastic beds."""
    figure, (upper, lower) = style.new((2.4,), (2.4,))
    table = Table(dataset, "bed")
    style.level(upper, 1.0)
    heights = np.linspace(0.0, table.place.max(), 100)
    lower.plot(heights, np.exp(-heights), color=style.REFERENCE, label=r"$e^{-gz/T}$")
    for name, beds in _by_waveform(dataset):
        x, kind = small_parameter(beds), int(beds.sine[0])
        style.points(upper, x, beds.temperature / expected_temperature(beds), kind=kind, label=name)
        if x.size > 2:
            fine = np.linspace(0.0, x.max(), 100)
            curve = np.polynomial.polynomial.polyval(fine, extrapolation(beds).values)
            upper.plot(fine, curve, color=style.COLOURS[kind], zorder=1)
        bed = beds[np.argmin(x)]
        label = rf"{name}, $\epsilon={bed.restitution:g}$"
        style.points(lower, bed.place, bed.density, kind=kind, label=label)
    upper.set_xlim(0.0, 1.08 * small_parameter(table).max())
    small = r"$(1-\epsilon^2)(\sqrt{\pi}\,(N-1)d/2W+1/\sqrt{2\pi})$"
    style.label_axes(upper, small, r"$T$ / $T$ of energy balance", "best")
    lower.set_yscale("log")
    style.label_axes(lower, r"height $gz/T$", r"density / $(Ng/WT)$", "best")
    style.letters(upper, lower)
    return figure


FIGURES = {
    "settling": Parts(SETTLING, measure_settling, claim_settling, draw_settling, key=3),
    "vibrated_bed": Parts(BED, measure_beds, claim_beds, draw_beds, key=1),
}
