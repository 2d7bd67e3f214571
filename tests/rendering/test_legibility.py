"""Legends make way for data, and what cannot be read is found."""

import numpy as np
import pytest
from matplotlib.image import imread

from gaspart.rendering import style
from gaspart.rendering.legibility import flaws, save_key_picture


@pytest.fixture
def panel(tmp_path):
    """A panel, and a function that saves its figure and returns what is wrong with it."""
    with style.use_style("journal"):
        figure, (axis,) = style.new((2.0,))

        def saved():
            style.save(figure, tmp_path / "one.png")
            return flaws(figure)

        yield axis, saved


def test_a_legend_stays_where_it_covers_nothing(panel):
    axis, saved = panel
    axis.plot([0.0, 1.0], [0.0, 1.0], label="line")
    axis.legend(loc="upper left")
    saved()
    box, frame = axis.get_legend().get_window_extent(), axis.bbox
    assert box.x0 - frame.x0 < 10.0 and frame.y1 - box.y1 < 10.0


def test_a_legend_on_data_goes_to_a_free_corner(panel):
    axis, saved = panel
    axis.plot([0.0, 1.0], [0.0, 1.0], label="line")
    axis.legend(loc="upper right")
    assert saved() == []
    assert axis.get_ylim()[1] == pytest.approx(1.05)


def test_the_axis_is_extended_where_no_corner_is_free(panel):
    axis, saved = panel
    x = np.linspace(0.0, 1.0, 40)
    style.points(axis, np.tile(x, 2), np.repeat([0.02, 0.95], 40), np.full(80, 0.02), label="points")
    axis.plot(x, 0.5 + 0.4 * np.sin(40.0 * x), label="line")
    axis.legend()
    assert saved() == []
    assert 1.1 < axis.get_ylim()[1] < 1.7 and axis.get_legend().get_window_extent().y1 < axis.bbox.y1


def test_a_legend_of_a_crowded_panel_is_above_it(panel):
    axis, saved = panel
    x = np.linspace(0.0, 1.0, 2000)
    axis.plot(x, np.sin(300.0 * x), label="line")
    axis.set_ylim(-0.5, 0.5)
    axis.legend()
    assert saved() == []
    assert axis.get_legend().get_window_extent().y0 >= axis.bbox.y1 and axis.get_ylim() == (-0.5, 0.5)


def test_numbers_that_run_into_each_other_are_found(panel):
    axis, saved = panel
    axis.set_xticks([0.5, 0.51], ["0.500", "0.510"])
    assert "'0.500' overlaps '0.510'" in saved()


def test_text_on_a_point_and_outside_the_canvas_is_found(panel):
    axis, saved = panel
    style.points(axis, [0.5], [0.5])
    axis.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    axis.text(0.5, 0.5, "on it", ha="center", va="center")
    axis.text(2.0, 0.5, "far away").set_in_layout(False)
    assert saved() == ["'far away' leaves the canvas", "'on it' lies on data"]


@pytest.mark.parametrize(("number", "title"), [(0, "first"), (1, "second"), (None, None)])
def test_a_key_picture_is_one_panel_with_its_labels(tmp_path, number, title):
    with style.use_style("page"):
        figure, axes = style.new((2.0, 1.0))
        for axis, name in zip(axes, ("first", "second"), strict=True):
            axis.plot([0.0, 1.0], [0.0, 1.0], label=name)
            style.letter(axis, f"(a) {name}")
        style.label_axes(axes[1], "time", "height", "upper left")
        style.save(figure, tmp_path / "whole.png")
        save_key_picture(figure, number, tmp_path / "key.png")
        assert not flaws(figure)
    if number is None:
        assert figure.axes == axes
        return
    assert figure.axes == [axes[number]]
    assert figure.axes[0].get_title(loc="left") == title and figure.axes[0].get_xlabel() == "time"
    assert imread(tmp_path / "key.png").shape[:2] == (321, 480)


def test_a_key_picture_breaks_labels_and_legends_that_are_too_long(tmp_path):
    with style.use_style("page"):
        figure, (axis, _) = style.new((2.4,), (2.4,))
        for name in ("spheres whose centres reach the walls", "spheres in a periodic container"):
            axis.plot([0.0, 1.0], [0.0, 1.0], label=name)
        figure.legend(ncols=2, loc="outside upper center")
        axis.set_ylabel("time per particle and step (ns)")
        axis.set_xlabel("growth rate of the diameter divided by the thermal speed $v / v_0$")
        style.save(figure, tmp_path / "whole.png")
        save_key_picture(figure, 0, tmp_path / "key.png")
        assert not flaws(figure)
    assert axis.get_xlabel().count("\n") == 1
