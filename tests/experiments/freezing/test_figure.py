import numpy as np
from experiments.freezing.data import discs, spheres

from gaspart.experiments.freezing import figure as freezing
from gaspart.rendering import style


def test_it_draws_discs_with_structure(tmp_path):
    with style.applied():
        figure = freezing.freezing_discs(discs())
        style.save(figure, tmp_path / "figure.svg")
    assert len(figure.axes) == 3 + 2 * 3


def test_it_draws_discs_from_one_side_and_without_a_plateau(tmp_path):
    data = discs().isel(start=[0])
    data["plateau"] = data["plateau"] * np.nan
    with style.applied():
        style.save(freezing.freezing_discs(data), tmp_path / "figure.png")


def test_it_draws_spheres_and_the_slab(tmp_path):
    with style.applied():
        figure = freezing.freezing_spheres(spheres())
        style.save(figure, tmp_path / "figure.svg")
    assert [axis.get_ylabel() != "" for axis in figure.axes] == [True] * 5


def test_points_that_have_not_settled_are_hollow():
    data = discs()
    data["disagreement"] = data["disagreement"] + 5.0
    with style.applied():
        figure = freezing.freezing_discs(data)
    faces = {line.get_markerfacecolor() for line in figure.axes[0].lines if line.get_marker() in ("o", "s")}
    assert faces == {"white"}
