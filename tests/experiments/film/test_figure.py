from experiments.film.data import slits

from gaspart.experiments.film import figure as film
from gaspart.rendering import style


def test_it_draws_all_its_panels(tmp_path):
    with style.applied():
        figure = film.thin_film(slits())
        style.save(figure, tmp_path / "figure.svg")
    assert len(figure.axes) == 3 and all(axis.get_ylabel() for axis in figure.axes)
