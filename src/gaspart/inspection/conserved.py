"""Checks that need no statistics: conserved energy and momentum, and flights as far as velocities say."""

from __future__ import annotations

import numpy as np

from gaspart.inspection.frames import Frames
from gaspart.inspection.speeds import why_not_speeds
from gaspart.inspection.verdict import Check

DRIFT = 1e-6
"""Relative change from frame to frame that is attributed to rounding in the program that made the file."""
_FLIGHT = 1e-3  # the same of a flight
_SINGLE = float(np.finfo(np.float32).eps)
_DIGITS = 12  # after the point, at which decimals differ from binary numbers


def judge_conserved(frames: Frames) -> list[Check]:
    """Checks of the kinetic energy, of the momentum along periodic axes, and of flights between frames."""
    names = "energy", "momentum", "flights"
    if reason := why_not_speeds(frames):
        return [Check(name, None, reason) for name in names]
    assert frames.velocities is not None, "see `why_not_speeds`"
    if len(frames.positions) < 2:
        return [Check(name, None, "needs two frames") for name in names]
    root = float(np.sqrt((frames.velocities**2).sum(axis=2).mean()))
    allowed = DRIFT + 2.0 * _resolution(frames.velocities) / root
    energy = (frames.velocities**2).sum(axis=(1, 2)) / (frames.count * root**2)
    checks = [_steady("energy", np.abs(np.diff(energy)), allowed, frames.isolated)]
    if any(frames.periodic):
        mean = frames.velocities.mean(axis=1)[:, np.array(frames.periodic)] / root
        change = np.sqrt((np.diff(mean, axis=0) ** 2).sum(axis=1))
        checks.append(_steady("momentum", change, allowed, frames.isolated))
    else:
        checks.append(Check("momentum", None, "walls change it"))
    return [*checks, _flights(frames, root)]


def _steady(name: str, changes: np.ndarray, allowed: float, isolated: bool) -> Check:
    """Whether a quantity stays constant from frame to frame. changes (T - 1,): relative to that of all
    particles together.

    If it changes most of the time, it is conserved only if the file says that nothing acts on the particles.
    """
    worst = int(np.argmax(changes))
    text = f"changes by {changes[worst]:.2g} of it at most, before frame {worst + 1} (up to {allowed:.1g})"
    if not isolated and np.median(changes) > allowed:
        return Check(name, None, f"{text}, and in most intervals: something acts on the particles")
    return Check(name, bool(changes[worst] <= allowed), text)


def _flights(frames: Frames, root: float) -> Check:
    """A particle whose velocity is the same in two frames has moved by that velocity times the time between
    them. root: root-mean-square speed."""
    assert frames.velocities is not None, "see `why_not_speeds`"
    if frames.time is None or not (np.diff(frames.time) > 0.0).all():
        return Check("flights", None, "needs increasing times (--time-step)")
    late = root * max(2.0 * _resolution(frames.time), _SINGLE * float(np.abs(frames.time).max()))
    wrong, flights, where = 0.0, 0, 0
    sides = np.where(frames.periodic, np.inf, frames.lengths - 2.0 * frames.radii.min())
    for n, interval in enumerate(np.diff(frames.time)):
        velocity = frames.velocities[n]
        # back and forth between two walls, a velocity is the same too
        free = (velocity == frames.velocities[n + 1]).all(axis=1) & velocity.any(axis=1)
        free &= (np.abs(velocity) * interval < sides).all(axis=1)
        way = velocity[free] * interval
        off = frames.positions[n + 1][free] - frames.positions[n][free] - way
        off -= np.where(frames.periodic, frames.lengths * np.round(off / frames.lengths), 0.0)
        slack = 4.0 * frames.resolution + late + 2.0 * _resolution(velocity) * interval
        excess = np.sqrt((off**2).sum(axis=1)) - slack
        excess /= np.maximum(np.sqrt((way**2).sum(axis=1)), slack)
        flights += len(way)
        if len(way) and excess.max() > wrong:
            wrong, where = float(excess.max()), n + 1
    if not flights:
        return Check("flights", None, "no particle kept its velocity from one frame to the next")
    text = f"off by {wrong:.2g} of their length at most in {flights} flights without a collision"
    return Check("flights", wrong <= _FLIGHT, text + (f", before frame {where}" if wrong > _FLIGHT else ""))


def _resolution(values: np.ndarray) -> float:
    """By how much numbers may be off that a file has in single precision, or with a few decimals."""
    if np.array_equal(values, values.astype(np.float32)):
        return _SINGLE * float(np.abs(values).max(initial=0.0))
    sample = values.reshape(-1)[:1000]
    for digits in range(1, _DIGITS):
        if np.array_equal(sample, np.round(sample, digits)):
            return 0.5 * 10.0**-digits
    return 0.0
