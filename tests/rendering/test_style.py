import numpy as np
import pytest

from gaspart.analysis.estimate import Estimate
from gaspart.rendering import style


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_the_same_figure_gives_the_same_bytes(tmp_path, suffix):
    def draw(path):
        with style.use_style():
            figure, (upper, lower) = style.new((2.0, 1.0))
            style.points(upper, [1, 2, 3], [1.0, 4.0, 9.0], [0.1, 0.2, 0.3], label="$\\eta$")
            style.band(lower, -3.0, 3.0)
            upper.legend()
            style.letter(upper, "a")
            style.save(figure, path)
        return path.read_bytes()

    assert draw(tmp_path / f"a.{suffix}") == draw(tmp_path / f"b.{suffix}")


def columns(figure):
    """The panels of each column, from left to right, and from above."""
    places = {}
    for panel in figure.axes:
        box = panel.get_position()
        places.setdefault(round(box.x0, 1), []).append((-box.y1, panel))
    return [[panel for _, panel in sorted(own, key=lambda one: one[0])] for _, own in sorted(places.items())]


def test_a_page_has_two_columns_of_panels_and_a_journal_one(tmp_path):
    drawn = {}
    for layout in style.LAYOUTS:
        with style.use_style(layout):
            figure, (a, b, c, d) = style.new((2.0, 1.0), (1.5,), (1.0,))
            style.save(figure, tmp_path / "one.png")
        assert figure.get_figwidth() == style.LAYOUTS[layout]
        assert a.get_shared_x_axes().joined(a, b) and not a.get_shared_x_axes().joined(b, c)
        drawn[layout] = figure.get_figheight(), columns(figure), [a, b, c, d]
    height, panels, (a, b, c, d) = drawn["page"]
    assert (height, panels) == (3.0, [[a, b], [c, d]])
    height, panels, (a, b, c, d) = drawn["journal"]
    assert (height, panels) == (5.5, [[a, b, c, d]])


def test_numbers_of_a_short_logarithmic_axis_do_not_run_into_each_other(tmp_path):
    """3 to 40 and 1e-9 to 1: plain numbers on the one, powers of ten on the other, none of another kind."""
    with style.use_style():
        figure, (axis,) = style.new((2.6,))
        axis.loglog([3.0, 40.0], [1e-9, 1.0])
        style.save(figure, tmp_path / "one.png")
        for one, most in ((axis.xaxis, 4), (axis.yaxis, 12)):
            texts = [text for text in one.get_ticklabels(which="both") if text.get_text()]
            boxes = [text.get_window_extent() for text in texts]
            inside = [box for box in boxes if box.overlaps(axis.get_tightbbox())]
            assert 2 <= len(inside) <= most
            assert not any(a.overlaps(b) for n, a in enumerate(inside) for b in inside[n + 1 :])
        assert {"5", "10", "20"} <= {text.get_text() for text in axis.get_xticklabels()}


def test_estimates_are_points_with_error_bars_and_labels_are_those_stated():
    with style.use_style():
        _, (axis,) = style.new((2.0,))
        x, y = Estimate([1.0, 2.0], [0.1, 0.2]), Estimate([3.0, 4.0], [0.3, 0.4])
        drawn = style.points(axis, x, y, label="seen")
        style.label_axes(axis, "time", legend="upper left", columns=2, xscale="log")
    across, along = (np.array([path.vertices for path in bars.get_paths()]) for bars in drawn.lines[2])
    np.testing.assert_allclose(across[:, :, 0], [[0.9, 1.1], [1.8, 2.2]])
    np.testing.assert_allclose(along[:, :, 1], [[2.7, 3.3], [3.6, 4.4]])
    assert (axis.get_xlabel(), axis.get_ylabel(), axis.get_xscale()) == ("time", "", "log")
    assert [text.get_text() for text in axis.get_legend().get_texts()] == ["seen"]


@pytest.mark.parametrize("first", [True, False])
def test_a_bar_below_zero_does_not_cut_the_lower_ends_of_others(first):
    values, errors = np.array([1.0, 0.5, 0.02, 3.0, 0.3]), np.array([0.2, 0.1, 0.019, 0.3, 0.4])
    figure, (axis,) = style.new((2.8,))
    if first:
        axis.set_yscale("log")
    style.points(axis, np.arange(5.0), Estimate(values, errors))
    axis.set_yscale("log")
    style.finish(figure)
    assert axis.get_ylim()[0] < 0.001 < 3.3 < axis.get_ylim()[1]  # 0.02 - 0.019, 3 + 0.3


def test_an_end_near_zero_does_not_stretch_a_logarithmic_axis_without_bound():
    figure, (axis,) = style.new((2.8,))
    axis.set_yscale("log")
    style.points(axis, [1.0, 2.0, 3.0], Estimate([1.0, 2.0, 0.5], [1.0 - 1e-12, 0.1, 0.6]))
    style.finish(figure)
    assert 1e-3 < axis.get_ylim()[0] < 0.4


def test_limits_that_a_figure_states_remain():
    figure, (axis,) = style.new((2.8,))
    axis.set(yscale="log", ylim=(0.1, 5.0))
    style.points(axis, [1.0, 2.0], Estimate([1.0, 2.0], [0.99, 3.0]))
    style.finish(figure)
    assert axis.get_ylim() == (0.1, 5.0)
