"""The table of extremes as it is drawn."""

from experiments.extremes.data import extremes_data

from gaspart.experiments.extremes.figure import stability_extremes
from gaspart.rendering import style


def test_each_cell_says_what_became_of_it():
    with style.applied():
        figure = stability_extremes(extremes_data(verdict="fails"))
        figure.canvas.draw()
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert texts == ["fails", "0", "–", "–"]
    with style.applied():
        figure = stability_extremes(extremes_data())
    assert figure.axes[0].texts[0].get_text() == "$10^{-15}$"
