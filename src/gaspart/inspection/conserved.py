"""Checks that need no statistics: conserved energy and momentum, and flights as far as velocities say."""

from __future__ import annotations

import numpy as np

from gaspart.inspection.flights import WRONG, flights, resolution
from gaspart.inspection.frames import Frames
from gaspart.inspection.statistics import why_not_speeds
from gaspart.inspection.verdict import Check

DRIFT = 1e-6
"""Relative change from frame to frame that is attributed to rounding in the program that made the file."""


def judge_conserved(frames: Frames) -> list[Check]:
    """Check the kinetic energy, the momentum along periodic axes, and flights between frames."""
    names = "energy", "momentum", "flights"
    if reason := why_not_speeds(frames):
        return [Check(name, None, reason) for name in names]
    assert frames.velocities is not None, "see `why_not_speeds`"
    if len(frames.positions) < 2:
        return [Check(name, None, "needs two frames") for name in names]
    root = float(np.sqrt(frames.squares.mean()))
    allowed = DRIFT + 2.0 * resolution(frames.velocities) / root
    energy = frames.squares.sum(axis=1) / (frames.count * root**2)
    checks = [_steady("energy", np.abs(np.diff(energy)), allowed, frames.isolated)]
    if any(frames.periodic):
        axes = np.flatnonzero(frames.periodic)
        mean = np.stack([frames.velocities[..., k].mean(axis=1) for k in axes], axis=1) / root
        change = np.sqrt((np.diff(mean, axis=0) ** 2).sum(axis=1))
        checks.append(_steady("momentum", change, allowed, frames.isolated))
    else:
        checks.append(Check("momentum", None, "walls change it"))
    return [*checks, judge_flights(frames)]


def _steady(name: str, changes: np.ndarray, allowed: float, isolated: bool) -> Check:
    """Check that a quantity stays constant from frame to frame.

    The `changes` (T - 1,) are relative to the quantity of all particles together. If it changes most of the
    time, it is conserved only if the file says that nothing acts on the particles.
    """
    worst = int(np.argmax(changes))
    text = f"changes by {changes[worst]:.2g} of it at most, before frame {worst + 1} (up to {allowed:.1g})"
    if not isolated and np.median(changes) > allowed:
        reason = f"{text}, and in most intervals: something acts on the particles"
        return Check(name, None, reason, acts=True)
    return Check(name, bool(changes[worst] <= allowed), text)


def judge_flights(frames: Frames) -> Check:
    """Compare the way of a particle whose velocity stays with velocity times time."""
    if reason := frames.no_identity:
        return Check("flights", None, reason)
    if frames.time is None or not (np.diff(frames.time) > 0.0).all():
        return Check("flights", None, "needs increasing times (--time-step)")
    deviation = flights(frames)
    if not deviation.number:
        return Check("flights", None, "no particle kept its velocity from one frame to the next")
    text = f"off by {deviation.worst:.2g} of their length at most in {deviation.number} flights"
    text += " without a collision"
    wrong = deviation.worst > WRONG
    return Check("flights", not wrong, text + (f", before frame {deviation.frame}" if wrong else ""))
