"""The table of extremes: the scenes, their durations and exact numbers of contacts."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from gaspart.reproduction.families.extremes import exact, scenes
from gaspart.scene.scene import Scene

NOWHERE = "-"
"""No engine has a name that begins so."""
FLOAT32 = "step, float32"


@dataclass(frozen=True)
class Row:
    """Line of the table.

    name, group : its name and its group.
    scene : function that makes the scene, which may be refused.
    duration, time_step : in the scene's time.
    contacts : exact number of contacts of particles and walls, where it is known; otherwise the search of all
        pairs decides.
    chaotic : True for a gas, in which an engine with other rounding has the same number of contacts only on
        average.
    refused : engines where only a refusal is the expected result, by the beginning of their names, as "step";
        "" for all; NOWHERE for none.
    """

    name: str
    group: str
    scene: Callable[[], Scene]
    duration: float
    time_step: float
    contacts: int | None = None
    chaotic: bool = False
    refused: str = NOWHERE


def _galperin(ratio: float, duration: float, time_step: float) -> Row:
    """Return the row of two balls of a mass ratio.

    The light ball becomes sqrt(ratio) times as fast as the heavy one: above 1e4, too fast for steps.
    """
    contacts = exact.galperin(ratio, 2.0, 1.0, duration)
    return Row(
        f"mass ratio 1e{math.log10(ratio):.0f}: {contacts} contacts", "masses",
        partial(scenes.galperin, ratio), duration, time_step, contacts,
        refused="step" if ratio > 1e4 else NOWHERE,
    )  # fmt: skip


def _speed(speed: float, text: str) -> Row:
    """Return twenty diameters of flight, in steps of a thousandth of a diameter."""
    moderate = 1e-100 < speed < 1e100
    scale = 1.0 / speed if moderate else 1.0
    return Row(
        f"speeds {text}", "speeds", partial(scenes.fast_gas, speed), 20.0 * scale, 1e-3 * scale,
        chaotic=True, refused=FLOAT32 if moderate else "",
    )  # fmt: skip


def _bounce(gravity: float) -> Row:
    """Return a hundred periods of a fall from a height of 2, and a quarter."""
    period = 2.0 * math.sqrt(4.0 / gravity)
    return Row(
        f"gravity {gravity:g}: 100 bounces", "gravity",
        partial(scenes.bouncing, gravity), 100.25 * period, period / 200, 100,
    )  # fmt: skip


_ON_LINE = exact.contacts_on_line(scenes.LINE_STARTS, scenes.LINE_VELOCITIES, 1e6, 1e9)
_IN_BOX = exact.hits_in_box((4.5, 4.5), (1234.5, 777.0), (9.0, 9.0), 10.0)

ROWS = (
    _galperin(1e2, 14.0, 1e-3),
    _galperin(1e4, 14.0, 1e-5),
    _galperin(1e12, 14.0, 1e-5),
    _galperin(1e16, 2.0 - 1e-4, 1e-5),
    Row("masses 1 and 1e16, a gas", "masses", scenes.unequal_masses, 20.0, 1e-3, chaotic=True),
    Row("discs of 1 and 1e-4", "sizes", scenes.unequal_sizes, 2.0, 2e-5, chaotic=True),
    Row("spheres of 1 and 1e-4", "sizes", partial(scenes.unequal_sizes, 3), 4.0, 2e-5, chaotic=True),
    Row("discs in 1e9 diameters", "sizes", partial(scenes.pair_in, 1e9), 20.0, 0.01, 1, refused=FLOAT32),
    Row("discs in 1e15 diameters", "sizes", partial(scenes.pair_in, 1e15), 20.0, 0.01, 1, refused=""),
    _speed(1e-300, "1e-300"),
    _speed(1e-50, "1e-50"),
    _speed(1e50, "1e50"),
    _speed(1e300, "1e300"),
    Row(
        "speeds 1e-12 and 1e12",
        "speeds",
        scenes.slow_beside_fast,
        2e-11,
        1e-15,
        chaotic=True,
        refused=FLOAT32,
    ),
    Row(
        "grazing by 1e-15", "contacts", partial(scenes.grazing, scenes.GRAZE), 2e-6, 1e-9, 1, refused=FLOAT32
    ),
    Row(
        "missing by 1e-15",
        "contacts",
        partial(scenes.grazing, -2.0 * scenes.GRAZE),
        2e-6,
        1e-9,
        0,
        refused=FLOAT32,
    ),
    Row("Newton's cradle", "contacts", scenes.cradle, 2.5, 0.01, 4),
    Row("four at one instant", "contacts", scenes.four_at_once, 2.0, 0.01),
    Row("corner of two walls", "corners", partial(scenes.corner, 2), 3.0, 0.01, 2),
    Row("corner of three walls", "corners", partial(scenes.corner, 3), 3.0, 0.01, 3),
    Row("100 walls in a step", "steps", scenes.one_fast, 10.0, 1.0, _IN_BOX),
    Row(
        "10 diameters in a step",
        "steps",
        partial(scenes.fast_gas, 1.0),
        20.0,
        10.0,
        chaotic=True,
        refused="step",
    ),
    Row("discs at 0.90", "density", partial(scenes.crystal, 0.90, 2), 0.15, 2e-4, chaotic=True),
    Row("spheres at 0.72", "density", partial(scenes.crystal, 0.72, 3), 0.15, 2e-4, chaotic=True),
    Row("no gap at all", "density", scenes.touching, 2.0, 1e-3, refused=""),
    Row("a gap of 1e-6", "density", scenes.jam_of_four, 0.2, 1e-3, refused="step"),
    Row("no room between walls", "density", scenes.tight_disc, 2.0, 1e-3, refused=""),
    Row("clock to 1e9", "clocks", scenes.line, 1e9, 1e3, _ON_LINE, refused="step"),
    Row("restitution 0", "restitution", scenes.sticking, 5.0, 0.01, 1),
    Row(
        "restitution 1e-12, a gas", "restitution", scenes.dissipative_gas, 1e3, 0.01, chaotic=True, refused=""
    ),
    _bounce(1e-12),
    _bounce(1e12),
    Row("gravity 1e-12, a gas", "gravity", partial(scenes.falling_gas, 1e-12), 10.0, 1e-3, chaotic=True),
    Row(
        "gravity 1e12, a gas",
        "gravity",
        partial(scenes.falling_gas, 1e12),
        2e-5,
        2e-9,
        chaotic=True,
        refused=FLOAT32,
    ),
    Row("no particles", "few", partial(scenes.few, 0), 10.0, 0.01, 0),
    Row("one particle", "few", partial(scenes.few, 1), 10.0, 0.01, 0),
    Row("two particles", "few", partial(scenes.few, 2), 10.0, 0.01, chaotic=True),
)
