"""A gas in a notebook: what its sliders change, and that it runs."""

import asyncio
import sys

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

import gaspart as gp
from gaspart.rendering.live import LiveGas, live


@pytest.fixture(scope="module")
def scene():
    species = [gp.Species(40, 0.5, temperature=1.0), gp.Species(20, 0.25, mass=0.5, temperature=1.0)]
    species.append(gp.Species(1, 2.0, fixed=True))
    return gp.Scene(gp.Container((20.0, 20.0)), species)


def test_gravity_goes_on_from_where_the_particles_are(scene):
    gas = LiveGas(scene, size=(80, 60))
    gas.advance()
    before = gas.simulation.state
    gas.pull(0.5)
    after = gas.simulation.state
    assert gas.simulation.scene.gravity == (0.0, -0.5) and gas.gravity == 0.5
    assert np.array_equal(before.positions, after.positions)
    assert np.array_equal(before.velocities, after.velocities)
    gas.pull(0.0)
    assert gas.simulation.scene.gravity is None and gas.gravity == 0.0


def test_a_packing_fraction_begins_anew_in_the_same_proportions(scene):
    gas = LiveGas(scene, size=(80, 60))
    gas.pull(0.5)
    for wanted in (0.08, 0.3, scene.packing_fraction):
        gas.fill(wanted)
        large, small, fixed = (one.count for one in gas.simulation.scene.species)
        assert gas.simulation.scene.packing_fraction == pytest.approx(wanted, abs=0.002)
        assert fixed == 1 and large == pytest.approx(2 * small, abs=1)
        assert gas.gravity == 0.5 and gas.simulation.time == 0.0
    assert gas.simulation.scene.species == scene.species
    assert gas.emptiest == pytest.approx(np.pi * 4.0 / 400.0)


def parts(widget):
    """The picture, the button, the sliders by their names, and the note."""
    image, (button, *sliders), note = widget.children[0], widget.children[1].children, widget.children[2]
    return image, button, {one.description: one for one in sliders}, note


def test_the_film_runs_until_it_is_stopped_and_follows_its_sliders(scene):
    image, button, sliders, note = parts(live(scene, size=(80, 60)))
    shown = {image.value}

    async def watched():
        button.value = True
        for value in (0.0, 0.3):
            before = image.value
            while image.value == before:
                await asyncio.sleep(0.01)
            shown.add(image.value)
            sliders["gravity"].value = value
        button.value = False
        await button.task

    asyncio.run(asyncio.wait_for(watched(), 300))
    assert len(shown) == 3 and all(bytes(one).startswith(b"\x89PNG") for one in shown)
    stopped = image.value
    sliders["packing fraction"].value = 0.05
    assert image.value != stopped and note.value == ""


def test_what_does_not_fit_is_said_in_a_line_and_changes_nothing(scene):
    image, _, sliders, note = parts(live(scene, size=(80, 60)))
    sliders["packing fraction"].max = 0.9
    before = image.value
    sliders["packing fraction"].value = 0.88
    assert "does not fit by random insertion" in note.value and "\n" not in note.value
    assert image.value == before


def test_sliders_that_would_mean_nothing_are_left_out():
    periodic = gp.Scene(gp.Container((10.0, 10.0), "periodic"), [gp.Species(9, 0.5, temperature=1.0)])
    assert list(parts(live(periodic, size=(80, 60)))[2]) == ["packing fraction"]
    single = gp.Scene(gp.Container((10.0, 10.0)), particles=[gp.Particle((5.0, 5.0), (1.0, 0.0), 0.5)])
    assert list(parts(live(single, size=(80, 60)))[2]) == ["gravity"]
    still = gp.Scene(gp.Container((10.0, 10.0)), [gp.Species(9, 0.5)])
    with pytest.raises(gp.SceneError, match="nothing moves"):
        live(still)


def test_a_missing_package_is_named_with_its_extra(scene, monkeypatch):
    monkeypatch.setitem(sys.modules, "ipywidgets", None)
    with pytest.raises(gp.SceneError, match=r"pip install 'gaspart\[live\]'"):
        live(scene)


def test_it_runs_in_a_notebook_between_its_cells():
    scene = "gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(9, 0.5, speed=1.0)])"
    make = f"import gaspart as gp; film = gp.live({scene})"
    begin = "image, button = film.children[0], film.children[1].children[0]\n"
    begin += "first = image.value; button.value = True; film"
    wait = "import asyncio\nwhile image.value == first:\n    await asyncio.sleep(0.1)"
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(one) for one in (make, begin, wait)])
    NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    assert "application/vnd.jupyter.widget-view+json" in notebook.cells[1].outputs[0].data
