"""How results are written: numbers with their uncertainty in parentheses, curves as plots."""

import math

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.analysis.estimate import Estimate, concise
from gaspart.analysis.observable import observable, scalar


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (1.2421, 0.0203, "1.242(20)"),
        (1.2421, 0.00996, "1.242(10)"),
        (-0.5, 0.1, "-0.50(10)"),
        (3.14159, 1e-5, "3.141590(10)"),
        (1234.5, 56.0, "1234(56)"),
        (123456.0, 5612.0, "123500(5600)"),
        (5.0, 12.0, "5(12)"),
        (0.0, 0.02, "0.000(20)"),
        (1.23e-9, 1.5e-11, "1.230(15)e-9"),
        (3.4e9, 2e7, "3.400(20)e9"),
        (2.0, 0.0, "2"),
        (2.0, math.nan, "2"),
        (math.nan, 0.1, "nan"),
    ],
)
def test_a_number_and_its_uncertainty(value, error, text):
    assert concise(value, error) == text
    if error == error:
        assert str(Estimate(value, error)) == text


def a_scalar(**about):
    rng = np.random.default_rng(1)
    return scalar(
        "compressibility_factor",
        1.24 + 0.1 * rng.normal(size=64),
        np.arange(65.0),
        units="1",
        long_name="Z",
        **about,
    )


def test_a_scalar_is_one_line():
    found = a_scalar(theory=(1.2272, 0.0), source="a table")
    assert (
        repr(found)
        == found.summary
        == f"Z = {concise(float(found.estimate), float(found.error))}, theory 1.227"
    )
    assert "(" in found.summary
    assert found._repr_html_().startswith(f"<b>{found.summary}</b><details>")
    assert "theory" not in a_scalar().summary


def test_a_few_values_have_their_names():
    faces = {"face": (np.array(["x low", "x high"]), {})}
    about = {"units": "1", "long_name": "pressure", "theory": (np.array([2.0, np.nan]), 0.0)}
    found = observable("wall_pressure", faces, np.array([2.1, 2.2]), np.array([0.05, 0.06]), **about)
    assert repr(found) == "pressure, x low = 2.100(50), theory 2\npressure, x high = 2.200(60)"


def test_a_curve_is_a_plot_and_a_data_set():
    sim = gp.Simulation(gas(2, 100, 0.3), gp.EventDriven(), 1)
    sim.advance(duration=5.0)
    found = gp.analysis.rdf(sim)
    assert found.summary == f"rdf: {found.estimate.size} values along distance (length)"
    assert repr(found).startswith(f"{found.summary}\n<xarray.Observable>")
    page = found._repr_html_()
    assert '<img src="data:image/png;base64,' in page and "xr-wrap" in page
