"""Piles, flows and vibrated beds: what is read of small ones, and of frames that are known exactly."""

import math

import numpy as np
import pytest
from reproduction.made import made

import gaspart as gp
from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.figure import runs
from gaspart.reproduction.figures.beds import (
    bed_means,
    count_contacts,
    fit_discharge,
    measure_beds,
    measure_settling,
)

SETTLING = {"gap": 1e-3, "start": 0.8, "head": 0.6}


def hopper(width):
    """80 discs above an orifice of this width in the floor of a hopper, 10 wide."""
    region = ((0.0, 200.0), (10.0, 214.0))
    ends = 5.0 - 0.5 * width, 5.0 + 0.5 * width
    return gp.Scene(
        gp.Container((10.0, 214.0)),
        [gp.Species(80, 0.5, region=region)],
        gravity=(0.0, -1.0),
        restitution=gp.Restitution(0.5, 0.0, 0.01),
        walls=[gp.Wall((0.0, 200.0), (ends[0], 200.0)), gp.Wall((ends[1], 200.0), (10.0, 200.0))],
    )


def test_contacts_are_those_of_discs_and_walls():
    """Three discs in a row, the first in a corner; the gap to the third is 0.01."""
    scene = gp.Scene(gp.Container((10.0, 10.0)))
    positions = np.array([[0.5, 0.5], [1.5, 0.5], [2.51, 1.0]])
    radii = np.full(3, 0.5)
    assert count_contacts(scene, positions, radii, 1e-6) == 3 + 1
    apart = math.hypot(1.01, 0.5) - 1.0
    assert count_contacts(scene, positions, radii, 1.01 * apart) == 5
    assert count_contacts(scene, positions, radii, 0.99 * apart) == 4


@pytest.mark.thorough
def test_the_rate_of_flow_is_that_at_which_discs_become_fewer(tmp_path):
    settings = {"duration": 30.0, "samples": 120, "boxes_per_side": [8, 140], "replicas": 2}
    points = [made(tmp_path, f"hopper{width:g}", hopper(width), **settings) for width in (3.0, 4.0, 5.0)]
    ds = measure_settling(points, SETTLING)
    assert ds["width"].values == pytest.approx([3.0, 4.0, 5.0])
    assert (np.diff(ds["rate"]) > 0.0).all() and (ds["rate_error"] < 0.2 * ds["rate"]).all()
    for n in range(3):
        time, left = ds["flow_time"][n].values, ds["left"][n].values
        assert left[0] == 80 and left[-1] < 20
        timed = (left < 64) & (left > 40)
        slope = np.polyfit(time[timed], left[timed], 1)[0]
        assert ds["rate"][n] == pytest.approx(-slope, rel=0.3)


def test_a_law_is_fitted_to_its_own_numbers():
    width = np.array([4.0, 6.0, 9.0, 14.0])
    found = fit_discharge(width, Estimate(np.log(0.7 * (width - 1.2) ** 1.3), 0.01, 5))
    assert found["exponent"] == pytest.approx(1.3, abs=1e-4)
    assert found["offset"] == pytest.approx(1.2, abs=1e-3)
    assert found["amplitude"] == pytest.approx(0.7, rel=1e-3)
    assert found["chi_square"] > 1.0
    found = fit_discharge(width, Estimate(np.log(0.7 * (width - 1.2) ** 1.5), 0.01, 5))
    assert found["beverloo_offset"] == pytest.approx(1.2, abs=1e-4)
    assert found["chi_square"] < 1e-6


BED = {"bins": 8, "highest": 4.0}


@pytest.mark.interpreted
def test_a_frame_of_known_places_and_velocities(tmp_path):
    """Two discs at rest beside one another that fall from a known height, far above the floor."""
    particles = [gp.Particle((2.0 + 4.0 * n, 50.5), ((3.0, -1.0)[n], 0.0), 0.5) for n in range(2)]
    scene = gp.Scene(
        gp.Container((10.0, 400.0), ("periodic", "wall")),
        particles=particles,
        species=[gp.Species(0, 0.5)],
        gravity=(0.0, -2.0),
        restitution=gp.Restitution(0.9, contact_duration=0.0),
        faces={"y_low": gp.Vibrating(0.05, 0.1)},
    )
    point = made(tmp_path, "fall", scene, duration=1e-3, samples=1, replicas=2)
    run = next(bed_means(one, BED) for one in runs(point))
    falls = 0.5 * 2e-3**2  # mean square of the speed of the fall, 0 and then 2e-3
    assert run["temperature"] == pytest.approx(0.5 * (5.0 + falls), rel=1e-6)
    assert run["height"] == pytest.approx(50.0 * 2.0 / falls, rel=1e-3)
    assert run["given"] == run["lost"] == 0.0
    assert np.array_equal(run["density"], np.zeros(8))  # all above 4 T/g
    ds = measure_beds([point], BED)
    assert ds["speed"].item() == pytest.approx(0.05 * 2.0 * math.pi / 0.1 / math.sqrt(2.0))
    assert ds["sine"].item() == 1
