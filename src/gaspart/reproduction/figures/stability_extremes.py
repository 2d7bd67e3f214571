"""Extreme scenes in every engine and precision: each runs correctly, or is rejected with one line."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
import xarray as xr

from gaspart.engines import Engine, EventDriven, TimeStepped
from gaspart.errors import SceneError, SimulationError
from gaspart.keys import TEXT, list_of, names
from gaspart.rendering import style
from gaspart.rendering.style import Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.figures._extreme_scenes import ROWS, Row
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row as TableRow
from gaspart.reproduction.table import Table, table
from gaspart.simulation import ENERGY_DRIFT, Simulation
from gaspart.state.state import State

TITLE, CHAPTER = "Stability and reversibility", "Speed and accuracy"
SETTINGS = {
    "experiments": list_of(TEXT, "none: its scenes are a table of the library", least=0, most=0),
    "groups": names("groups of the table's rows that are run; all by default", default=None),
}
ALL_PAIRS = "event, all pairs"
ENGINES: dict[str, Callable[[Row], Engine]] = {
    "event": lambda row: EventDriven(),
    ALL_PAIRS: lambda row: EventDriven("pairs"),
    "step": lambda row: TimeStepped(row.time_step),
    "step, float32": lambda row: TimeStepped(row.time_step, precision="float32"),
}
PASSES, REFUSED, FAILS, HANGS = "passes", "refused", "fails", "hangs"
LIMIT = 300.0  # time limit of a row in an engine, in s
OVERLAP = {"event": 1e-9, "step": 0.01}  # largest allowed overlap, in contact distances
MISCOUNTED = 0.03  # allowed relative error of contacts with time steps, beside the statistical one
MOST_EVENTS, MOST_TESTS = 10_000_000, 50_000_000  # at which an event-driven run ends; tests of all pairs
CHECKS = 8  # times that a run is checked for overlaps
UNITS = {"energy": "kinetic energy", "momentum": "sum of all |p|", "overlap": "contact distance"}


@dataclass(frozen=True)
class Outcome:
    """Outcome of one scene in one engine: verdict, relative drifts, deepest overlap, contacts. The momentum
    is NaN if walls absorb it; `missed` contacts are negative if some are spurious; `bits` are those of the
    final state.
    """

    verdict: str
    message: str = ""
    energy: float = math.nan
    momentum: float = math.nan
    overlap: float = math.nan
    contacts: int = -1
    missed: int = 0
    seconds: float = math.nan
    bits: bytes = b""


def attempt(row: Row, engine: str, referee: Outcome | None = None) -> Outcome:
    """Run a row in an engine; without an exact number of contacts `referee` supplies it."""
    start = time.perf_counter()
    try:
        with warnings.catch_warnings():
            # warnings of time steps with errors of several per cent
            warnings.simplefilter("ignore", UserWarning)
            outcome = _run(row, engine, referee)
    except (SceneError, SimulationError) as refusal:
        outcome = {"verdict": REFUSED, "message": str(refusal)}
    return Outcome(**outcome, seconds=time.perf_counter() - start)


def _run(row: Row, engine: str, referee: Outcome | None) -> dict[str, Any]:
    simulation, overlap = Simulation(row.scene(), ENGINES[engine](row), seed=1), 0.0
    for check in range(1, CHECKS + 1):
        if not _advance(simulation, row.duration * check / CHECKS):
            message = "not at its end after the largest permitted number of contacts"
            return {"verdict": FAILS, "message": message}
        overlap = max(overlap, deepest_overlap(simulation.state, simulation.scene.container.periodic))
        simulation.check_invariants()
    tally, state, before = simulation.tally, simulation.state, simulation.initial_state
    contacts, expected = int(tally.collisions + tally.wall_hits.sum()), row.contacts
    bits, missed = state.positions.tobytes() + state.velocities.tobytes(), 0
    if expected is None and referee is not None:
        expected = referee.contacts if referee.verdict == PASSES else None
        if engine == "event" and referee.bits:
            missed = int(bits != referee.bits)
    if expected is not None:
        missed = expected - contacts or missed
    energy = energy_drift(before, state, tally.dissipated_energy)
    momentum = momentum_drift(before, state) if simulation.scene.is_periodic else math.nan
    numbers = {"energy": energy, "momentum": momentum, "overlap": overlap, "contacts": contacts}
    drift, allowed = ENERGY_DRIFT[simulation.engine.precision], 0.0
    if row.chaotic and simulation.engine.name == "step" and expected:
        allowed = 4.0 * math.sqrt(expected) + MISCOUNTED * expected
    verdict: dict[str, Any] = {"verdict": PASSES}
    for quantity, measured, most in (
        ("energy", energy, drift),
        ("momentum", momentum, drift),
        ("overlap", overlap, OVERLAP[simulation.engine.name]),
        ("missed", abs(missed), allowed),
    ):
        if measured > most or (quantity != "momentum" and math.isnan(measured)):
            verdict = {"verdict": FAILS, "message": f"{quantity} = {measured:g}: more than {most:g}"}
            break
    return verdict | numbers | {"missed": missed, "bits": bits}


def _advance(simulation: Simulation, until: float) -> bool:
    """Advance to a time; return True if it was reached within the allowed contacts."""
    if not isinstance(simulation.engine, EventDriven):
        simulation.advance(until=until)
        return True
    all_pairs = simulation.engine.search == "pairs"
    most = MOST_TESTS // max(1, simulation.scene.count) ** 2 if all_pairs else MOST_EVENTS
    simulation.advance(until=until, max_events=most)
    return simulation.time >= until * (1.0 - 1e-12)


def energy_drift(before: State, after: State, dissipated: float) -> float:
    """Compute the drift of the energy over the kinetic energy and that of a fall through the container."""
    scale = max(before.kinetic_energy, after.kinetic_energy)
    if after.gravity is not None:
        scale += float(after.masses.sum() * (abs(after.gravity) @ after.lengths))
    return abs(after.energy + dissipated - before.energy) / (scale or 1.0)


def momentum_drift(before: State, after: State) -> float:
    """Compute the drift of the momentum over the sum of the absolute momenta."""
    scale = float((before.masses * before.speeds).sum())
    return float(np.abs(after.momentum - before.momentum).max()) / (scale or 1.0)


def deepest_overlap(state: State, periodic: tuple[bool, ...]) -> float:
    """Compute the deepest overlap of any pair over the contact distance; all pairs are searched."""
    deepest = 0.0
    for n in range(state.count - 1):
        apart = state.positions[n + 1 :] - state.positions[n]
        apart -= np.where(periodic, state.lengths * np.rint(apart / state.lengths), 0.0)
        sigma = state.radii[n + 1 :] + state.radii[n]
        deepest = max(deepest, float((1.0 - np.sqrt((apart**2).sum(axis=1)) / sigma).max()))
    return deepest


def run_guarded(work: Callable, items: Sequence, limit: float) -> list:
    """Return `work(item)` for each item; None if it takes more than `limit` seconds, or ends its process.
    Compiled code cannot be interrupted. Therefore it runs in a child process, which can be killed.
    """
    results: list = []
    context = get_context("fork")
    while len(results) < len(items):
        receiver, sender = context.Pipe(duplex=False)
        child = context.Process(target=_work, args=(sender, work, items[len(results) :]))
        child.start()
        sender.close()
        try:
            while len(results) < len(items) and receiver.poll(limit):
                results.append(receiver.recv())
        except EOFError:  # the child process has ended
            pass
        if len(results) < len(items):
            results.append(None)
        child.kill()
        child.join()
    return results


def _work(sender: Connection, work: Callable, items: Sequence) -> None:
    for item in items:
        sender.send(work(item))


def run_row(row: Row) -> list[Outcome]:
    """Run a row in each engine; the search of all pairs is first, as the reference."""
    trial = partial(attempt, row)
    referee = trial(ALL_PAIRS)
    return [referee if engine == ALL_PAIRS else trial(engine, referee) for engine in ENGINES]


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Run all rows of the table, or those of some groups; there are no points."""
    groups = settings.get("groups")
    rows = [row for row in ROWS if groups is None or row.group in groups]
    limit = LIMIT * len(ENGINES)
    lost = [Outcome(HANGS, f"not done within {limit:g} s")] * len(ENGINES)
    outcomes = [outcome or lost for outcome in run_guarded(run_row, rows, limit)]
    pairs, units = list(zip(rows, outcomes, strict=True)), UNITS | {"seconds": "s"}
    dataset = table("row", pairs, _columns, inner=("engine",), units=units)
    return dataset.assign_coords(row=[row.name for row in rows], engine=list(ENGINES))


def _columns(of: tuple[Row, list[Outcome]]) -> dict[str, Any]:
    row, outcomes = of
    kept = ("verdict", "message", *UNITS, "seconds", "contacts", "missed")
    return {
        **{name: [getattr(outcome, name) for outcome in outcomes] for name in kept},
        "refusal": [engine.startswith(row.refused) for engine in ENGINES],
        "group": row.group,
        "expected": -1 if row.contacts is None else row.contacts,
    }


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield the claims that engines pass or refuse what they should, and on rounding errors without steps."""
    for scene in Table(dataset, "row"):
        one_line = np.array([bool(message) and "\n" not in message for message in scene.message])
        refused = (scene.verdict == REFUSED) & one_line
        yield Claim(
            f"{scene.row} ({scene.group}): engines that pass, or refuse with one line what they should",
            Estimate(np.where(scene.refusal, refused, scene.verdict == PASSES).sum()),
            len(scene.engine), 0.5,
            "exact: none hangs, none is silently wrong; which refuse is stated beforehand",
            "a run is refused that should pass, or the reverse; hangs, drifts, overlaps, or has "
            "other contacts than the exact answer or all pairs",
        )  # fmt: skip
    event = Table(dataset.sel(engine="event"), "row")
    passed = event[event.verdict == PASSES]
    for text, largest, bound in (
        ("largest relative drift of the energy", max(np.abs(passed.energy), default=np.nan), 1e-9),
        ("deepest overlap observed, in contact distances", max(np.abs(passed.overlap), default=np.nan), 1e-9),
        ("missed or spurious contacts in all rows", np.abs(passed.missed).sum(), 0.0),
    ):
        yield Claim.at_most(
            f"{text}, event-driven", Estimate(largest), bound, 0.5,
            "exact: conserved, hard, and the contacts of the exact answer or of the search through all pairs",
            "rounding errors grow, or a root is wrong",
        )  # fmt: skip


HEADS = {"event": "event", ALL_PAIRS: "all pairs", "step": "step f8", "step, float32": "step f4"}
BLOCKS = {  # drawn quantities, and the headings of their columns
    "energy": "drift of\nenergy",
    "momentum": "drift of\nmomentum",
    "overlap": "overlap",
    "missed": "missed\ncontacts",
}
GAP = 0.5  # between blocks, in columns
FLOOR = 1e-17  # errors below this are drawn as 0
REASONS = (  # of rejections: a letter, the reason, and parts of the messages that state it
    ("a", "step too long: contacts late or missed", ("step too late", "misses")),
    ("b", "step too short for float32", ("than float32 resolves",)),
    ("c", "lengths or speeds beyond float32", ("float32 needs", "float32 does not")),
    ("d", "speeds whose squares overflow", ("of a size from",)),
    ("e", "particles too small for the container", ("too small to resolve",)),
    ("f", "no room to move", ("no room",)),
    ("g", "inelastic collapse", ("inelastic collapse",)),
)
OTHER = "?", "another reason, in the data"


def draw(dataset: xr.Dataset) -> Figure:
    """Draw a row for each scene and a column for each engine, with an error or the letter of a rejection."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm
    from matplotlib.patches import Rectangle

    scale = ScalarMappable(LogNorm(FLOOR, 1.0, clip=True), "YlGnBu")
    scenes = Table(dataset, "row")
    rows, engines = scenes.verdict.shape
    wide = style.width() > style.COLUMN
    letters = (6.0, 7.0, 8.0) if wide else (4.5, 5.5, 6.0)  # heights of rows, key and headings, in cells
    figure, (axis,) = style.new((2.1 + (0.165 if wide else 0.11) * rows,))
    starts = {name: n * (engines + GAP) for n, name in enumerate(BLOCKS)}
    for name, start in starts.items():
        for n, scene in enumerate(scenes):
            for k, outcome in enumerate(Table(scene.dataset, "engine")):
                text, colour, ink = _cell(outcome, name, wide, scale)
                at, look = (start + k, n), {"ha": "center", "va": "center", "color": ink}
                axis.add_patch(Rectangle(at, 1, 1, facecolor=colour, edgecolor="white", linewidth=0.4))
                if text:
                    axis.text(at[0] + 0.5, n + 0.53, text, look, size=letters[0])
    for n in np.flatnonzero(scenes.group[1:] != scenes.group[:-1]) + 1:
        axis.axhline(float(n), color="black", linewidth=0.6)
    axis.set(xlim=(0, starts["missed"] + engines), ylim=(rows, 0))
    heads = [HEADS[name] for name in scenes.engine] * len(BLOCKS)
    ticks = [start + k + 0.5 for start in starts.values() for k in range(engines)]
    axis.set_xticks(ticks, heads, rotation=90, size=letters[1])
    axis.set_yticks(np.arange(rows) + 0.5, scenes.row, size=letters[1])
    axis.tick_params(length=0, labeltop=True, labelbottom=False, pad=2)
    above = axis.secondary_xaxis(1.0)
    middles = [start + 0.5 * engines for start in starts.values()]
    above.set_xticks(middles, [*BLOCKS.values()], size=letters[2])
    above.tick_params(length=0, pad=34 if wide else 28)
    for part in (*axis.spines.values(), *above.spines.values()):
        part.set_visible(False)
    axis.set_xlabel(_key(scenes, 3 if wide else 1), size=letters[1])
    bar = figure.colorbar(scale, ax=axis, location="bottom", aspect=50, pad=0.01)
    bar.set_label("relative to energy, momenta,\ncontact distance, number of contacts", size=letters[1])
    bar.ax.tick_params(labelsize=letters[1])
    return figure


def _cell(outcome: TableRow, name: str, wide: bool, scale: Any) -> tuple[str, Any, str]:
    """Return text, background and ink of a cell. The text is the power of ten of an error, for contacts their
    number, if there is space; a dot if walls absorb momentum. Missed contacts are coloured by their share.
    """
    if outcome.verdict == REFUSED:
        return reason(outcome.message)[0], "#e6e6e6", "black"
    if outcome.verdict != PASSES:
        return outcome.verdict, style.COLOURS[1], "white"
    size = abs(outcome[name])
    if name == "missed":
        size /= max(1, outcome.contacts + outcome.missed)
    if not size > FLOOR:
        return ("·" if np.isnan(size) else "0" if wide else ""), "white", style.GREY
    power = np.log10(size)
    text = f"{outcome.missed:.0f}" if name == "missed" else f"$10^{{{power:.0f}}}$"
    return text if wide else "", scale.to_rgba(size), "black" if power < -6.5 else "white"


def reason(message: str) -> tuple[str, str]:
    """Return the letter and the text of the reason for a rejection."""
    found = ((letter, text) for letter, text, parts in REASONS if any(part in message for part in parts))
    return next(found, OTHER)


def _key(scenes: Table, columns: int) -> str:
    """Return lines with the letters and texts of the reasons that occur."""
    reasons = sorted({reason(message) for message in scenes.message[scenes.verdict == REFUSED]})
    texts = [f"{letter}: {text}" for letter, text in reasons]
    lines = ["; ".join(texts[n : n + columns]) for n in range(0, len(texts), columns)]
    return "\n".join(["Rejected" if texts else "None rejected", *lines])


FIGURES = {"stability_extremes": Parts(SETTINGS, measure, claims, draw, key=None)}
