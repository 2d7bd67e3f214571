"""Plots of a sweep's table: what is drawn, and along what. No sweep is run here."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.reproduction.sweep_table import SweepTable, columns

ETA, FACES = np.array([0.1, 0.2, 0.3]), ["x low", "x high"]
ALONG = ("packing_fraction", "count")
TABLE = SweepTable(
    {
        "Z": (ALONG, np.array([[1.2, 1.3], [1.6, 1.7], [2.4, 2.5]]), {"long_name": "Z", "units": "1"}),
        "Z_error": (ALONG, np.full((3, 2), 0.01)),
        "Z_theory": (ALONG, np.array([[1.25, 1.35], [1.65, 1.75], [2.45, 2.55]])),
        "Z_theory_error": (ALONG, np.full((3, 2), 0.02)),
        "pressure": ((*ALONG, "face"), np.arange(12.0).reshape(3, 2, 2)),
        "pressure_error": ((*ALONG, "face"), np.ones((3, 2, 2))),
        "rdf": (("packing_fraction", "rdf_distance"), np.ones((3, 4))),
        "rdf_error": (("packing_fraction", "rdf_distance"), np.full((3, 4), 0.1)),
    },
    coords={"packing_fraction": ETA, "count": [50, 100], "face": FACES, "rdf_distance": np.arange(4.0)},
)


def drawn(axis):
    """The values of the bars by their label, and of the lines of theory."""
    points = {bars.get_label(): bars.lines[0].get_ydata().tolist() for bars in axis.containers}
    markers = {id(bars.lines[0]) for bars in axis.containers}
    lines = [line for line in axis.lines if id(line) not in markers and line.get_linewidth() == 1.0]
    return points, lines


def test_the_first_observable_is_drawn_along_the_first_key_with_theory():
    axis = TABLE.plot()
    points, theory = drawn(axis)
    assert points == {"count = 50": [1.2, 1.6, 2.4], "count = 100": [1.3, 1.7, 2.5]}
    assert {line.get_color() for line in theory} == {"black"} and len(theory) == 2
    for line, values in zip(theory, ([1.25, 1.65, 2.45], [1.35, 1.75, 2.55]), strict=True):
        assert line.get_xdata().tolist() == ETA.tolist() and line.get_ydata().tolist() == values
    assert axis.get_xlabel() == "packing_fraction" and axis.get_ylabel() == "Z"
    assert "theory" in [text.get_text() for text in axis.get_legend().get_texts()]
    bars = axis.containers[0].lines[2][0].get_segments()
    assert bars[0][:, 1] == pytest.approx([1.19, 1.21])


def test_another_key_and_a_curve_of_each_point():
    points, _ = drawn(TABLE.plot("Z", along="count"))
    assert points["packing_fraction = 0.2"] == [1.6, 1.7]
    points, _ = drawn(TABLE.plot("rdf"))
    assert list(points) == [f"packing_fraction = {eta:g}" for eta in ETA]
    points, _ = drawn(TABLE.sel(face="x_high").plot("pressure"))
    assert points["count = 100"] == [3.0, 7.0, 11.0]
    axis = TABLE.isel(count=0).plot("pressure", along="face")
    assert [text.get_text() for text in axis.get_xticklabels()] == FACES


def test_names_that_the_table_lacks_are_refused():
    with pytest.raises(gp.SceneError, match="observable = 'z': unknown name"):
        TABLE.plot("z")
    with pytest.raises(gp.SceneError, match="along = 'face': unknown name"):
        TABLE.plot("Z", along="face")


def test_a_theory_has_its_uncertainty_and_source_and_is_no_observable():
    assert TABLE.observables == ["Z", "pressure", "rdf"]
    box = gp.Container((6.0, 6.0, 6.0), boundary="periodic")
    simulation = gp.Simulation(gp.Scene(box, [gp.Species(40, 0.5, temperature=1.0)]), seed=1)
    simulation.advance(8.0)
    measured = gp.measure(simulation, "Z")
    stated = dict(columns("Z", [measured, measured]))
    assert list(stated) == ["Z", "Z_error", "Z_theory", "Z_theory_error"]
    assert stated["Z_theory"].attrs["long_name"] == f"theory: {measured.attrs['source']}"
    assert float(stated["Z_theory_error"]) == float(measured["compressibility_factor_theory_error"]) > 0.0
