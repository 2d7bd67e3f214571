"""The table of extremes as it is drawn."""

import pytest
from experiments.drawn import draw
from experiments.extremes.data import extremes_data
from matplotlib import colormaps

from gaspart.experiments.extremes.figure import stability_extremes


def test_each_cell_shows_the_drift_or_the_verdict_of_its_row_and_engine(tmp_path):
    ds = extremes_data()
    ds["energy"][:] = [[1e-15, 1e-9], [0.0, 1.0]]
    ds["verdict"][:] = [["passes", "passes"], ["passes", "refused"]]
    (axis,) = draw(stability_extremes, ds, tmp_path).axes
    cells = {
        tuple(int(at) for at in text.get_position()): text.get_text() for text in axis.texts
    }  # (column, row)
    assert cells == {(0, 0): "$10^{-15}$", (1, 0): "$10^{-9}$", (0, 1): "0", (1, 1): "–"}
    colours = {patch.get_xy(): patch.get_facecolor() for patch in axis.patches}
    assert colours[0, 0] == pytest.approx(colormaps["YlGnBu"](3 / 20))
    assert colours[1, 0] == pytest.approx(colormaps["YlGnBu"](9 / 20))
    assert [label.get_text() for label in axis.get_yticklabels()] == list(ds["row"].values)
    assert [label.get_text() for label in axis.get_xticklabels()] == ["event", "step\nf8"]
    assert axis.get_ylim() == (2.0, 0.0)
    assert [line.get_ydata()[0] for line in axis.lines] == [1]  # between the two groups


def test_a_failure_is_named(tmp_path):
    axis = draw(stability_extremes, extremes_data(verdict="fails"), tmp_path).axes[0]
    assert [text.get_text() for text in axis.texts] == ["fails", "0", "–", "–"]
