"""Checks of a trajectory of hard particles; each gives its result in one line."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from gaspart import theory
from gaspart.analysis.statistics import correlated_mean, histogram_chi_square
from gaspart.inspection.contact_value import FIT_ERROR, contact_values
from gaspart.inspection.diffusion import diffusion, expected_diffusion, why_not
from gaspart.inspection.frames import Frames

TOUCH = 1e-5
"""Of a diameter: overlaps up to here are attributed to rounding; more if the file's numbers are coarser."""
COARSEST = 0.1
"""Of a diameter: overlaps beyond are not attributed to rounding, however coarse the file is."""
LIMIT = 4.0
"""Standard errors from theory beyond which a check fails: by chance once in 16 000."""
MOST_FRAMES = 200
"""Number of frames, evenly spaced, that are searched for overlaps and contact values."""
_LEAST_FRAMES = 16
_RARE = 1e-4  # the check of speeds fails below this probability


@dataclass(frozen=True)
class Check:
    """The outcome of one check: whether it is passed (None: it could not be made), and why."""

    name: str
    passed: bool | None
    text: str

    def __str__(self) -> str:
        word = {True: "ok", False: "WRONG", None: "-"}[self.passed]
        return f"{word:6}{self.name}: {self.text}"


def judge(frames: Frames, tolerance: float | None = None) -> list[Check]:
    """All checks of a trajectory. tolerance: allowed overlap, as a fraction of a diameter."""
    seen = np.unique(np.linspace(0, len(frames.positions) - 1, MOST_FRAMES).astype(int))
    checks = [*judge_places(frames, tolerance), _speeds(frames), _kurtosis(frames)]
    return [*checks, _pressure(frames, seen), _diffusion(frames)]


def judge_places(frames: Frames, tolerance: float | None = None) -> list[Check]:
    """Checks of positions: overlaps, and particles outside the container."""
    seen = np.unique(np.linspace(0, len(frames.positions) - 1, MOST_FRAMES).astype(int))
    return [_overlaps(frames, seen, tolerance), _inside(frames, tolerance)]


def _tolerated(frames: Frames, tolerance: float | None) -> float:
    """As a part of the smallest diameter."""
    coarse = 4.0 * frames.resolution / (2.0 * float(frames.radii.min()))
    return min(max(TOUCH, coarse), COARSEST) if tolerance is None else tolerance


def _overlaps(frames: Frames, seen: np.ndarray, tolerance: float | None) -> Check:
    """The deepest overlap of two particles, as a part of their contact distance."""
    deepest, where = 0.0, 0
    for n in seen:
        one = frames.at(n)
        sides, most = np.where(one.periodic, one.lengths, 0.0), 2.0 * float(one.radii.max())
        if np.any((sides > 0.0) & (sides <= 2.0 * most)):
            return Check("overlaps", None, "the container is too small to search them by nearest images")
        pairs = cKDTree(one.positions[0], boxsize=sides).query_pairs(most, output_type="ndarray")
        if len(pairs):
            first, second = pairs.T
            gap = one.positions[0][first] - one.positions[0][second]
            gap -= np.where(sides > 0.0, sides * np.round(gap / one.lengths), 0.0)
            contact = one.radii[first] + one.radii[second]
            worst = float((1.0 - np.sqrt((gap**2).sum(axis=1)) / contact).max())
            if worst > deepest:
                deepest, where = worst, int(n)
    allowed = _tolerated(frames, tolerance)
    text = (
        f"the deepest is {deepest:.2g} of a contact distance, in frame {where} (up to {allowed:.1g} allowed)"
    )
    return Check("overlaps", deepest <= allowed, text)


def _inside(frames: Frames, tolerance: float | None) -> Check:
    """The largest distance of a centre outside the walls; none on periodic axes."""
    walls = ~np.array(frames.periodic)
    if not walls.any():
        return Check("container", None, "periodic, so that nothing can leave it")
    lengths = frames.lengths if frames.lengths_by_frame is None else frames.lengths_by_frame[:, None]
    places, lengths = frames.positions[:, :, walls], lengths[..., walls]
    out = float(np.maximum(-places, places - lengths).max()) / (2.0 * float(frames.radii.min()))
    text = "all centres are inside" if out <= 0.0 else f"a centre is {out:.2g} diameters outside"
    return Check("container", out <= _tolerated(frames, tolerance), text)


def _judged_speeds(frames: Frames) -> str | None:
    """The reason why speeds cannot be checked; None if they can."""
    if frames.velocities is None or not np.any(frames.velocities[-1]):
        return "the file has no velocities"
    if not frames.plain or frames.diameter is None:
        return "particles differ, or are moved by more than elastic contacts"
    return None


def _speeds(frames: Frames) -> Check:
    """The last frame's speeds against Maxwell's law, of their own temperature."""
    name = "speed law"
    if reason := _judged_speeds(frames):
        return Check(name, None, reason)
    assert frames.velocities is not None
    moving = frames.velocities[-1] - frames.velocities[-1].mean(axis=0)
    bins = min(30, frames.count // 10)
    if bins < 4:
        return Check(name, None, f"{frames.count} particles are too few for a histogram")
    temperature = float((moving**2).sum() / (frames.dimension * (frames.count - 1)))
    speeds = np.sqrt((moving**2).sum(axis=1))
    found = histogram_chi_square(speeds, lambda v: theory.maxwell_cdf(v, frames.dimension, temperature), bins)
    text = f"chi-square {found.chi_square:.3g} of {found.degrees_of_freedom} about Maxwell's, last frame"
    return Check(name, found.p_value > _RARE, f"{text} (p = {found.p_value:.2g})")


def _kurtosis(frames: Frames) -> Check:
    """<v^4> / <v^2>^2 of all frames but the first quarter, in which a run may still relax."""
    name = "kurtosis of speeds"
    if reason := _judged_speeds(frames):
        return Check(name, None, reason)
    assert frames.velocities is not None
    moving = frames.velocities[len(frames.velocities) // 4 :]
    if len(moving) < _LEAST_FRAMES:
        return Check(name, None, f"frames are too few for an error: {len(moving)}")
    rest = all(frames.periodic)
    if rest:
        moving = moving - moving.mean(axis=1, keepdims=True)
    square = (moving**2).sum(axis=2)
    found = correlated_mean((square**2).mean(axis=1) / square.mean(axis=1) ** 2).estimate
    expected = theory.kurtosis(frames.dimension, frames.count, zero_momentum=rest)
    return _compared(name, found.value, found.error, expected, 0.0, "Maxwell's")


def _pressure(frames: Frames, seen: np.ndarray) -> Check:
    """Z by the pair distribution at contact against the equation of state, corrected for the finite
    number."""
    name = "pressure Z"
    if not all(frames.periodic) or frames.diameter is None or not frames.plain:
        return Check(
            name, None, "needs equal particles in a periodic container, moved by elastic contacts alone"
        )
    eta, d = frames.packing_fraction, frames.dimension
    if eta > theory.HIGHEST_PACKING_FRACTION[d]:
        return Check(name, None, f"packing fraction {eta:.3g} is beyond the fluid's equation of state")
    if frames.lengths.min() <= 4.0 * frames.diameter:
        return Check(name, None, "the container is narrower than four diameters")
    chosen = seen[len(seen) // 4 :]
    if len(chosen) < _LEAST_FRAMES:
        return Check(name, None, f"frames are too few for an error: {len(chosen)}")
    series = contact_values(replace(frames, positions=frames.positions[chosen]))
    found = correlated_mean(series).estimate
    first = 2.0 ** (d - 1) * eta
    expected = float(theory.compressibility_factor(eta, d))
    expected += float(theory.finite_size_correction(eta, d, frames.count, "canonical"))
    unsure = float(theory.compressibility_uncertainty(eta, d))
    error = first * math.hypot(found.error, FIT_ERROR * found.value)
    return _compared(name, 1.0 + first * found.value, error, expected, unsure, f"fluid, eta = {eta:.4g}")


def _diffusion(frames: Frames) -> Check:
    """D of spheres by their mean-squared displacement against Enskog's theory and its corrections."""
    name = "diffusion coefficient D"
    if reason := _judged_speeds(frames) or why_not(frames):
        return Check(name, None, reason)
    expected, unsure = expected_diffusion(frames)
    return _compared(name, *diffusion(frames), expected, unsure, "Erpenbeck and Wood, Yeh and Hummer")


def _compared(name: str, value: float, error: float, expected: float, unsure: float, source: str) -> Check:
    """Passed within `LIMIT` standard errors, those of both sides in quadrature."""
    sigma = abs(value - expected) / math.hypot(error, unsure)
    text = f"{value:.5g} +- {error:.2g}, theory {expected:.5g}"
    text += f" +- {unsure:.2g}" if unsure else ""
    return Check(name, sigma <= LIMIT, f"{text}: {sigma:.1f} standard errors ({source})")
