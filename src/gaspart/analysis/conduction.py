"""The conductivity of heat of a mixture.

In a mixture the flux of energy depends on what is counted as heat: with the species their enthalpies diffuse.
By linear irreversible thermodynamics (de Groot and Mazur, Non-equilibrium thermodynamics (1962), chapter XI)
a gradient of the temperature drives the flux of energy J_q and those of the species J_a about the centre of
mass by L_qq and L_aq, gradients of the chemical potentials by L_qa and L_ab. The conductivity is that without
diffusion, as in a steady state between walls, J_a = 0:

    kappa = (L_qq - sum_ab L_qa (L^-1)_ab L_bq) / (k_B T^2),    L_xy = (1 / V) integral of <J_x(0) J_y(t)> dt,

each J times the volume, along one axis. Whatever multiples of the J_a are added to J_q, this is the same:
no enthalpies are needed. It is the coefficient of J_q - sum_a b_a J_a with the b_a for which it is least, so
that the uncertainty of these does not matter to first order.

J_q is tallied with the stress; time integrals of J_a are displacements of particles, relative to the centre
of mass. Fluxes are here the means over the intervals between frames, for which the forms of Green and Kubo
are exact as in `transport`.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart.analysis.expected.described import described
from gaspart.analysis.motion import unwrapped
from gaspart.analysis.observable import LEAST_INTERVALS, Observable, scalar
from gaspart.analysis.run import Run
from gaspart.errors import SceneError


def conductivity_without_diffusion(run: Run, lag: float) -> Observable:
    """That of a mixture, from correlations until a lag, a time. Raises SceneError for frames at uneven times,
    too far apart, or too few, and for a run that lacks some particles."""
    steps = np.diff(run.time)
    if np.ptp(steps) > 1e-6 * steps.mean():
        raise SceneError("time", "frames at uneven times", "a correlation needs even ones")
    number = round(lag / run.interval)
    if number < 1:
        rule = f"is longer than the lag, {lag:g}, until which fluxes of the species are correlated"
        raise SceneError("sample_interval", run.interval, rule)
    if len(run.time) - 1 - number < LEAST_INTERVALS:
        rule = f"an error needs {LEAST_INTERVALS + number + 1} or more, the lag is that of {number}"
        raise SceneError("frames", len(run.time), rule)
    if not run.temperature > 0.0:
        raise SceneError("temperature", run.temperature, "without motion no flux fluctuates")
    heat, passed = run.data["heat_sum"].values, _passed(run)
    coupling = _products(passed, passed, number).mean(axis=-1)
    with_heat = _products(passed, heat[None], number).mean(axis=-1)
    factors = np.linalg.lstsq(coupling, with_heat[:, 0], rcond=None)[0]
    rest = (heat - np.tensordot(factors, passed, 1))[None]
    scale = 1.0 / (math.prod(run.scene.container.lengths) * run.temperature**2 * run.interval)
    series = scale * _products(rest, rest, number)[0, 0]
    about = described("thermal_conductivity", run, run.temperature)
    about["long_name"] += " without diffusion"
    return scalar("thermal_conductivity", series, run.time[: len(series) + 1], **about)


def _passed(run: Run) -> np.ndarray:
    """(S - 1, T, d) displacements relative to the centre of mass, summed over the particles of each species
    but the last, whose sum follows from the others'."""
    moving, masses = run.moving, run.masses  # raises SceneError if some are not in the file
    paths = unwrapped(run)[:, moving]
    paths = paths - np.einsum("tnd,n->td", paths, masses / masses.sum())[:, None]
    kinds = np.unique(run.species)[:-1]
    return np.array([paths[:, run.species == kind].sum(axis=1) for kind in kinds])


def _products(one: np.ndarray, other: np.ndarray, lags: int) -> np.ndarray:
    """(A, B, T - 1 - lags) of time integrals (A, T, d) and (B, T, d) of fluxes: the change of each over an
    interval times half of that of the other over the same and its change over so many later ones, the mean
    over both orders and over axes."""

    def half(first: np.ndarray, second: np.ndarray) -> np.ndarray:
        origins = first.shape[1] - 1 - lags
        now = np.diff(first, axis=1)[:, :origins]
        later = second[:, lags + 1 :] - 0.5 * (second[:, :origins] + second[:, 1 : origins + 1])
        return np.einsum("atd,btd->abt", now, later) / first.shape[2]

    return 0.5 * (half(one, other) + half(other, one).swapaxes(0, 1))
