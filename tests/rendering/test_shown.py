"""What notebooks show: pictures of scenes and simulations, films, one line for a mistake."""

import base64
import io
import re
from dataclasses import replace

import numpy as np
import pytest
from IPython.core.interactiveshell import InteractiveShell
from PIL import Image
from scenes import gas

import gaspart as gp
from gaspart.rendering import frames as shown
from gaspart.scene import scene as scene_module

BOX = gas(2, 30, 0.2, "wall")


def pixels(page):
    """The picture in a piece of HTML."""
    content = re.search(r'src="data:image/png;base64,([^"]+)"', page).group(1)
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(content))))


@pytest.mark.interpreted
def test_a_picture_shows_itself_and_what_is_none_is_an_array():
    image = gp.render(gp.Simulation(BOX, gp.EventDriven()), size=(80, 60), clock=True)
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(image._repr_png_()))), image)
    for other in (image[0], image.astype(float), image[..., :2], image[:0]):
        assert other._repr_png_() is None


@pytest.mark.thorough
@pytest.mark.interpreted
def test_a_scene_shows_its_particles_and_states_what_it_is():
    falling = replace(BOX, gravity=(0.0, -1.0), restitution=gp.Restitution(0.9))
    page = falling._repr_html_()
    assert np.array_equal(pixels(page), gp.render(falling, size=scene_module.THUMBNAIL))
    assert np.array_equal(gp.render(falling), gp.render(gp.Simulation(falling, gp.EventDriven(), 0)))
    assert "30 discs in 10.8" in falling.summary and "packing fraction 0.2; " in falling.summary
    assert "gravity" in falling.summary and "inelastic contacts" in falling.summary
    assert falling.summary in page
    assert gas(3, 1, 0.1).summary.startswith("1 sphere in ")


def test_a_scene_that_cannot_be_drawn_is_text(monkeypatch):
    full = gp.Scene(gp.Container((10.0, 10.0)), [gp.Species(30, 0.9)])
    assert "img" not in full._repr_html_() and "does not fit" in full._repr_html_()
    monkeypatch.setattr(scene_module, "DRAWN", 29)
    assert BOX._repr_html_() == BOX.summary


@pytest.mark.interpreted
def test_a_simulation_shows_its_present_state():
    simulation = gp.Simulation(BOX, gp.EventDriven(), 1)
    before = pixels(simulation._repr_html_())
    simulation.advance(duration=2.0)
    page = simulation._repr_html_()
    assert np.array_equal(pixels(page), gp.render(simulation, size=scene_module.THUMBNAIL))
    assert (pixels(page) != before).any()
    assert "time 2, " in page and "&lt;Simulation of 30 discs" in page
    assert repr(simulation.state) == "<State of 30 discs at time 2>"


def test_a_film_shows_itself(tmp_path, monkeypatch):
    path = gp.run(BOX, gp.EventDriven(), 1, 1.0, 0.25, tmp_path / "run.nc")
    film = gp.film(path, tmp_path / "a.gif", size=(64, 48), clock=False)
    assert film == tmp_path / "a.gif" and film.with_suffix(".mp4")._repr_html_() is None
    assert base64.b64encode(film.read_bytes()).decode() in film._repr_html_()
    moving = gp.film(path, tmp_path / "a.mp4", size=(64, 48), clock=False)
    assert moving._repr_html_().startswith('<video src="data:video/mp4;base64,')
    monkeypatch.setattr(shown, "LARGEST_FILM", 10)
    assert film._repr_html_().startswith("<a href=")


@pytest.mark.interpreted
def test_a_view_is_kept_once():
    """The text beside the page has not the page in it again."""
    simulation = gp.Simulation(BOX, gp.EventDriven(), 1)
    simulation.advance(duration=1.0)
    view = simulation.show(frames=5)
    assert re.fullmatch(r"<View: a page of 0\.0\d+ MB, .*>", repr(view))


def test_a_mistake_is_one_line(capsys):
    shell = InteractiveShell()
    try:
        shell.run_cell("import gaspart as gp\ngp.Species(-1, 1.0)")
        printed = capsys.readouterr()
        text = re.sub(r"\x1b\[[0-9;]*m", "", printed.out + printed.err).strip()
        assert text.startswith("SceneError: count = -1: must be a whole number") and "\n" not in text
        shell.run_cell("1 / 0")  # other errors have their traceback
        printed = capsys.readouterr()
        assert "Traceback" in printed.out + printed.err
    finally:
        InteractiveShell.clear_instance()
