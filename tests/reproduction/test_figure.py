import os

import numpy as np
import pytest
from reproduction.made import simulated

from gaspart import theory
from gaspart.errors import SceneError
from gaspart.reproduction.figure import (
    COUNTED,
    Series,
    combine,
    content_key,
    pressure,
    runs,
    series_of,
)
from gaspart.reproduction.points.point import Point


def small_point(tmp_path, **settings):
    values = {
        "dimension": 2, "count": 64, "radius": 0.5, "packing_fraction": 0.2, "boundary": "periodic",
        "temperature": 2.0, "collisions_per_particle": 400, "equilibration": 20, "samples": 40, "replicas": 2,
    }  # fmt: skip
    return Point("test", "single", "simulate", values | settings, str(tmp_path), 7)


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    point = small_point(tmp_path_factory.mktemp("points"))
    simulated(point)
    return point, pressure(point)


@pytest.mark.parametrize("kept", [{"follow": 1}, {"keep": "positions"}])
def test_of_an_exact_temperature_neither_all_particles_nor_velocities_are_needed(tmp_path, kept):
    """Sums and energies are of all, and the centre of mass is at rest."""
    settings = {"exact_temperature": True, "collisions_per_particle": 20, "replicas": 1}
    whole, part = small_point(tmp_path / "a", **settings), small_point(tmp_path / "b", **settings, **kept)
    for point in (whole, part):
        simulated(point)
    (expected,), (found,) = ([series_of(run) for run in runs(point)] for point in (whole, part))
    assert found.z == pytest.approx(expected.z, rel=1e-9)
    assert found.rate == pytest.approx(expected.rate, rel=1e-9)
    drawn = small_point(tmp_path / "c", **settings | {"exact_temperature": False}, **kept)
    simulated(drawn)
    with pytest.raises(SceneError, match=next(iter(kept))):
        [series_of(run) for run in runs(drawn)]


def test_z_of_a_small_gas_is_the_canonical_one(measured):
    _, found = measured
    expected = theory.compressibility_factor(0.2, 2)
    expected += theory.finite_size_correction(0.2, 2, 64, ensemble="canonical")
    assert found.z.error < 0.01
    assert abs((found.z - expected).deviation) < 4.0


def test_the_error_is_nearly_that_of_independent_collisions(measured):
    _, found = measured
    expected = (found.z.value - 1.0) / np.sqrt(found.counters["collisions"])
    assert 0.6 < found.z.error / expected < 1.8


def test_collision_rate_is_enskogs(measured):
    _, found = measured
    expected = theory.collision_rate(0.2, 2) * theory.collision_rate_finite_size_factor(0.2, 2, 64)
    assert abs((found.collision_rate - expected).deviation) < 4.0


def test_equilibration_is_dropped(measured):
    point, _ = measured
    one = next(map(series_of, runs(point)))
    assert len(one.z) == point.settings["samples"]


def test_a_file_of_another_point_is_refused(measured):
    point, _ = measured
    other = Point.from_dict(point.to_dict() | {"settings": point.settings | {"samples": 30}}, point.path)
    with pytest.raises(ValueError, match="frames are not those"):
        pressure(other)


def made_up(mean, spread, seed, samples=64):
    rng = np.random.default_rng(seed)
    z = mean + spread * rng.standard_normal(samples)
    counters = dict.fromkeys(COUNTED, np.ones(samples))
    return Series(z=z, rate=z, interval=1.0, counters=counters, speed=1.0)


def test_replicas_that_agree_have_a_small_chi_square_and_others_do_not():
    alike = combine([made_up(2.0, 0.1, seed) for seed in range(6)])
    assert alike.degrees_of_freedom == 5 and alike.chi_square < 20.0
    assert alike.z.error == pytest.approx(0.1 / np.sqrt(6 * 64), rel=0.2)
    apart = combine([made_up(2.0 + 0.1 * seed, 0.1, seed) for seed in range(6)])
    assert apart.chi_square > 40.0  # 5 degrees of freedom: a chance of 1e-7
    assert alike.counters["collisions"] == 6 * 64


def test_a_key_of_content_follows_files_and_settings_alone(tmp_path):
    folder, file = tmp_path / "point", tmp_path / "point.nc"
    folder.mkdir()
    (folder / "replica-0.nc").write_bytes(b"frames")
    file.write_bytes(b"numbers")
    key = content_key([folder, file], {"bins": 3})
    os.utime(file, (0, 0))
    assert content_key([folder, file], {"bins": 3}) == key
    assert content_key([file, folder], {"bins": 3}) != key != content_key([folder, file], {"bins": 4})
    (folder / "replica-0.nc").write_bytes(b"other frames")
    assert content_key([folder, file], {"bins": 3}) != key
