"""The diffusion coefficient: where there is one, and where there is none."""

import math
from functools import partial

import numpy as np
import pytest
from scenes import centred, gas
from scipy.signal import lfilter

import gaspart as gp
from gaspart import theory
from gaspart.analysis import diffusion
from gaspart.analysis.motion import autocorrelation, correlate, squared_displacement
from gaspart.analysis.run import open_run
from gaspart.errors import SceneError

A = gp.analysis
SPHERES = [gp.Species(200, 0.5, temperature=1.0)]
DISCS = [gp.Species(150, 0.5, temperature=1.0)]
CUBE = (8.1, 8.1, 8.1)


def run(path, scene, duration=60.0, interval=0.2, seed=1):
    return gp.run(scene, gp.EventDriven(), seed, duration, interval, path / "run.nc", displacements=True)


@pytest.mark.parametrize(
    ("boundary", "axes"), [(("periodic", "periodic", "wall"), "xy"), (("wall", "periodic", "wall"), "y")]
)
def test_it_exists_along_periodic_axes(tmp_path, boundary, axes):
    found = A.diffusion_coefficient(run(tmp_path, gp.Scene(gp.Container(CUBE, boundary), SPHERES)))
    assert list(found["axis"].values) == list(axes)
    # at most that of the same volume without walls, .37, as the density between the layers at walls is higher
    assert ((found.estimate > 0.24) & (found.estimate < 0.38)).all()
    assert ((found.error > 0.0) & (found.error < 0.03)).all()


def test_one_obstacle_does_not_give_discs_a_coefficient(tmp_path):
    container = gp.Container((30.0, 30.0), "periodic")
    post = gp.Particle((15.0, 15.0), (0.0, 0.0), 0.5, fixed=True)
    for particles in ([], [post]):
        (tmp_path / str(len(particles))).mkdir()
        path = run(tmp_path / str(len(particles)), gp.Scene(container, DISCS, particles), 150.0, 0.5)
        with pytest.raises(gp.SceneError, match="discs have no diffusion coefficient"):
            A.diffusion_coefficient(path)


def test_discs_among_many_obstacles_have_one(tmp_path):
    species = [*DISCS, gp.Species(50, 0.5, fixed=True)]
    found = A.diffusion_coefficient(
        run(tmp_path, gp.Scene(gp.Container((30.0, 30.0), "periodic"), species), 120.0)
    )
    assert found.estimate.ndim == 0 and 0.5 < float(found.estimate) < 0.9


@pytest.mark.thorough
def test_a_slope_that_falls_is_no_coefficient(tmp_path):
    """Discs in cages of interior walls, in a periodic container."""
    lines = [((0.0, y), (30.0, y)) for y in (0.0, 15.0)] + [((x, 0.0), (x, 30.0)) for x in (0.0, 15.0)]
    scene = gp.Scene(gp.Container((30.0, 30.0), "periodic"), DISCS, walls=[gp.Wall(*line) for line in lines])
    with pytest.raises(gp.SceneError, match="slope of the squared displacement, over 2, changes from"):
        A.diffusion_coefficient(run(tmp_path, scene, 100.0))


def test_the_zero_momentum_along_each_axis_is_allowed_for(tmp_path):
    """<v^2> / d of few particles in a slit is kT / m, as without the condition on two of the axes."""
    scene = gp.Scene(
        gp.Container((5.0,) * 3, ("periodic", "periodic", "wall")), [gp.Species(16, 0.5, speed=1.0)]
    )
    path = gp.run(scene, gp.EventDriven(), 1, 2000.0, 1.0, tmp_path / "a.nc")
    with open_run(path, None) as part:
        temperature = part.temperature
    found = A.velocity_autocorrelation(path, lags=2).estimate
    assert float(found[0]) == pytest.approx(temperature, rel=0.01)  # 2/3 of a 16th is .04


def test_frames_too_far_apart_are_named(tmp_path):
    scene = gp.Scene(gp.Container(CUBE, "periodic"), SPHERES)
    path = gp.run(scene, gp.EventDriven(), 1, 48.0, 12.0, tmp_path / "a.nc", displacements=True)
    with pytest.raises(gp.SceneError, match=r"sample_interval = 12.0: is too long: frames .* apart"):
        A.diffusion_coefficient(path, start=0.0)


def test_the_error_of_a_mixture_falls_with_the_length_of_the_run(tmp_path):
    """Its groups have the same composition: light particles diffuse faster than heavy ones."""
    species = [gp.Species(64, 0.5, mass=mass, temperature=1.0) for mass in (1.0, 4.0)]
    path = run(tmp_path, gp.Scene(gp.Container(CUBE, "periodic"), species), 640.0, 1.0)
    fast, slow = (A.diffusion_coefficient(path, species=n).estimate for n in (0, 1))
    assert fast > 1.2 * slow
    both = A.diffusion_coefficient(path)
    assert float(both.estimate) == pytest.approx(float(fast + slow) / 2.0, rel=0.02)
    difference = float(fast - slow) / 2.0 / 4.0  # its standard error if each of 16 groups were of one species
    assert float(both.error) < 0.6 * difference


# Mutual diffusion of two species.


def _scene(eta, *kinds, dimension=3, boundary="periodic"):
    volume = sum(
        kind.count * theory.particle_volume(dimension) * (2.0 * kind.radius) ** dimension for kind in kinds
    )
    return gp.Scene(gp.Container(((volume / eta) ** (1.0 / dimension),) * dimension, boundary), kinds)


def _kind(count, radius=0.5, mass=1.0):
    return gp.Species(count, radius, mass=mass, temperature=1.0, exact_temperature=True)


def _run(scene, path, seed, collisions, engine=None):
    kinds = scene.species
    rates = theory.mixture_collision_rates(
        scene.packing_fraction,
        3,
        [2.0 * kind.radius for kind in kinds],
        [kind.count for kind in kinds],
        masses=[kind.mass for kind in kinds],
    )
    each = float(np.average(rates.sum(axis=1), weights=[kind.count for kind in kinds]))
    return gp.run(
        scene, engine or gp.EventDriven(), seed, collisions / each, 1.0 / each, path, displacements=True
    )


@pytest.mark.thorough
def test_dilute_gas_of_unequal_masses(tmp_path):
    """Chapman and Enskog's value, to which higher approximations add some 3 %."""
    scene = _scene(0.01, _kind(100), _kind(100, mass=8.0))
    found = [gp.analysis.mutual_diffusion(_run(scene, tmp_path / f"{n}.nc", n, 3000.0)) for n in range(4)]
    ratios = [float(one.estimate / one.theory) for one in found]
    scatter = np.mean([float(one.error / one.theory) ** 2 for one in found]) ** 0.5
    assert scatter < 0.12
    assert np.mean(ratios) == pytest.approx(1.015, abs=3.0 * scatter / 2.0 + 0.015)


def _last(path, run):
    return path[-len(run.time) :]


def test_lags_are_those_from_which_on_the_coefficient_no_longer_changes(tmp_path, monkeypatch):
    """Separations whose velocity is correlated over 10 frames, a collision each: at 12 to 24, .825 of D."""
    path = _run(_scene(0.05, _kind(4), _kind(4)), tmp_path / "a.nc", 1, 6000.0)
    decay, values, lags = math.exp(-0.1), [], []
    for seed in range(6):
        kicks = np.random.default_rng(seed).normal(size=(9000, 3))
        separations = np.cumsum(lfilter([1.0], [1.0, -decay], kicks, axis=0), axis=0)
        monkeypatch.setattr(diffusion, "_separation", partial(_last, separations))
        result = gp.analysis.mutual_diffusion(path)
        values.append(float(result.estimate))
        lags.append(float(result.attrs["lags"][1]))
        with gp.open_trajectory(path) as run:
            interval = float(run["time"][1])
    exact = 0.25 * 8.0 / 2.0 / (1.0 - decay) ** 2 / interval  # N x_1 x_2 times half of the slope per axis
    assert np.mean(values) / exact == pytest.approx(0.97, abs=0.1)
    assert np.mean(values) / exact > 0.89 and np.mean(lags) / interval > 35.0


@pytest.mark.parametrize("dimension", [2, 3])
def test_theory_of_species_alike_is_that_of_self_diffusion(dimension):
    """Enskog's D in the first approximation: 3/(8 n sigma^2 g) and 1/(2 n sigma g) sqrt(kT / (pi m))."""
    eta, mass, temperature = 0.25, 3.0, 2.0
    found = theory.enskog_mutual_diffusion(
        eta, dimension, [1.0, 1.0], [1, 3], temperature=temperature, masses=mass
    )
    contact = float(theory.contact_value(eta, dimension))
    density = float(theory.number_density(eta, dimension))
    factor = {2: 0.5, 3: 0.375}[dimension]
    expected = factor / (density * contact) * math.sqrt(temperature / (math.pi * mass))
    assert found == pytest.approx(expected, rel=1e-9)


def test_theory_refuses_three_species():
    with pytest.raises(SceneError, match="that of two species"):
        theory.enskog_mutual_diffusion(0.1, 3, [1.0, 1.0, 1.0])


# Time correlations by Fourier transforms, against the sums over particles and time origins.


SHAPES = [(2, 1, 2), (3, 5, 3), (30, 7, 2), (257, 100, 3)]
"""Frames, particles and dimensions, of which the last ones fill more than a block."""


def paths(shape, kind):
    rng = np.random.default_rng(3)
    noise = rng.normal(size=shape)
    return {
        "diffusive": noise.cumsum(axis=0),
        "far from the origin": noise.cumsum(axis=0) + 1e6 * rng.normal(size=shape[1:]),
        "ballistic": noise[:1] * np.arange(float(shape[0]))[:, None, None],
        "at rest": np.broadcast_to(noise[:1], shape),
    }[kind]


def summed(path, lags):
    return np.array(
        [((path[lag:] - path[: len(path) - lag]) ** 2).sum(axis=-1).mean() for lag in range(lags)]
    )


@pytest.mark.parametrize("kind", ["diffusive", "far from the origin", "ballistic", "at rest"])
@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_squared_displacements_are_the_sums_to_ten_digits(shape, kind):
    path = paths(shape, kind)
    expected = summed(path, shape[0])
    assert squared_displacement(path, shape[0]) == pytest.approx(expected, rel=1e-10, abs=1e-20)


def test_short_lags_keep_their_digits_among_long_ways():
    """Particles that hardly move for a while and then fly."""
    path = paths((400, 20, 3), "diffusive") * 1e-4
    path[200:] += 1e3 * paths((200, 20, 3), "ballistic")
    assert squared_displacement(path, 300)[1:] == pytest.approx(summed(path, 300)[1:], rel=1e-10)
    still = path[:200]
    assert squared_displacement(still, 150)[1:] == pytest.approx(summed(still, 150)[1:], rel=1e-10)


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_autocorrelations_are_the_means_of_products(shape):
    values = np.random.default_rng(5).normal(size=shape)
    found = autocorrelation(values, shape[0])
    expected = [np.mean(values[: shape[0] - lag] * values[lag:]) for lag in range(shape[0])]
    assert found == pytest.approx(np.array(expected), abs=1e-13)


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_the_derivative_of_the_msd_is_the_mean_of_its_products(shape):
    r, v = paths(shape, "diffusive"), np.random.default_rng(6).normal(size=shape)
    found = correlate(r, v, 0.5, shape[0])
    for lag in range(shape[0]):
        moved, both = r[lag:] - r[: shape[0] - lag], v[lag:] + v[: shape[0] - lag]
        expected = (moved * both).sum(axis=-1).mean() / (2 * shape[2])
        assert found.running[lag] == pytest.approx(expected, abs=1e-11 * (1.0 + abs(r).max()))


# Displacements and velocity correlations of a run with correlations: those that it has accumulated.


INTERVAL, LAGS = 0.25, 6


def accumulated_run(path, scene, **change):
    """Of 80 samples, with a frame at each of them."""
    own = {"duration": 20.0, "sample_interval": INTERVAL, "displacements": True}
    asked = gp.Correlations(INTERVAL, LAGS)
    return gp.run(scene, gp.EventDriven(), 3, path=path, correlations=asked, **{**own, **change})


def discs(boundary="periodic"):
    """40 of them at a packing fraction of 0.1."""
    side = (40 * np.pi / 4 / 0.1) ** 0.5
    return gp.Scene(
        gp.Container((side, side), boundary), [gp.Species(40, 0.5, temperature=2.0, exact_temperature=True)]
    )


@pytest.mark.parametrize("start", [None, 0.0, 12.5])
def test_they_are_means_over_pairs_of_samples_that_end_in_the_measured_part(tmp_path, start):
    path = accumulated_run(tmp_path / "run.nc", discs())
    found = A.mean_squared_displacement(path, start=start)
    with gp.open_trajectory(path) as data:
        moved, time = centred(data["displacements"].values), data["time"].values
    first = max(LAGS, int(np.flatnonzero(time >= (5.0 if start is None else start))[0]))
    for lag in range(LAGS + 1):
        ends = np.arange(first + 1, len(time))
        squares = ((moved[ends] - moved[ends - lag]) ** 2).sum(axis=2).mean(axis=1)
        expected = squares.mean() * 40.0 / 39.0
        assert float(found.estimate[lag]) == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert found["lag"].values == pytest.approx(INTERVAL * np.arange(LAGS + 1))
    assert (found.error.values[1:] > 0.0).all() and found.theory is not None


def test_between_walls_nothing_is_taken_off(tmp_path):
    """Of two walls momentum is conserved along one axis, of four along none."""
    found = A.velocity_autocorrelation(accumulated_run(tmp_path / "closed.nc", discs("wall")))
    assert float(found.estimate[0]) == pytest.approx(2.0, rel=1e-9)
    found = A.velocity_autocorrelation(accumulated_run(tmp_path / "slit.nc", discs(("periodic", "wall"))))
    with gp.open_trajectory(tmp_path / "slit.nc") as data:
        velocities = data["velocities"].values[data["time"].values > 5.0].astype(float)
    velocities[..., 0] -= velocities[..., 0].mean(axis=1, keepdims=True)
    free = (velocities[..., 0] ** 2).mean() * 40.0 / 39.0 + (velocities[..., 1] ** 2).mean()
    assert float(found.estimate[0]) == pytest.approx(0.5 * free, rel=1e-6)


def test_the_lags_of_frames_remain_within_reach(tmp_path):
    """By a number of lags, or a choice of particles."""
    path = accumulated_run(tmp_path / "run.nc", discs())
    assert A.velocity_autocorrelation(path, lags=3).sizes["lag"] == 3
    assert A.mean_squared_displacement(path, species=0).sizes["lag"] > LAGS + 1
    assert A.mean_squared_displacement(path, per_axis=True).estimate.dims == ("axis", "lag")


def test_few_particles_in_the_file_change_nothing_but_the_theory(tmp_path):
    whole, followed = (accumulated_run(tmp_path / f"{n}.nc", discs(), follow=n) for n in (40, 1))
    for function in (A.velocity_autocorrelation, A.mean_squared_displacement):
        found, other = function(whole), function(followed)
        assert found.theory is not None and other.theory is None
        assert np.array_equal(found.estimate, other.estimate) and np.array_equal(found.error, other.error)


@pytest.mark.parametrize("mass", [1.0, pytest.param(3.0, marks=pytest.mark.thorough)])
def test_errors_are_those_of_independent_runs(tmp_path, mass):
    """By the mean over lags of the squared scatter of 24 runs of one energy."""
    kinds = [(30, 1.0), (10, mass)]
    species = [gp.Species(n, 0.5, mass=m, temperature=1.0, exact_temperature=True) for n, m in kinds]
    scene = gp.Scene(discs().container, species)
    values, squares = [], []
    for seed in range(24):
        path = tmp_path / f"{seed}.nc"
        gp.run(scene, gp.EventDriven(), (4, seed), 160.0, 2.5, path, correlations=gp.Correlations(0.25, 6))
        found = A.velocity_autocorrelation(path)
        values.append(found.estimate.values)
        squares.append(found.error.values**2)
    ratio = np.mean(squares) / np.var(values, axis=0, ddof=1).mean()
    assert 0.5 < ratio < 2.0


def test_too_few_frames_are_refused(tmp_path):
    path = accumulated_run(tmp_path / "run.nc", discs(), sample_interval=1.25)
    with pytest.raises(gp.SceneError, match="frames = 13: an error needs 17 with samples at all lags"):
        A.velocity_autocorrelation(path)


# Displacement and diffusion along each axis.


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    return gp.run(gas(3, 256, 0.2), gp.EventDriven(), 4, 60.0, 0.25, folder / "run.nc", displacements=True)


def test_displacements_along_axes_sum_to_the_whole(path):
    whole = gp.analysis.mean_squared_displacement(path, lags=20)
    found = gp.analysis.mean_squared_displacement(path, lags=20, per_axis=True)
    assert found.estimate.dims == ("axis", "lag") and list(found["axis"].values) == ["x", "y", "z"]
    assert np.allclose(found.estimate.sum("axis"), whole.estimate, rtol=1e-10)
    assert np.allclose(found.theory.sum("axis"), whole.theory)
    with gp.open_trajectory(path) as data:
        moved = data["displacements"].values[60:]
    moved = moved - moved.mean(axis=1, keepdims=True)  # about the centre of mass
    lag = ((moved[5:] - moved[:-5]) ** 2).mean(axis=(0, 1)) * 256 / 255
    assert np.allclose(found.estimate.isel(lag=5), lag, rtol=1e-6)


def test_diffusion_along_axes_has_the_mean_of_all_and_agrees_with_theory(path):
    whole = gp.analysis.diffusion_coefficient(path)
    found = gp.analysis.diffusion_coefficient(path, per_axis=True)
    assert found.estimate.dims == ("axis",) and found.estimate.size == 3
    assert float(found.estimate.mean()) == pytest.approx(float(whole.estimate), rel=1e-10)
    assert (abs(found.deviation) < 4.0).all()
    assert (found.error > whole.error).all()
