import numpy as np
import pytest

from gaspart.rendering import style


@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_the_same_figure_gives_the_same_bytes(tmp_path, suffix):
    def draw(path):
        with style.applied():
            figure, (upper, lower) = style.new(rows=2, height_ratios=(3, 1))
            style.points(upper, [1, 2, 3], [1.0, 4.0, 9.0], [0.1, 0.2, 0.3], label="$\\eta$")
            style.residuals(lower, [1, 2, 3], np.array([0.5, -1.0, 2.0]))
            upper.legend()
            style.letter(upper, "a")
            style.save(figure, path)
        return path.read_bytes()

    assert draw(tmp_path / f"a.{suffix}") == draw(tmp_path / f"b.{suffix}")


def test_text_is_legible_in_a_column():
    with style.applied():
        figure, _ = style.new()
    assert figure.get_figwidth() == style.COLUMN
    sizes = [value for key, value in style.RULES.items() if key.endswith(("size", "labelsize"))]
    assert min(size for size in sizes if isinstance(size, int) and size > 4) >= 8


def test_residuals_keep_an_innocent_scale():
    with style.applied():
        _, axis = style.new()
        style.residuals(axis, [1, 2], np.array([0.1, -0.2]))
        assert axis.get_ylim()[1] >= 3.9
        style.residuals(axis, [1, 2], np.array([0.1, -20.0]))
        assert axis.get_ylim()[0] < -20.0


def test_numbers_of_a_short_logarithmic_axis_do_not_run_into_each_other(tmp_path):
    """3 to 40 and 1e-9 to 1: plain numbers on the one, powers of ten on the other, none of another kind."""
    with style.applied():
        figure, axis = style.new()
        axis.loglog([3.0, 40.0], [1e-9, 1.0])
        style.save(figure, tmp_path / "one.png")
        for one, most in ((axis.xaxis, 4), (axis.yaxis, 12)):
            texts = [text for text in one.get_ticklabels(which="both") if text.get_text()]
            boxes = [text.get_window_extent() for text in texts]
            inside = [box for box in boxes if box.overlaps(axis.get_tightbbox())]
            assert 2 <= len(inside) <= most
            assert not any(a.overlaps(b) for n, a in enumerate(inside) for b in inside[n + 1 :])
        assert {"5", "10", "20"} <= {text.get_text() for text in axis.get_xticklabels()}
