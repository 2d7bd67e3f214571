"""Made-up piles and flows with known answers, in the form that `measure.settling` gives."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr
from reproduction.families.drawn import Points, draw, follows, shows
from reproduction.families.test_driven_gas import verdicts
from reproduction.families.test_granular import made

import gaspart as gp
from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.families.beds import figure, measure
from gaspart.reproduction.families.beds.claims import settling
from gaspart.reproduction.families.beds.measure import _fit

WIDTH = np.array([4.0, 6.0, 9.0, 14.0])


def settled(exponent=1.5, head=1.0, contacts=2.0, displacement=0.0, rise=0.0, residual=0.1, spread=0.01):
    """Six piles, with two durations of contacts, and four flows."""
    time = np.tile(np.linspace(0.0, 20.0, 21), (6, 1))
    kinetic = np.where(time < 15.0, np.exp(-time), 0.0)
    rate = 0.8 * (WIDTH - 1.3) ** exponent * np.exp(spread * np.array([0.6, -0.9, -0.9, 0.6]))
    left = np.maximum(300.0 - rate[:, None] * time[:4], 0.0)
    return xr.Dataset({
        "time": (("pile", "frame"), time),
        "kinetic": (("pile", "frame"), kinetic),
        "contacts": (("pile", "frame"), contacts * (1.0 - np.exp(-time))),
        "duration": ("pile", [0.003, 0.003, 0.003, 0.01, 0.01, 0.01]),
        "rest": ("pile", [15.0, 15.0, 15.0, 15.0, 15.0, np.nan]),
        "final_contacts": ("pile", contacts + np.array([0.01, 0.0, -0.01, 0.01, 0.0, -0.01])),
        "residual": ("pile", [0.0, 0.0, 0.0, 0.0, 0.0, residual]),
        "displacement": ("pile", [0.0, displacement, 0.0, 0.0, 0.0, 0.0]),
        "rise": ("pile", [0.0, rise, 0.0, 0.0, 0.0, 0.0]),
        "width": ("orifice", WIDTH),
        "rate": ("orifice", rate),
        "rate_error": ("orifice", spread * rate),
        "rate_freedom": ("orifice", np.full(4, 8)),
        "head_ratio": ("orifice", np.full(4, head)),
        "head_ratio_error": ("orifice", np.full(4, 0.02)),
        "head_ratio_freedom": ("orifice", np.full(4, 8)),
        "liquid_ratio": ("orifice", np.full(4, 1.2)),
        "flow_time": (("orifice", "flow_frame"), time[:4]),
        "left": (("orifice", "flow_frame"), left),
        **_fit(WIDTH, Estimate(np.log(rate), spread, 8)),
    })  # fmt: skip


# What is read of piles and flows: exactly, and what comes out of small ones.


SETTINGS = {"gap": 1e-3, "start": 0.8, "head": 0.6}


def pile(count=12, **law):
    kinds = [gp.Species(count // 2, radius, temperature=1.0) for radius in (0.45, 0.55)]
    law = gp.Restitution(0.5, **law)
    return gp.Scene(gp.Container((4.0, 12.0)), kinds, gravity=(0.0, -2.0), restitution=law)


def hopper(count=80, width=5.0):
    """An orifice of this width in the floor of a hopper, 10 wide."""
    region = ((0.0, 200.0), (10.0, 214.0))
    ends = 5.0 - 0.5 * width, 5.0 + 0.5 * width
    return gp.Scene(
        gp.Container((10.0, 214.0)),
        [gp.Species(count, 0.5, region=region)],
        gravity=(0.0, -1.0),
        restitution=gp.Restitution(0.5, 0.0, 0.01),
        walls=[gp.Wall((0.0, 200.0), (ends[0], 200.0)), gp.Wall((ends[1], 200.0), (10.0, 200.0))],
    )


def test_contacts_are_those_of_discs_and_walls():
    """Three discs in a row, the first in a corner; the gap to the third is 0.01."""
    scene = gp.Scene(gp.Container((10.0, 10.0)))
    positions = np.array([[0.5, 0.5], [1.5, 0.5], [2.51, 1.0]])
    radii = np.full(3, 0.5)
    assert measure.count_contacts(scene, positions, radii, 1e-6) == 3 + 1
    apart = math.hypot(1.01, 0.5) - 1.0
    assert measure.count_contacts(scene, positions, radii, 1.01 * apart) == 5
    assert measure.count_contacts(scene, positions, radii, 0.99 * apart) == 4


def test_piles_and_flows_are_read(tmp_path):
    points = [
        made(tmp_path, "pile", pile(contact_duration=0.005), duration=30.0, samples=60),
        *(
            made(
                tmp_path, f"hopper{width:g}", hopper(width=width), duration=30.0, samples=120,
                boxes_per_side=[8, 140], replicas=2,
            )
            for width in (3.0, 4.0, 5.0)
        ),
    ]  # fmt: skip
    ds = measure.settling(points, SETTINGS)
    assert ds.sizes["pile"] == 4 and ds.sizes["orifice"] == 3
    assert ds["duration"].values == pytest.approx(np.full(4, 0.005 * math.sqrt(2.0)))
    assert (ds["residual"] < 1.0).all() and (ds["displacement"] == 0.0).all() and (ds["rise"] < 1e-6).all()
    assert abs(ds["final_contacts"].mean() - 2.0) < 0.2
    assert ds["width"].values == pytest.approx([3.0, 4.0, 5.0])
    assert (np.diff(ds["rate"]) > 0.0).all() and (ds["rate_error"] < 0.2 * ds["rate"]).all()
    for n in range(3):  # what passes while the flow is timed: the slope of the discs that are left
        time, left = ds["flow_time"][n].values, ds["left"][n].values
        assert left[0] == 80 and left[-1] < 20
        timed = (left < 64) & (left > 40)
        slope = np.polyfit(time[timed], left[timed], 1)[0]
        assert ds["rate"][n] == pytest.approx(-slope, rel=0.3)


def test_a_flow_that_ends_too_early_is_refused(tmp_path):
    point = made(tmp_path, "short", hopper(), duration=1.0, samples=4, boxes_per_side=[8, 140], replicas=1)
    with pytest.raises(ValueError, match="duration"):
        measure.settling([point], SETTINGS)


def test_a_law_is_fitted_to_its_own_numbers():
    width = np.array([4.0, 6.0, 9.0, 14.0])
    found = measure._fit(width, Estimate(np.log(0.7 * (width - 1.2) ** 1.3), 0.01, 5))
    assert found["exponent"][1] == pytest.approx(1.3, abs=1e-4)
    assert found["offset"][1] == pytest.approx(1.2, abs=1e-3)
    assert found["amplitude"][1] == pytest.approx(0.7, rel=1e-3)
    assert found["chi_square"][1] > 1.0
    found = measure._fit(width, Estimate(np.log(0.7 * (width - 1.2) ** 1.5), 0.01, 5))
    assert found["beverloo_offset"][1] == pytest.approx(1.2, abs=1e-4)
    assert found["chi_square"][1] < 1e-6


def test_right_data_agree():
    assert verdicts(settling(settled())) == {"agrees"}


@pytest.mark.parametrize(
    ("wrong", "claim"),
    [
        ({"contacts": 3.0}, "contacts of a disc"),
        ({"contacts": 1.5}, "contacts of a disc"),
        ({"displacement": 1e-3}, "largest displacement"),
        ({"rise": 1e-3}, "largest rise"),
        ({"residual": 3.0}, "kinetic energy"),
        ({"head": 1.2}, "ln of the rate"),
        ({"exponent": 1.0}, "exponent"),
        ({"exponent": 2.5}, "exponent"),
    ],
)
def test_wrong_data_disagree(wrong, claim):
    assert "disagrees" in verdicts(settling(settled(**wrong)), claim)


def test_another_law_leaves_deviations():
    assert verdicts(settling(settled(exponent=2.5)), "deviations") == {"disagrees"}


def test_an_exponent_that_is_not_known_well_is_inconclusive():
    assert verdicts(settling(settled(spread=0.1)), "exponent") == {"inconclusive"}


def test_four_panels():
    ds = settled()
    energies, contacts, left, rates = draw(figure.settling, ds).axes
    moving = ds["kinetic"].values > 0.0
    for curve, n in zip([one for one in energies.lines if len(one.get_xdata()) > 2], (0, 3), strict=True):
        follows(curve, ds["time"][n][moving[n]], ds["kinetic"][n][moving[n]])
    curves = [one for one in contacts.lines if len(one.get_xdata()) == ds.sizes["frame"]]
    for curve, n in zip(curves, (0, 3), strict=True):
        follows(curve, ds["time"][n], ds["contacts"][n])
    for n, curve in enumerate(left.lines[:4]):
        follows(curve, ds["flow_time"][n], ds["left"][n])
    shows(rates, Points(ds["width"] - ds["beverloo_offset"], ds["rate"], ds["rate_error"]))
