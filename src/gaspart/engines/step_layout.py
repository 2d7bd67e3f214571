"""What the time-stepped engine's kernels work on: arrays by axis, in the order of their slots.

A *slot* is a body's present place in memory; `index` tells which body that is. All real numbers have the
precision of the positions (float32 or float64). Sums that several threads make are whole numbers, so that
no order of adding shows in them.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernel import helper

COLLISIONS, PAIR_TESTS, BOX_VISITS, OVERLAPS_LEFT, MULTIPLE, REBUILDS, LATE, PASSED = range(8)
VIRIAL, LOSS = range(2)
DEEPEST, WORST = range(2)
FASTEST, SPENT = range(2)


class Space(NamedTuple):
    """lengths (d,), periodic (d,); margin: 1 if walls stop surfaces, 0 if they stop centres; normal: what a
    contact leaves of the approach; push: what it passes of the elastic impulse, (1 + normal) / 2."""

    lengths: tuple
    periodic: tuple
    margin: float
    normal: float
    push: float


class Bodies(NamedTuple):
    """By slot: positions, velocities (d, N), radii, index (N,). By body: images (d, N), masses (N,).

    ordinary: how many slots the partition holds; the bodies beyond, too large for it, are the last ones.
    """

    positions: np.ndarray
    velocities: np.ndarray
    images: np.ndarray
    radii: np.ndarray
    index: np.ndarray  # type: ignore[assignment]  # tuples have a method of this name
    masses: np.ndarray
    ordinary: int


class Counters(NamedTuple):
    """counts (8,), sums (2, 2) by `running_sum.add` and extremes (2,), see the names at the module's top; by
    thread: wall_hits (threads, 2d); wall_impulse (threads, 2d, 2) and wall_loss (threads, 2), an energy, both
    by `running_sum.add_whole`; momentum and energy: the powers of two that few terms of these exceed."""

    counts: np.ndarray
    sums: np.ndarray
    extremes: np.ndarray
    wall_hits: np.ndarray
    wall_impulse: np.ndarray
    wall_loss: np.ndarray
    momentum: float
    energy: float


class Found(NamedTuple):
    """Contacts to resolve, by thread: pairs (threads, room, 2) of slots, times (threads, room), number
    (threads,), which may exceed the room; tests (threads,), how many pairs were tested; touching
    (threads, n), room for those of a block that touch."""

    pairs: np.ndarray
    times: np.ndarray
    number: np.ndarray
    tests: np.ndarray
    touching: np.ndarray


class Watch(NamedTuple):
    """met (N,), by slot: the turn of the last contact. reach (2,): the FASTEST speed of any body, or more;
    the most that any may have SPENT of the skin since the list was made."""

    met: np.ndarray
    reach: np.ndarray


class Turn(NamedTuple):
    """The number of this pass, among those of all steps, and of the first pass of this step."""

    now: int
    first: int


@helper
def share(part, parts, count):
    """Where part `part` of `count` things divided among `parts` begins."""
    return part * count // parts
