import numpy as np
import pytest
from reproduction.families.drawn import draw
from reproduction.families.extremes.data import extremes_data

from gaspart.reproduction.families.extremes.figure import BLOCKS, GAP, MAP, REASONS, stability_extremes
from gaspart.reproduction.families.extremes.figure import _reason as reason_of


def table(axis):
    """Texts and backgrounds of the cells, by block, engine and row."""
    texts, colours = {}, {}
    width = len(axis.get_xticks()) // len(BLOCKS) + GAP
    for patch in axis.patches:
        left, top = patch.get_xy()
        place = (list(BLOCKS)[int(left // width)], round(left % width), int(top))
        colours[place] = patch.get_facecolor()
        inside = [text for text in axis.texts if patch.get_extents().contains(*text.get_window_extent().p0)]
        texts[place] = "".join(text.get_text() for text in inside)
    return texts, colours


def test_each_cell_shows_an_error_or_the_reason_of_a_refusal():
    ds = extremes_data()
    ds["energy"][:] = [[1e-15, 1e-9], [0.0, 1.0]]
    ds["momentum"][:] = [[np.nan, 1e-8], [0.0, 1.0]]
    ds["overlap"][:] = [[0.0, 1e-3], [0.0, 1.0]]
    ds["contacts"][:] = [[100, 90], [4, -1]]
    ds["missed"][:] = [[0, 10], [0, 0]]
    ds["verdict"][:] = [["passes", "passes"], ["passes", "refused"]]
    ds["message"] = ds["message"].astype("U60")
    ds["message"][1, 1] = "speed = 1e300: must be 0 or of a size from 1e-60 to 1e+60"
    axis = draw(stability_extremes, ds).axes[0]
    texts, colours = table(axis)
    assert len(texts) == 4 * 2 * 2
    assert [texts[name, 0, 0] for name in BLOCKS] == ["$10^{-15}$", "·", "0", "0"]
    assert [texts[name, 1, 0] for name in BLOCKS] == ["$10^{-9}$", "$10^{-8}$", "$10^{-3}$", "10"]
    assert [texts[name, 0, 1] for name in BLOCKS] == ["0"] * 4
    assert [texts[name, 1, 1] for name in BLOCKS] == ["d"] * 4
    for name, power in (("energy", -9), ("momentum", -8), ("overlap", -3), ("missed", -1)):
        assert colours[name, 1, 0] == pytest.approx(MAP((17 + power) / 17), abs=0.02)
    assert [label.get_text() for label in axis.get_yticklabels()] == list(ds["row"].values)
    assert [label.get_text() for label in axis.get_xticklabels()] == ["event", "step f8"] * 4
    assert axis.get_ylim() == (2.0, 0.0)
    assert [line.get_ydata()[0] for line in axis.lines] == [1]  # between the two groups


def test_a_failure_is_named():
    texts, _ = table(draw(stability_extremes, extremes_data(verdict="fails")).axes[0])
    assert texts["energy", 0, 0] == texts["missed", 0, 0] == "fails"


@pytest.mark.parametrize(
    ("message", "letter"),
    [
        ("at time 1 80 of 338 contacts were found a step too late", "a"),
        ("time_step = 0.01: moves particles by less than float32 resolves in a length of 8", "b"),
        ("particles[0].radius = 0.5: leaves no room between two walls", "f"),
        ("at time 0 particle 9 has had 12 contacts: an inelastic collapse, or a stack at rest", "g"),
        ("something else", "?"),
    ],
)
def test_refusals_are_grouped_by_their_messages(message, letter):
    assert reason_of(message)[0] == letter


def test_reasons_have_different_letters():
    assert len({letter for letter, *_ in REASONS}) == len(REASONS)
