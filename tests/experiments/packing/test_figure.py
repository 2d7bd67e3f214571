"""The pictures of the densest packings."""

from experiments.packing.data import packings

from gaspart.experiments.packing import figure as packing
from gaspart.rendering import style


def test_the_two_pictures_tell_their_packing_fractions():
    with style.applied():
        figure = packing.densest_fill(packings())
    titles = [axis.get_title() for axis in figure.axes]
    assert [len(axis.images) for axis in figure.axes] == [1, 1]
    assert "0.376 ± 0.001" in titles[0]
    assert "0.641 ± 0.001" in titles[1]
