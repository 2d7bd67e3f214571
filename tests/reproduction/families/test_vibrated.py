"""Made-up vibrated beds with known answers, in the form that `measure.vibrated_bed` gives."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr
from reproduction.families.drawn import Points, column, draw, shows
from reproduction.families.judged import verdicts
from reproduction.families.test_granular import made

import gaspart as gp
from gaspart import theory
from gaspart.reproduction.families.beds import figure, measure
from gaspart.reproduction.families.beds.claims import expected_temperature, small_parameter, vibrated_bed
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.table import Table


def beds(limit=1.0, given=1.0, lost=1.0, height=1.0, restitutions=(0.99, 0.98, 0.95, 0.9)):
    """Beds of both kinds whose temperature over theory's is `limit` - 0.5 x + 0.2 x^2; energies and height
    over theory's."""
    e = np.array([*restitutions] * 2)
    sine = np.repeat([0, 1], len(restitutions))
    place = np.arange(0.25, 4.0, 0.5)
    known = {"sine": sine, "restitution": e, "layers": np.full(e.size, 2.0), "speed": 0.3 + 0.1 * sine}
    known["packing_fraction"] = np.full(e.size, 0.008)
    ds = xr.Dataset({key: ("bed", values) for key, values in known.items()}, {"place": ("bin", place)})
    x, unit = small_parameter(Table(ds, "bed")), expected_temperature(Table(ds, "bed"))
    columns = {
        "temperature": (limit - 0.5 * x + 0.2 * x**2) * unit,
        "temperature_error": 0.003 * unit,
        "given": given * known["speed"],
        "given_error": 0.001 * known["speed"],
        "lost": lost * given * known["speed"],
        "lost_error": 0.002 * known["speed"],
        "height": np.full(e.size, 1.008 * height),
        "height_error": np.full(e.size, 0.004),
    }
    density = np.tile(np.exp(-place), (e.size, 1))
    profile = {"density": density, "density_error": 0.05 * density}
    return ds.assign(
        {key: ("bed", values) for key, values in columns.items()}
        | {key: (("bed", "bin"), values) for key, values in profile.items()}
    )


# What is read of vibrated beds: exactly, and what comes out of a small one.


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


def test_right_data_agree():
    claims = vibrated_bed(beds())
    assert verdicts(claims) == {"agrees"}
    assert len(claims) == 2 + 4 * 3 + 4 * 2


@pytest.mark.parametrize(
    ("wrong", "claim"),
    [
        ({"limit": 1.06}, "temperature"),
        ({"given": 1.01}, "energy given"),
        ({"lost": 1.05}, "energy lost"),
        ({"height": 0.95}, "mean height"),
    ],
)
def test_wrong_data_disagree(wrong, claim):
    claims = vibrated_bed(beds(**wrong))
    assert verdicts(claims, claim) == {"disagrees"}
    assert verdicts([one for one in claims if not one.claim.startswith(claim)]) == {"agrees"}


def test_two_beds_have_no_limit():
    claims = vibrated_bed(beds(restitutions=(0.95, 0.9)))
    assert not [claim for claim in claims if claim.claim.startswith("temperature")]
    assert verdicts(claims) == {"agrees"}


def test_temperatures_and_profiles():
    ds = beds(limit=1.02)
    upper, lower = draw(figure.vibrated_bed, ds).axes
    temperatures, profiles = [], []
    for kind in range(2):
        own = ds.isel(bed=(ds["sine"] == kind).values)
        unit = expected_temperature(Table(own, "bed"))
        measured = own["temperature"] / unit, own["temperature_error"] / unit
        temperatures.append(Points(small_parameter(Table(own, "bed")), *measured))
        profiles.append(column(own.isel(bed=0), "place", "density"))  # the most elastic one
    shows(upper, *temperatures)
    shows(lower, *profiles)
