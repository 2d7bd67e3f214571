"""What is read of vibrated beds: exactly, and what comes out of a small one."""

import math

import numpy as np
import pytest
from reproduction.families.granular.test_measure import made

import gaspart as gp
from gaspart import theory
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.families.vibrated import measure

SETTINGS = {"bins": 8, "highest": 4.0}


def bed(waveform, count=20):
    """Discs that are heated by a floor of the speed 1."""
    return gp.Scene(
        gp.Container((10.0, 400.0), ("periodic", "wall")),
        [gp.Species(count, 0.5, temperature=20.0)],
        gravity=(0.0, -1.0),
        restitution=gp.Restitution(0.9, contact_duration=0.0),
        faces={"y_low": gp.Vibrating(0.05, 0.1, waveform)},
    )


def test_the_flows_of_energy_and_the_profile_of_a_bed(tmp_path):
    """A sawtooth gives its speed times the weight; what it gives is lost in contacts."""
    point = made(tmp_path, "bed", bed("sawtooth"), duration=600.0, samples=60, equilibration=200.0)
    ds = measure.vibrated_bed([point], SETTINGS).isel(bed=0)
    assert (ds["sine"], ds["restitution"], ds["layers"], ds["speed"]) == (0, 0.9, 1.9, pytest.approx(1.0))
    assert ds["packing_fraction"] == pytest.approx(0.25 * np.pi * 2.0 / ds["temperature"])
    assert ds["given"] == pytest.approx(1.0, abs=4.0 * float(ds["given_error"]) + 1e-3)
    assert ds["given_error"] < 0.05
    assert ds["lost"] == pytest.approx(float(ds["given"]), abs=0.1)
    height = theory.bed_height(float(ds["packing_fraction"]))
    assert ds["height"] == pytest.approx(height, abs=4.0 * float(ds["height_error"]) + 0.1)
    assert 2.0 < ds["temperature"] < 20.0
    assert float(ds["density"].sum() * 0.5) == pytest.approx(1.0, abs=0.1)
    assert ds["density"][0] > 2.0 * ds["density"][4] > 0.0


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
    run = next(measure.means(one, SETTINGS) for one in runs(point))
    falls = 0.5 * 2e-3**2  # mean square of the speed of the fall, 0 and then 2e-3
    assert run["temperature"] == pytest.approx(0.5 * (5.0 + falls), rel=1e-6)
    assert run["height"] == pytest.approx(50.0 * 2.0 / falls, rel=1e-3)
    assert run["given"] == run["lost"] == 0.0
    assert np.array_equal(run["density"], np.zeros(8))  # all above 4 T/g
    ds = measure.vibrated_bed([point], SETTINGS)
    assert ds["speed"].item() == pytest.approx(0.05 * 2.0 * math.pi / 0.1 / math.sqrt(2.0))
    assert ds["sine"].item() == 1
