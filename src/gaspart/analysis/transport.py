"""Viscosities, thermal conductivity and pressure tensor, from tallies of the stress and the heat flux.

A run with `Correlations(stress=True)` sums products of these fluxes J. The fluxes are relative to the
velocity of the centre of mass. Each flux is averaged over the interval h between two samples. The run also
sums squared differences of their time integrals, G = V int J dt (Helfand, Phys. Rev. 119, 1 (1960)). A
transport coefficient is the limit at long times of each of the expressions

    <(G(t) - G(0))^2> / (2 V t x)  and of its derivative  h [C(0)/2 + C(h) + C(2h) + ... ] / (V x),

where C is the correlation function of V J. The constant x is k_B T for the viscosities, and k_B T^2 for the
conductivity of a gas of one species. The first expression is the formula of Helfand, the second the formula
of Green and Kubo. The second formula is exact at the times between two lags, although the fluxes are means
over intervals and not instantaneous values. These means include the impulses at collisions.
"""

from __future__ import annotations

import json
import math
import warnings

import numpy as np
import xarray as xr

from gaspart.analysis.expected.equilibrium import describe
from gaspart.analysis.observable import LEAST_INTERVALS, Observable, observable, scalar
from gaspart.analysis.observables import KEPT, require_defined
from gaspart.analysis.paths import unwrap_positions
from gaspart.analysis.run import Run, Source, open_run
from gaspart.analysis.statistics import correlated_mean, means_of
from gaspart.errors import SceneError
from gaspart.scene.boundaries import flow
from gaspart.scene.scene import Scene
from gaspart.state.initial import initial_state
from gaspart.state.state import State, drift_of
from gaspart.trajectory.amber import INITIAL
from gaspart.trajectory.correlator import Correlations

# Thermal conductivity of a mixture.
#
# In a mixture the heat flux depends on its definition, because diffusing species carry enthalpy. In linear
# irreversible thermodynamics (de Groot and Mazur, Non-equilibrium thermodynamics (1962), chapter XI), J_q is
# the flux of energy, and J_a are the fluxes of the species relative to the centre of mass. A temperature
# gradient drives them with the coefficients L_qq and L_aq, and gradients of the chemical potentials with L_qa
# and L_ab. The conductivity is defined without diffusion, J_a = 0, as in a steady state between walls:
#
#     kappa = (L_qq - sum_ab L_qa (L^-1)_ab L_bq) / (k_B T^2),    L_xy = (1 / V) integral of <J_x(0)
#     J_y(t)> dt,
#
# each J is multiplied by the volume, along one axis. The conductivity does not change if any multiples of the
# J_a are added to J_q, so the enthalpies are not needed. It is the minimum over b_a of the coefficient of J_q
# - sum_a b_a J_a. So the uncertainty of the b_a does not matter to first order.
#
# J_q is tallied with the stress. The time integrals of J_a are displacements of particles relative to the
# centre of mass. The fluxes here are means over the intervals between frames. The Green-Kubo formulas are
# exact for such means.


def conductivity_without_diffusion(run: Run, lag: float) -> Observable:
    """Measure the thermal conductivity of a mixture from correlations up to the time `lag`. Raises SceneError
    if frames are unevenly spaced, too far apart, or too few, and if the file does not contain all particles.
    """
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
    heat, passed = run.data["heat_sum"].values, _sum_displacements(run)
    coupling = _products(passed, passed, number).mean(axis=-1)
    with_heat = _products(passed, heat[None], number).mean(axis=-1)
    factors = np.linalg.lstsq(coupling, with_heat[:, 0], rcond=None)[0]
    rest = (heat - np.tensordot(factors, passed, 1))[None]
    scale = 1.0 / (math.prod(run.scene.container.lengths) * run.temperature**2 * run.interval)
    series = scale * _products(rest, rest, number)[0, 0]
    about = describe("thermal_conductivity", run, run.temperature)
    about["long_name"] += " without diffusion"
    return scalar("thermal_conductivity", series, run.time[: len(series) + 1], **about)


def _sum_displacements(run: Run) -> np.ndarray:
    """Sum the displacements of each species relative to the centre of mass. The shape is (S - 1, T, d),
    because the sum for the last species follows from the other sums.
    """
    moving, masses = run.moving, run.masses  # raises SceneError if the file lacks particles
    members = [run.species == kind for kind in np.unique(run.species)[:-1]]
    sums = []
    for path in unwrap_positions(run, np.flatnonzero(moving)):
        about = path - np.einsum("nd,n->d", path, masses / masses.sum())
        sums.append([about[chosen].sum(axis=0) for chosen in members])
    return np.array(sums).swapaxes(0, 1)


def _products(flux: np.ndarray, other_flux: np.ndarray, lags: int) -> np.ndarray:
    """Compute products of changes of two sets of time-integrated fluxes. The integrals have the shapes (A, T,
    d) and (B, T, d), and the products the shape (A, B, T - 1 - lags). The change of one integral over an
    interval is multiplied by a sum of changes of the other integral: half of its change over the same
    interval plus its change over the next `lags` intervals. The result is averaged over both orders of the
    two integrals and over axes.
    """

    def half(first: np.ndarray, second: np.ndarray) -> np.ndarray:
        origins = first.shape[1] - 1 - lags
        now = np.diff(first, axis=1)[:, :origins]
        later = second[:, lags + 1 :] - 0.5 * (second[:, :origins] + second[:, 1 : origins + 1])
        return np.einsum("atd,btd->abt", now, later) / first.shape[2]

    return 0.5 * (half(flux, other_flux) + half(other_flux, flux).swapaxes(0, 1))


_SLIGHT = 1e-6  # fraction of k_B T: energy of the motion of the whole gas that changes no coefficient


def shear_viscosity(source: Source, lag: float | None = None, start: float | None = None) -> Observable:
    """Measure the shear viscosity.

    Between sheared faces (`LeesEdwards`) the result is the response -P_yx / shear_rate instead. It needs no
    lag and has no curves. The antisymmetric part of the stress is included. This part is zero unless
    collisions violate the conservation of angular momentum, as in the cells of DSMC. The theoretical value is
    Enskog's viscosity.

    Parameters
    ----------
    source : str, Path or Dataset
        A trajectory with correlations of the stress (a path or an open trajectory).
    lag : float, [time], optional
        Longest time difference of the correlations that are summed. Default: the longest stored lag, with a
        warning if the sum clearly goes on to grow there.

    Returns
    -------
    Observable
        The viscosity, in [mass length^(2-d)/time], with the curves `green_kubo` and `helfand` (lag,).

    Raises
    ------
    SceneError
        If the run has no correlations of the stress, if the lag exceeds their longest lag, if there are fewer
        than 17 frames, or if the shear rate is 0.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> stress = gp.Correlations(interval=0.1, lags=10, stress=True)
    >>> path = gp.run(scene, "event", 1, 40.0, 1.0, "gas.nc", correlations=stress)
    >>> gp.analysis.shear_viscosity(path, lag=0.5).green_kubo.dims
    ('lag',)
    """
    with open_run(source, start, sheared=True) as run:
        require_defined("shear_viscosity", run.scene)
        if run.scene.shear_rate is None:
            return _coefficient(run, "shear_viscosity", "shear", lag)
        return _response(run, lag)


def bulk_viscosity(source: Source, lag: float | None = None, start: float | None = None) -> Observable:
    """Measure the bulk viscosity from fluctuations of the pressure relative to its mean.

    The mean pressure is computed from the run itself, which has the duration T. Therefore the result is too
    low by about the fraction 2 lag / T. The theoretical value is Enskog's bulk viscosity.

    Parameters
    ----------
    source : str, Path or Dataset
        A trajectory with correlations of the stress (a path or an open trajectory).
    lag : float, [time], optional
        Longest time difference of the correlations that are summed. Default: the longest stored lag, with a
        warning if the sum clearly goes on to grow there.

    Returns
    -------
    Observable
        The viscosity, in [mass length^(2-d)/time], with the curves `green_kubo` and `helfand` (lag,).

    Raises
    ------
    SceneError
        Under the conditions of `shear_viscosity`.
    """
    with open_run(source, start) as run:
        return _coefficient(run, "bulk_viscosity", "bulk", lag)


def thermal_conductivity(source: Source, lag: float | None = None, start: float | None = None) -> Observable:
    """Measure the thermal conductivity.

    For a mixture the result is the conductivity without diffusion (see `conductivity_without_diffusion`).
    It is computed from the fluxes between frames, and the curves are absent. The time between frames must
    not exceed the lag. The theoretical value is Enskog's conductivity.

    Parameters
    ----------
    source : str, Path or Dataset
        A trajectory with correlations of the stress (a path or an open trajectory).
    lag : float, [time], optional
        Longest time difference of the correlations that are summed. Default: the longest stored lag.

    Returns
    -------
    Observable
        The conductivity, in [1/(length^(d-2) time)] with k_B = 1, and the curves as for `shear_viscosity`.

    Raises
    ------
    SceneError
        Under the conditions of `shear_viscosity`; also for a polydisperse species, and for single particles
        in a mixture.
    """
    with open_run(source, start) as run:
        if run.scene.alike:
            return _coefficient(run, "thermal_conductivity", "heat", lag)
        require_defined("thermal_conductivity", run.scene)
        run.require_all()
        settings = _read_settings(run)
        lags = _lags_until(settings, lag)
        return conductivity_without_diffusion(run, lags * settings.interval)


def pressure_tensor(source: Source, start: float | None = None) -> Observable:
    """Measure the components of the pressure tensor.

    In a sheared gas, velocities are relative to the flow. The theoretical value, for a gas at rest, follows
    from the equation of state.

    Parameters
    ----------
    source : str, Path or Dataset
        A trajectory with correlations of the stress (a path or an open trajectory).

    Returns
    -------
    Observable
        The components xx, xy ... (component,), in [mass/(length^(d-2) time^2)].

    Raises
    ------
    SceneError
        If the run has no correlations of the stress, or if there are fewer than 17 frames.
    """
    with open_run(source, start, sheared=True) as run:
        require_defined("pressure_tensor", run.scene)
        _read_settings(run)
        if len(run.time) <= LEAST_INTERVALS:
            raise SceneError("frames", len(run.time), f"an error needs {LEAST_INTERVALS + 1} or more")
        d, volume = run.dimension, math.prod(run.scene.container.lengths)
        rates = run.increments("stress_sum") / (volume * np.diff(run.time))[:, None, None]
        series = rates.reshape(len(rates), d * d).T
        means = [correlated_mean(values).estimate for values in series]
        names = np.array([a + b for a in "xyz"[:d] for b in "xyz"[:d]])
        return observable(
            "pressure_tensor",
            {"component": (names, {"long_name": "component"})},
            np.array([mean.value for mean in means]),
            np.array([mean.error for mean in means]),
            **describe("pressure_tensor", run, run.temperature),
        )


def _read_settings(run: Run) -> Correlations:
    """Return the settings of the stress correlations of a run. Raises SceneError if the run has none. Older
    versions of gaspart stored fluxes that are not relative to the centre of mass. A run of such a version is
    rejected if the gas moves as a whole.
    """
    text = run.data.attrs.get("correlations")
    settings = Correlations.from_json(text) if text else None
    if settings is None or not settings.stress:
        key, _, rule = KEPT["fluxes"]
        raise SceneError(key, text, rule)
    if "flux_velocity" not in run.data and _moves(run.scene, _initial(run)):
        rule = "has fluxes of absolute velocities, as of an older version, and the gas moves: run it again"
        raise SceneError("correlations", text, rule)
    return settings


def _moves(scene: Scene, state: State) -> bool:
    """Return True if the centre of mass moves fast enough to change a transport coefficient."""
    squares = (state.velocities - flow(scene, state.positions)) ** 2
    thermal = float((state.masses[:, None] * squares).mean())
    return float(state.masses.sum() * (drift_of(scene, state) ** 2).sum()) > _SLIGHT * thermal


def _initial(run: Run) -> State:
    """Return the state at the start of a trajectory."""
    seed = json.loads(run.data.attrs["seed"])
    state = initial_state(run.scene, tuple(seed) if isinstance(seed, list) else seed)
    if INITIAL[0] in run.data:
        state.positions, state.velocities = (run.data[name].values for name in INITIAL[:2])
    return state


def _response(run: Run, lag: float | None) -> Observable:
    """Measure the shear viscosity of a sheared gas from the transverse momentum flux."""
    _read_settings(run)
    scene, rate = run.scene, run.scene.shear_rate
    if lag is not None:
        raise SceneError("lag", lag, "is that of fluctuations at rest; a sheared gas responds without")
    assert rate, "see `conditions.shears`"
    carried = run.increments("stress_sum")[:, 1, 0]
    viscosity = -carried / (rate * scene.container.volume * np.diff(run.time))
    about = describe("shear_viscosity", run, run.temperature)
    about["long_name"] += ", response"
    return scalar("shear_viscosity", viscosity, run.time, **about)


def _coefficient(run: Run, public: str, name: str, lag: float | None) -> Observable:
    """Measure a transport coefficient from the correlations of a flux. `name` is the name of the flux in
    `trajectory.correlator.STRESS`.
    """
    require_defined(public, run.scene)
    settings = _read_settings(run)
    lags = _lags_until(settings, lag)
    running, slopes = (
        np.sum([form(run, part) for part in _PARTS.get(name, (name,))], axis=0)
        for form in (green_kubo, helfand)
    )
    if lag is None:
        _warn_of_rest(public, running, lags * settings.interval)
    about = describe(public, run, run.temperature)
    units = about["units"]
    result = scalar(public, running[:, lags], run.time[-len(running) - 1 :], **about)
    time = settings.interval * np.arange(running.shape[1])
    result["lag"] = ("lag", time, {"units": "time", "long_name": "lag"})
    curves = {"green_kubo": running, "helfand": slopes}
    for key, blocks in curves.items():
        values, errors = means_of(blocks)
        result[key] = ("lag", values, {"units": units, "long_name": f"{key} until this lag"})
        result[f"{key}_error"] = ("lag", errors, {"units": units, "long_name": "standard uncertainty"})
    return result


LEFT_OUT = 0.03
"""Part of a coefficient that longer lags would add, from which a warning is given."""


def _warn_of_rest(public: str, running: np.ndarray, lag: float) -> None:
    """Warn if the integral of a correlation function (blocks, lag) clearly grows beyond its last lag.

    If the growth of the second half of the lags decays exponentially, x is the ratio of the growths of the
    halves, and x^2 / (1 - x^2) of the integral is left out.
    """
    half = running.shape[1] // 2
    first, _ = means_of(running[:, half])
    growth, error = means_of(running[:, -1] - running[:, half])
    if first <= 0.0 or growth < 4.0 * error:
        return
    ratio = min(float(growth / first), 0.99)
    if (rest := ratio**2 / (1.0 - ratio**2)) > LEFT_OUT:
        warnings.warn(
            f"gaspart: {public}: correlations last longer than their longest lag, {lag:g}: "
            f"some {rest:.0%} more is left out; run with more lags",
            stacklevel=4,
        )


_PARTS = {"shear": ("shear", "rotational")}


def _lags_until(settings: Correlations, lag: float | None) -> int:
    """Return the index of the longest lag whose correlations are summed."""
    if lag is None:
        return settings.lags
    number = round(lag / settings.interval)
    if not 1 <= number <= settings.lags:
        longest = settings.lags * settings.interval
        raise SceneError("lag", lag, f"must be between {settings.interval:g} and {longest:g}")
    return number


def green_kubo(run: Run, name: str) -> np.ndarray:
    """Compute a transport coefficient from the correlation up to each lag, in each block. A block is an
    interval between frames. Only intervals in which pairs of samples of all lags end are used.
    """
    interval = _read_settings(run).interval
    products, _ = _blocks(run, name)
    return _scale(run, name) * interval * (np.cumsum(products, axis=1) - 0.5 * products[:, :1])


def helfand(run: Run, name: str) -> np.ndarray:
    """Compute a transport coefficient from the squared change of G over each lag, by block."""
    interval = _read_settings(run).interval
    _, squares = _blocks(run, name)
    time = interval * np.arange(squares.shape[1])
    return 0.5 * _scale(run, name) * squares / np.where(time > 0.0, time, np.nan)


def _scale(run: Run, name: str) -> float:
    """Return 1 / (V x); raise SceneError if nothing moves relative to the mean velocity."""
    if not run.temperature > 0.0:
        raise SceneError("temperature", run.temperature, "without motion no flux fluctuates")
    return 1.0 / (math.prod(run.scene.container.lengths) * run.temperature ** (2 if name == "heat" else 1))


def _blocks(run: Run, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the correlation of V J and the squared change of G for each block. Both arrays have the shape
    (B, lags). A nonzero mean of the flux is subtracted.
    """
    data: xr.Dataset = run.data
    samples = data["correlated_samples"].values
    lags = np.arange(data.sizes["lag"])
    pairs = np.diff(np.maximum(samples[:, None] - lags, 0.0), axis=0)
    complete = (pairs > 0.0).all(axis=1)
    pairs = pairs[complete]
    products, squares = (
        run.increments(f"{name}_{kind}_sum")[complete] / pairs for kind in ("product", "square")
    )
    if name == "bulk":  # same pairs: the mean is much larger than the fluctuations
        ends, change = (run.increments(f"bulk_{kind}_sum")[complete] / pairs for kind in ("ends", "change"))
        stress, time = data["stress_sum"].values, float(data["lag"][1]) * lags
        mean = np.trace(stress[-1] - stress[0]) / (run.dimension * (run.time[-1] - run.time[0]))
        products = products - 2.0 * mean * ends + mean**2
        squares = squares - 2.0 * mean * time * change + (mean * time) ** 2
    return products, squares
