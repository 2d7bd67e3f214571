"""Cost of one gas against the number of boxes, time-stepped and event-driven.

Source A's remarks on the cost of a step are tested by alternate timings with and without a modification:
boxes out of reach are left out, or a huge sphere is added.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis import statistics
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import means_of
from gaspart.keys import COUNT, list_of, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.figures._timings import (
    OTHER_MACHINE,
    SOURCE_A,
    SOURCE_C,
    ideal,
    log_ratios,
    penalty,
    per_event,
    per_particle,
    ratio_of_jobs,
)
from gaspart.reproduction.figures.naive_scaling import SOURCE_COLOUR
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, entries, merge_with_prefixes, table
from gaspart.scene.sizes import ball_volume

TITLE, CHAPTER = "Gain from space partitioning", "Speed and accuracy"
SETTINGS = {
    "round_per_side": list_of(COUNT, "boxes per side that source A found quicker for their round width"),
    "source_boxes_per_particle": positive("the ideal number of boxes per particle in source A's figure 6"),
}

# Theory of a dilute gas between walls, whose cubic (square) container of side L has n boxes per side. A
# particle belongs to the box that contains its centre. Each pair of particles in the same box or in
# neighbouring boxes is tested once. Centres are uniform in [r, L - r] and no two centres are closer than a
# diameter; otherwise they are independent. For such centres all formulas are exact to first order in the
# density, that is for packing fractions below about 0.05.


def _moments(per_side: int, side: float, radius: float) -> np.ndarray:
    """Return three means along an axis over the position of a particle. They are of the number of boxes in
    its neighbourhood, and of the probability that another particle is in the neighbourhood, and its square.
    """
    edges = np.clip(np.linspace(0.0, side, per_side + 1), radius, side - radius)
    own = np.diff(edges) / (side - 2.0 * radius)
    near, boxes = (np.convolve(values, np.ones(3))[1:-1] for values in (own, np.ones(per_side)))
    return np.array([own @ boxes, own @ near, own @ near**2])


def expected_pair_tests(
    count: float, per_side: int, dimension: int, side: float, radius: float
) -> tuple[float, float]:
    """Compute the expected number of pair tests in a search, and its standard deviation."""
    _, share, square = _moments(per_side, side, radius) ** dimension
    excluded = ball_volume(dimension, 2.0 * radius) / (side - 2.0 * radius) ** dimension
    pairs = 0.5 * count * (count - 1.0)
    mean = pairs * (share - excluded) / (1.0 - excluded)
    variance = pairs * (share - share**2) + 2.0 * pairs * max(count - 2.0, 0.0) * (square - share**2)
    return mean, math.sqrt(max(variance, 0.0))


def neighbour_share(per_side: np.ndarray, dimension: int, side: float, radius: float) -> np.ndarray:
    """Compute the probability that two particles are in the same box or in neighbouring boxes."""
    return np.array([_moments(int(n), side, radius)[1] for n in per_side]) ** dimension


def expected_box_visits(per_side: int, dimension: int, side: float, radius: float) -> float:
    """Compute the mean number of boxes that a particle searches."""
    boxes, _, _ = _moments(per_side, side, radius) ** dimension
    return float(0.5 * (1.0 + boxes))


def boxes_in_reach(width: float | np.ndarray, reach: float, dimension: int) -> np.ndarray:
    """Compute the mean number of boxes within a distance of a random point (Steiner's formula)."""
    t = np.asarray(reach) / width
    if dimension == 2:
        return 1.0 + 4.0 * t + math.pi * t**2
    return 1.0 + 6.0 * t + 3.0 * math.pi * t**2 + 4.0 / 3.0 * math.pi * t**3


def share_of_contacts_in_a_box(width: float, diameter: float, dimension: int) -> float:
    """Compute the probability that two particles in contact are in the same box."""
    s = diameter / width
    if dimension == 2:
        return 1.0 - 4.0 * s / math.pi + s**2 / math.pi
    return 1.0 - 1.5 * s + 2.0 * s**2 / math.pi - s**3 / (4.0 * math.pi)


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the scan that includes one box, two fine scans, sectors of the events, and A's remarks. The
    container of one fine scan has round widths of boxes, that of the other does not.
    """
    near = [xr.load_dataset(point.path) for point in points if point.settings.get("near_boxes")]
    huge = [xr.load_dataset(point.path) for point in points if "scene" in point.settings]
    runs = [xr.load_dataset(point.path) for point in points if "without" not in point.settings]
    sectors = next(run for run in runs if run.engine == "event")
    stepped = [run for run in runs if run.engine == "step"]
    main = next(run for run in stepped if 1 in run.boxes)
    fine = sorted((run for run in stepped if 1 not in run.boxes), key=lambda run: run.side)
    costs, events = per_particle(main), per_event(sectors)
    pair = xr.concat([per_particle(run) for run in fine], "container", join="outer", compat="equals")
    sides, advantages = settings["round_per_side"], _advantages(pair, settings["round_per_side"])
    powers = [{"round_per_side": n, "advantage": own} for n, own in zip(sides, advantages, strict=True)]
    scans = [
        costs.assign(_expected(main)).rename(partition="scan"),
        merge_with_prefixes(fine=pair.rename(partition="fine"), sector=events.rename(partition="sector")),
        _near_boxes(near),
        table("power", powers, dict),
    ]
    number = settings["source_boxes_per_particle"]
    return xr.merge(scans, join="outer", compat="no_conflicts").assign(
        **ideal(costs, main.dimension),
        **_huge_sphere(huge),
        **_crossings(events, sectors),
        **entries({"source_penalty": penalty(costs, number)}),
        count=main.attrs["count"],
        radius=main.radius,
        source_boxes_per_particle=number,
        container_side=("container", [run.side for run in fine]),
    )


def _expected(run: xr.Dataset) -> dict:
    """Return the expected counts per particle of a scan. `touched` and `in_reach` are the boxes that a
    particle would search if boxes beyond a radius, or beyond a diameter, were left out; the latter cannot
    contain a partner.
    """
    gas, number = (run.dimension, run.side, run.radius), run.attrs["count"]
    sides = [int(n) for n in run.boxes_per_side.values]
    tests = np.array([expected_pair_tests(number, n, *gas) for n in sides]) / number
    radius, diameter = (
        0.5 + 0.5 * boxes_in_reach(run.side / np.array(sides), reach, run.dimension)
        for reach in (run.radius, 2.0 * run.radius)
    )
    columns = {
        "expected_tests": tests[:, 0],
        "tests_spread": tests[:, 1],
        "expected_visits": [expected_box_visits(n, *gas) for n in sides],
        "touched": radius,
        "in_reach": diameter,
    }
    return {name: ("partition", values) for name, values in columns.items()}


def _advantages(fine: xr.Dataset, round_per_side: list[int]) -> list[Estimate]:
    """Compute the advantage of partitions with round widths, as ln of a ratio of times. Each partition is
    compared with others whose number of boxes differs by less than an eighth, in the container with the
    shorter side (round widths). The same number in the other container is subtracted. Both scans have the
    same work, so effects independent of round widths cancel. The uncertainty is the scatter of the other
    partitions. Their times differ by up to one per cent between processes, which repeats in one process do
    not show.
    """
    n = fine.boxes_per_side.values[0]
    difference = np.log(fine.seconds.values[1]) - np.log(fine.seconds.values[0])
    others = [difference[(n != boxes) & (np.abs(n / boxes - 1.0) <= 0.125)] for boxes in round_per_side]
    freedom = sum(near.size - 1 for near in others)
    scatter = math.sqrt(sum(near.size * near.var() for near in others) / freedom)
    return [
        Estimate(difference[n == boxes][0] - near.mean(), scatter * math.sqrt(1.0 + 1.0 / near.size), freedom)
        for boxes, near in zip(round_per_side, others, strict=True)
    ]


def _crossings(events: xr.Dataset, run: xr.Dataset) -> dict[str, Any]:
    """Fit pair tests = discs in a neighbourhood x (a + b crossings), and crossings against planes. a and b
    are the neighbourhoods that are searched at an event and at a crossing between sectors.
    """
    scan = Table(events, "partition")
    others = (run.attrs["count"] - 1.0) * neighbour_share(
        scan.boxes_per_side, run.dimension, run.side, run.radius
    )
    searches = statistics.fit_polynomial(scan.crossings, scan.pair_tests / others)
    crossings = statistics.fit_power_law(scan.boxes_per_side - 1.0, scan.crossings)
    return entries({
        "event_searches": (searches.values[0], searches.errors[0]),
        "crossing_searches": (searches.values[1], searches.errors[1]),
        "crossing_exponent": (crossings.exponent, crossings.exponent_error),
    })  # fmt: skip


def _near_boxes(runs: list[xr.Dataset]) -> xr.Dataset:
    """Compare the search of boxes within contact range with a search of all neighbours. `own_first` is the
    fraction of searches that could end in the particle's own box, if this were searched first: boxes of the
    largest width, a contact (counted), and its partner in the box.
    """
    first, partitions = runs[0], runs[0].sizes["partition"] // 2
    sides = first.boxes_per_side.values[:partitions]
    width = first.side / sides
    costs = [per_particle(run) for run in runs]
    timed = np.array([cost.seconds.values for cost in costs])
    seconds, error = means_of(timed[:, :partitions])
    least = ratio_of_jobs(np.log(timed[:, :partitions].min(axis=1) / timed[:, partitions:].min(axis=1)))
    reached = boxes_in_reach(width, 2.0 * first.radius, first.dimension)
    contacts = np.array([run.collisions.values for run in runs])
    colliding = [2.0 * run.collisions.values[0] / (run.attrs["count"] * run.steps.values[0]) for run in runs]
    within = share_of_contacts_in_a_box(width.max(), 2.0 * first.radius, first.dimension)
    return xr.Dataset(
        {
            "near_boxes_per_side": ("near", sides),
            "near_seconds": ("near", seconds, {"units": "s"}),
            "near_seconds_error": ("near", error, {"units": "s"}),
            "near_box_visits": ("near", np.mean([c.box_visits.values[:partitions] for c in costs], axis=0)),
            "near_expected_visits": ("near", 0.5 + 0.5 * reached),
            "near_missed": int(np.ptp(contacts, axis=1).max()),
            **entries({"near_least": least, "own_first": means_of(np.array(colliding) * within)}),
        }
    )


def _huge_sphere(runs: list[xr.Dataset]) -> dict[str, Any]:
    """Compute the ratio of times, and the further pair tests, with a sphere too large for the boxes."""
    ratio = ratio_of_jobs([-log_ratios(run, run.steps.values)[0] for run in runs])
    tests = [np.diff(run.pair_tests.values / run.steps.values)[0] / run.attrs["count"] for run in runs]
    return entries({"huge_ratio": ratio, "huge_tests": means_of(tests)})


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims that an optimum exists, counts are expected, and round widths no faster."""
    scan = Table(dataset, "scan")
    least = scan.seconds[int(scan.seconds.value.argmin())]
    for name, at, bound in (("one box", 0, 10.0), ("the most boxes", -1, 1.5)):
        ratio = scan.seconds[at] / least
        yield Claim.at_least(
            f"there is an optimum: time with {name} over the least", ratio, bound, 0.25 * ratio.value,
            f"{SOURCE_A}, figure 4", "time rises or falls with the number of boxes throughout",
        )  # fmt: skip
    source = "uniform density, to first order in the density of the gas"
    nearest = scan[int(np.abs(scan.expected_tests - 1.0).argmin())]  # about one box per particle
    yield Claim(
        f"pair tests per particle and step, {nearest.boxes_per_side} boxes per side",
        Estimate(nearest.pair_tests, nearest.tests_spread), nearest.expected_tests, 0.05, source,
        "pairs are missed or tested twice, or the gas is not uniform",
    )  # fmt: skip
    visits = scan.box_visits / scan.expected_visits
    yield Claim.within(
        "box visits per particle over those expected, the scan's largest deviation",
        Estimate(visits[np.argmax(np.abs(visits - 1.0))], visits.std(ddof=1)), 1.0, 0.02, source,
        "boxes are omitted or searched twice",
    )  # fmt: skip
    # The minimum is flat: the cost at the source's number matters, not the exact position of the minimum.
    yield Claim.at_most(
        f"time with {scan.source_boxes_per_particle:g} boxes per particle over the least of all",
        scan.source_penalty, 1.05, 0.05, f"{SOURCE_A}, figure 6 at this number of particles",
        "the source's number is far from the flat minimum on this machine", kind="reproduction",
        source_error=OTHER_MACHINE,
    )  # fmt: skip
    for power in Table(dataset, "power"):
        yield Claim(
            f"ln of time saved by boxes of width {scan.container_side[0] / power.round_per_side:g} for being "
            "a power of two", power.advantage, 0.0, 0.02,
            f"arithmetic does not depend on it; {SOURCE_A}, section 3.4, states that it does",
            "boxes whose width is a power of two make a step faster",
        )  # fmt: skip
    yield from _claims_of_remarks(Table(dataset, "near"))
    yield Claim.within(
        "neighbourhoods searched at a crossing", scan.crossing_searches, 1.0 / 3.0, 0.05,
        f"{SOURCE_C}, section 4.4: of the nine adjacent sectors, three are new",
        "searches extend beyond the adjacent sectors, or miss some",
    )  # fmt: skip
    yield Claim.within(
        "exponent of the crossings per event in the number of planes between sectors",
        scan.crossing_exponent, 1.0, 0.05, "free flight through uniform density",
        "missed or spurious crossings",
    )  # fmt: skip


def _claims_of_remarks(near: Table) -> Iterator[Claim]:
    visits = near.near_box_visits / near.near_expected_visits
    yield Claim.within(
        "boxes searched within reach over those expected, the scan's largest deviation",
        Estimate(visits[np.abs(visits - 1.0).argmax()], visits.std(ddof=1)), 1.0, 0.03,
        "Steiner's formula, without the walls' 1 %",
        "boxes within reach are left out, or others are searched",
    )  # fmt: skip
    yield Claim(
        "largest difference of the contacts found with and without the boxes out of reach",
        Estimate(near.near_missed), 0.0, 0.0, "a box farther than a contact holds no partner",
        "a contact is missed", kind="identity",
    )  # fmt: skip
    yield Claim.at_most(
        "least time with only the boxes within reach over the least with all neighbouring ones",
        near.near_least, 1.0, 0.1,
        f"{SOURCE_A}, section 2.3: to search fewer boxes is a possible improvement",
        "leaving out boxes costs more than looking into them", kind="reproduction",
        source_error="a test of the distance to a box costs more than a look into it: most are empty",
    )  # fmt: skip
    yield Claim.at_most(
        "share of searches that can end in the own box if it is searched first, widest boxes",
        near.own_first, 0.01, 0.001,
        "a search ends early only at a contact, which few particles have in a step",
        "the order of the boxes matters for the cost",
    )  # fmt: skip
    yield Claim.within(
        "pairs tested more per particle and step with one huge sphere", near.huge_tests, 1.0, 0.01,
        f"{SOURCE_A}, section 4.2: each particle is tested against it",
        "it is kept in the boxes, which would have to be as wide as it is",
    )  # fmt: skip
    yield Claim.at_most(
        "time per step with one huge sphere among 10 000 over that without", near.huge_ratio, 1.05, 0.05,
        f"{SOURCE_A}, section 4.2: a negligible effect",
        "a further test per particle costs more than a twentieth of a step", kind="reproduction",
        source_error=OTHER_MACHINE,
    )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw time and work against the number of boxes, round widths, and sectors of events."""
    figure, axes = style.new((2.3, 2.3), (1.9,), (2.5,))
    scan, near = Table(dataset, "scan"), Table(dataset, "near")
    boxes, reached = (n.astype(float) ** 3 for n in (scan.boxes_per_side, near.near_boxes_per_side))
    _time(axes[0], scan, boxes)
    style.points(axes[0], reached, near.near_seconds * 1e9, kind=1, hollow=True, label="boxes within reach")
    style.label_axes(axes[0], y="time per particle and step (ns)", legend="upper right")
    _work(axes[1], scan, boxes, reached, near)
    _round_widths(axes[2], Table(dataset, "container"))
    _sectors(axes[3], Table(dataset, "sector"))
    style.letters(*axes)
    return figure


def _time(axis: Axes, scan: Table, boxes: np.ndarray) -> None:
    parts = scan.particle_seconds.value, scan.test_seconds.value, scan.box_seconds.value
    model = parts[0] + parts[1] * scan.pair_tests + parts[2] * scan.boxes_emptied
    style.points(axis, boxes, scan.seconds * 1e9, color=style.DATA, label="measured")
    cheap = scan.seconds.value <= 3.0 * scan.seconds.value.min()
    label = "$a + b$ tests $+ c$ boxes"
    axis.plot(boxes[cheap], (model * 1e9)[cheap], color=style.REFERENCE, label=label)
    particles = boxes[-1] / scan.boxes_per_particle[-1]
    if np.isfinite(scan.ideal_high):
        interval = scan.ideal_low * particles, scan.ideal_high * particles
        axis.axvspan(*interval, color=style.GREY, alpha=0.25, lw=0)
    source = scan.source_boxes_per_particle * particles
    axis.axvline(source, color=SOURCE_COLOUR, linestyle="--", ymax=0.45, label="number of F & M")
    axis.set(xscale="log", yscale="log")


def _work(axis: Axes, scan: Table, boxes: np.ndarray, reached: np.ndarray, near: Table) -> None:
    axis.plot(boxes, scan.expected_tests, color=style.COLOURS[0])
    axis.plot(boxes, scan.expected_visits, color=style.COLOURS[1])
    counted = {
        "pair tests": scan.pair_tests,
        "boxes searched": scan.box_visits,
        "boxes emptied": scan.boxes_emptied,
    }
    handles: list[Any] = [
        style.points(axis, boxes, work, kind=kind, label=label)
        for kind, (label, work) in enumerate(counted.items())
    ]
    look: dict[str, Any] = {"kind": 1, "hollow": True, "label": "searched, within reach"}
    handles.append(style.points(axis, reached, near.near_box_visits, **look))
    colour = style.COLOURS[1]
    handles += axis.plot(boxes, scan.in_reach, color=colour, linestyle="--", label="boxes within reach")
    handles += axis.plot(boxes, scan.touched, color=colour, linestyle=":", label="boxes touched (F & M)")
    axis.set(yscale="log", ylabel="number per particle and step", ylim=(0.01, 1e8))
    axis.set(xscale="log", xlabel="number of boxes")
    axis.legend(handles=handles, loc="upper right")


def _round_widths(axis: Axes, containers: Table) -> None:
    per_side, (first, second) = containers.fine_boxes_per_side[0], containers.container_side
    ratio = containers.fine_seconds[0] / containers.fine_seconds[1]
    positions, is_round = np.arange(per_side.size), np.isin(per_side, containers.round_per_side)
    style.level(axis, 1.0)
    style.points(axis, positions[~is_round], ratio[~is_round], color=style.DATA)
    widths = ", ".join(f"{first / n:g}" for n in containers.round_per_side)
    style.points(axis, positions[is_round], ratio[is_round], kind=1, label=f"boxes of width {widths}")
    axis.set_xticks(positions, [str(int(n)) for n in per_side])
    axis.tick_params(axis="x", top=False)
    style.label_axes(axis, "boxes per side", f"time, side {first:g} / {second:g}", "upper left")


def _sectors(axis: Axes, scan: Table) -> None:
    sectors = scan.sector_boxes_per_side.astype(float) ** 2
    counted = {"pair_tests": "pair tests", "box_visits": "sectors searched", "crossings": "crossings"}
    for kind, (name, label) in enumerate(counted.items()):
        style.points(axis, sectors, getattr(scan, f"sector_{name}"), kind=kind, linestyle="-", label=label)
    look: dict[str, Any] = {"color": style.DATA, "marker": "X", "linestyle": "-", "label": "time (µs)"}
    style.points(axis, sectors, scan.sector_seconds * 1e6, **look)
    axis.set(xscale="log", yscale="log", xlabel="number of sectors", ylabel="per event (event-driven)")
    axis.set_ylim(top=6e5)
    axis.legend(loc="upper right", ncols=2, columnspacing=0.8)


FIGURES = {"box_count": Parts(SETTINGS, measure, claims, draw)}
