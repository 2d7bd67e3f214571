"""The diffusion coefficient: where there is one, and where there is none."""

import pytest

import gaspart as gp
from gaspart.analysis.run import open_run

A = gp.analysis
SPHERES = [gp.Species(200, 0.5, temperature=1.0)]
DISCS = [gp.Species(150, 0.5, temperature=1.0)]
CUBE = (8.1, 8.1, 8.1)


def run(path, scene, duration=60.0, interval=0.2, seed=1):
    return gp.run(scene, gp.EventDriven(), seed, duration, interval, path / "run.nc", displacements=True)


def test_particles_between_walls_on_all_sides_have_none(tmp_path):
    path = run(tmp_path, gp.Scene(gp.Container(CUBE), SPHERES), 12.0)
    with pytest.raises(gp.SceneError, match="has no periodic axis"):
        A.diffusion_coefficient(path)
    assert float(A.mean_squared_displacement(path).estimate[-1]) > 0.0  # a bounded one


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


def test_a_slope_that_falls_is_no_coefficient(tmp_path):
    """Discs in cages of interior walls, in a periodic container."""
    lines = [((0.0, y), (30.0, y)) for y in (0.0, 15.0)] + [((x, 0.0), (x, 30.0)) for x in (0.0, 15.0)]
    scene = gp.Scene(gp.Container((30.0, 30.0), "periodic"), DISCS, walls=[gp.Wall(*line) for line in lines])
    with pytest.raises(gp.SceneError, match="slope of the squared displacement, over 2, changes from"):
        A.diffusion_coefficient(run(tmp_path, scene, 100.0))


@pytest.mark.parametrize("side", [6.3, 8.1, 22.0])
def test_a_fluid_of_spheres_is_not_refused(tmp_path, side):
    gas = gp.Species(200, 0.5, temperature=1.0, arrangement="lattice")
    scene = gp.Scene(gp.Container((side,) * 3, "periodic"), [gas])
    duration = {6.3: 15.0, 8.1: 60.0, 22.0: 1000.0}[side]
    for seed in range(3):
        (tmp_path / str(seed)).mkdir()
        found = A.diffusion_coefficient(
            run(tmp_path / str(seed), scene, duration, duration / 300.0, seed), start=0.0
        )
        assert abs(float(found.deviation)) < 4.0


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
