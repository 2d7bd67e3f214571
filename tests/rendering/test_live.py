"""A gas in a notebook: what its sliders change, and that it runs."""

import asyncio
import dataclasses
import sys

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

import gaspart as gp
from gaspart.rendering.live import live
from gaspart.rendering.live_gas import LiveGas

pytestmark = pytest.mark.thorough


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
    image, note = widget.children[0].children[0], widget.children[2]
    button, *others = widget.children[1].children
    return image, button, {one.description: one for one in others}, note


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
    before, value = image.value, sliders["packing fraction"].value
    sliders["packing fraction"].value = 0.88
    assert "does not fit by random insertion" in note.value and "\n" not in note.value
    assert image.value == before and sliders["packing fraction"].value == value
    sliders["packing fraction"].value = 0.05
    assert image.value != before and note.value == ""


def test_sliders_that_would_mean_nothing_are_left_out():
    periodic = gp.Scene(gp.Container((10.0, 10.0), "periodic"), [gp.Species(9, 0.5, temperature=1.0)])
    assert list(parts(live(periodic, size=(80, 60)))[2]) == ["tracer", "packing fraction", "restitution"]
    single = gp.Scene(gp.Container((10.0, 10.0)), particles=[gp.Particle((5.0, 5.0), (1.0, 0.0), 0.5)])
    assert list(parts(live(single, size=(80, 60)))[2]) == ["tracer", "gravity", "temperature of walls"]
    still = gp.Scene(gp.Container((10.0, 10.0)), [gp.Species(9, 0.5)])
    with pytest.raises(gp.SceneError, match="nothing moves"):
        live(still)


def test_hot_walls_heat_the_gas_to_their_temperature_and_none_keep_it():
    scene = gp.Scene(gp.Container((12.0, 12.0)), [gp.Species(40, 0.3, temperature=1.0)])
    gas = LiveGas(scene, size=(80, 60))
    gas.heat(3.0)
    assert {face.temperature for face in gas.simulation.scene.faces.values()} == {3.0}
    gas.simulation.advance(duration=200.0)
    gas.observe()
    gas.simulation.advance(duration=1.0)
    for _ in range(200):
        gas.interval = 2.0
        gas.advance()
    (name, value, error, known), *_ = gas.gauges()
    assert name == "temperature" and known == 3.0 and abs(value - known) < 4.0 * error < 0.8
    gas.heat(0.0)
    energy = gas.simulation.state.kinetic_energy
    gas.advance()
    assert gas.simulation.scene.faces == {} and gas.simulation.state.kinetic_energy == pytest.approx(energy)


def test_thermal_faces_of_the_scene_keep_their_ratio():
    faces = {"x_low": gp.Thermal(2.0), "x_high": gp.Thermal(1.0)}
    gas = LiveGas(
        gp.Scene(gp.Container((12.0, 12.0)), [gp.Species(9, 0.3, temperature=1.0)], faces=faces),
        size=(80, 60),
    )
    gas.heat(5.0)
    now = gas.simulation.scene.faces
    assert (now["x_low"].temperature, now["x_high"].temperature) == (5.0, 2.5)
    gas.heat(0.0)
    assert gas.simulation.scene.faces == faces
    gas.push(10.0)
    gas.heat(5.0)  # the piston stays one
    now = gas.simulation.scene.faces
    assert now["x_low"].temperature == 5.0 and isinstance(now["x_high"], gp.Piston)


def test_a_piston_does_work_and_an_expansion_into_a_vacuum_does_none():
    scene = gp.Scene(gp.Container((20.0, 12.0)), [gp.Species(60, 0.05, temperature=1.0)])
    gas = LiveGas(scene, size=(80, 60))
    before = gas.simulation.state.kinetic_energy
    gas.push(10.0)
    gas.push(10.0)  # once more on the way, which stops it there and starts anew
    while gas.simulation.scene.pistons:
        gas.advance()
    state = gas.simulation.state
    assert gas.simulation.scene.container.lengths == (10.0, 12.0) == tuple(state.lengths)
    assert (state.positions[:, 0] <= 10.0 - 0.05 + 1e-9).all()
    hot = state.kinetic_energy
    slow = before * (20.0 / 10.0)  # T V^(2/d) is constant in a slow compression of an ideal gas in the plane
    assert hot > 0.9 * slow and hot < 2.0 * slow
    gas.push(20.0)
    for _ in range(20):
        gas.advance()
    assert gas.simulation.state.kinetic_energy == pytest.approx(hot, rel=1e-12)
    assert gas.simulation.state.positions[:, 0].max() > 10.0
    with pytest.raises(gp.SceneError, match="does not fit"):
        gas.fill(0.9)


def test_restitution_takes_energy_until_it_is_one_again(scene):
    gas = LiveGas(scene, size=(80, 60))
    energies = [gas.simulation.state.kinetic_energy]
    for normal in (0.8, 1.0):
        gas.damp(normal)
        for _ in range(30):
            gas.advance()
        energies.append(gas.simulation.state.kinetic_energy)
    assert gas.simulation.scene.restitution is None
    assert energies[1] < energies[0]
    gas.advance()
    assert gas.simulation.state.kinetic_energy == pytest.approx(energies[2], rel=1e-12)


def test_a_wall_that_is_removed_lets_gases_mix():
    left = gp.Species(20, 0.2, temperature=1.0, region=((0.0, 0.0), (5.8, 12.0)))
    gas = LiveGas(
        gp.Scene(
            gp.Container((12.0, 12.0)),
            [left],
            walls=[gp.Wall((6.0, 0.0), (6.0, 12.0))],
        ),
        size=(80, 60),
        colour="species",
    )
    for _ in range(100):
        gas.advance()
    assert (gas.simulation.state.positions[:, 0] < 6.0).all()
    collisions, time = gas.collisions, gas.time
    gas.open_walls()
    for _ in range(100):
        gas.advance()
    assert (gas.simulation.state.positions[:, 0] > 6.0).sum() > 3
    assert gas.collisions > collisions and gas.time > time


@pytest.fixture(scope="module")
def effusion():
    """A gas between a reservoir, whose sides are open, and a vacuum."""
    faces = {"x_low": gp.Open(activity=0.1, temperature=1.0), "x_high": gp.Open()}
    container = gp.Container((20.0, 10.0), ("wall", "periodic"))
    species = [gp.Species(16, 0.4, temperature=1.0)]
    return gp.Scene(container, species, faces=faces, centres_to_walls=True)


def test_open_faces_let_particles_in_and_out_and_go_on_with_those_inside(effusion):
    gas = LiveGas(effusion, size=(80, 60))
    for _ in range(100):
        gas.step()
    before = gas.simulation.state
    assert not np.array_equal(before.numbers, np.arange(16))
    gas.supply(0.3)
    gas.heat(2.0)
    after = gas.simulation.state
    assert np.array_equal(before.positions, after.positions)
    assert np.array_equal(before.velocities, after.velocities)
    assert gas.simulation.scene.faces == {"x_low": gp.Open(0.3, 2.0), "x_high": gp.Open()}
    for _ in range(400):
        gas.step()
    names, values, errors, theories = zip(*gas.gauges(), strict=True)
    assert names == ("temperature", "particles", "pressure, x low", "pressure, x high")
    counts = [np.isfinite(row["velocities"][:, 0]).sum() for row in gas._rows]
    assert values[1] == pytest.approx(np.mean(counts)) and 0.0 < errors[1] < 0.5 * values[1]
    assert theories == (None,) * 4
    edges, density, _ = gas.speeds()
    assert (density * np.diff(edges)).sum() == pytest.approx(1.0, abs=0.01)
    gas.heat(0.0)
    assert gas.simulation.scene.faces["x_low"] == gp.Open(0.3, 1.0)


def test_reservoirs_on_both_sides_give_their_temperature_and_the_number_of_their_density(effusion):
    reservoir = gp.Open(activity=0.02, temperature=2.0)
    scene = dataclasses.replace(effusion, faces={"x_low": reservoir, "x_high": reservoir})
    gas = LiveGas(scene, size=(80, 60))
    gas.interval *= 20.0
    for _ in range(20):
        gas.step()
    gas.observe()
    for _ in range(300):
        gas.step()
    temperature, particles, *_ = gas.gauges()
    assert temperature[3] == 2.0 and abs(temperature[1] - 2.0) < 4.0 * temperature[2] < 0.6
    ideal = 0.02 * 200.0 / (np.pi * 0.4**2)  # of which the excluded area takes twice the packing fraction
    assert abs(particles[1] - ideal * (1.0 - 4.0 * 0.02)) < 4.0 * particles[2] + 0.02 * ideal


def test_an_empty_container_is_shown_and_refuses_changes_in_a_line():
    scene = gp.Scene(
        gp.Container((5.0, 5.0)),
        particles=(),
        species=[gp.Species(3, 0.2, speed=1.0)],
        faces={f"{axis}_{end}": gp.Open() for axis in "xy" for end in ("low", "high")},
        centres_to_walls=True,
    )
    gas = LiveGas(scene, size=(80, 60))
    gas.simulation.advance(duration=100.0)
    gas.observe()
    for _ in range(40):
        gas.advance()
    assert gas.simulation.state.count == 0
    assert gas.gauges()[1][:2] == ("particles", 0.0)
    with pytest.raises(gp.SceneError, match="all particles have left"):
        gas.heat(1.0)


def test_sliders_of_open_faces_are_those_of_their_reservoirs(effusion):
    assert list(parts(live(effusion, size=(80, 60)))[2]) == ["activity of reservoirs", "temperature of walls"]


def test_gauges_agree_with_the_observables_of_the_library():
    scene = gp.Scene(gp.Container((20.0, 20.0)), [gp.Species(60, 0.3, temperature=1.0)])
    gas = LiveGas(scene, size=(80, 60))
    assert gas.gauges() == []
    for _ in range(300):  # more than are stored
        gas.advance()
    temperature, *pressures = gas.gauges()
    assert temperature[1] == pytest.approx(gas.simulation.state.kinetic_energy / 60.0)
    run = gp.Simulation(scene, seed=0)
    run.advance(duration=gas.simulation.time)
    tally = run.tally
    assert gas.collisions == tally.collisions
    exact = tally.wall_impulse / (19.4 * tally.time)
    for (name, value, error, known), each in zip(pressures, exact, strict=True):
        assert name.startswith("pressure, ") and abs(value - each) < 1.5 * error  # by another estimator
        assert 0.0 < error < 0.3 * value and abs(value - known) < 5.0 * error
    edges, density, expected = gas.speeds()
    middles, widths = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    for values in (density, expected):
        assert (values * widths).sum() == pytest.approx(1.0, abs=0.01)
        assert (middles**2 * values * widths).sum() == pytest.approx(2.0 * temperature[1], rel=0.02)


def test_colours_of_speeds_are_those_of_a_picture_of_the_same_gas(monkeypatch):
    gas = LiveGas(gp.Scene(gp.Container((20.0, 20.0)), [gp.Species(60, 0.3, speed=1.0)]), size=(80, 60))
    ends = []
    monkeypatch.setattr(
        "gaspart.rendering.live_gas.draw_labelled", lambda *given, **_: ends.append(given[-1])
    )
    assert gas.picture is None and ends == [pytest.approx(2.0)]  # twice the root-mean-square speed


def test_the_tracer_is_a_line_where_its_particle_has_been():
    scene = gp.Scene(gp.Container((20.0, 20.0)), [gp.Species(20, 0.3, temperature=1.0)])
    gas = LiveGas(scene, size=(160, 120))
    for _ in range(40):
        gas.advance()
    plain = np.array(gas.picture)
    gas.traced = True
    assert 20 < (np.array(gas.picture) != plain).any(axis=2).sum() < 4000


def test_a_missing_package_is_named_with_its_extra(scene, monkeypatch):
    monkeypatch.setitem(sys.modules, "ipywidgets", None)
    with pytest.raises(gp.SceneError, match=r"pip install 'gaspart\[live\]'"):
        live(scene)


def updated(widget, **state):
    """Send a frontend's message that changes a widget, as a browser does when its user moves a slider."""
    data = {"method": "update", "state": state, "buffer_paths": []}
    widget.comm.handle_msg({"content": {"data": data}, "buffers": []})


def test_messages_of_a_frontend_change_the_gas(monkeypatch):
    gases = []
    monkeypatch.setattr(
        "gaspart.rendering.live.LiveGas", lambda *args: gases.append(LiveGas(*args)) or gases[0]
    )
    scene = gp.Scene(gp.Container((20.0, 12.0)), [gp.Species(60, 0.3, temperature=1.0)])
    image, _, sliders, note = parts(live(scene, size=(80, 60)))
    (gas,) = gases
    before = gas.simulation.state
    updated(sliders["gravity"], value=0.25)
    assert gas.simulation.scene.gravity == (0.0, -0.25)
    updated(sliders["gravity"], value=0.0)
    updated(sliders["temperature of walls"], value=2.0)
    assert gas.simulation.scene.gravity is None
    assert {face.temperature for face in gas.simulation.scene.faces.values()} == {2.0}
    assert np.array_equal(gas.simulation.state.positions, before.positions)
    shown = image.value
    updated(sliders["packing fraction"], value=0.04)
    assert gas.simulation.scene.packing_fraction == pytest.approx(0.04, abs=0.003)
    assert image.value != shown and note.value == ""


def test_it_runs_in_a_notebook_between_its_cells_and_hears_its_sliders():
    scene = "gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(9, 0.5, speed=1.0)])"
    make = f"import gaspart as gp; film = gp.live({scene})"
    begin = "image, button = film.children[0].children[0], film.children[1].children[0]\n"
    begin += "first = image.value; button.value = True; film"
    wait = "import asyncio\nwhile image.value == first:\n    await asyncio.sleep(0.1)"
    names = (
        "button.value = False\nsliders = {one.description: one for one in film.children[1].children[2:]}\n"
    )
    names += "slider = sliders['packing fraction']; before = image.value; print(slider.comm.comm_id)"
    heard = "print(slider.value, image.value != before, film.children[2].value == '')"
    cells = [nbformat.v4.new_code_cell(text) for text in (make, begin, wait, names, heard)]
    notebook = nbformat.v4.new_notebook(cells=cells)
    client = NotebookClient(notebook, timeout=120, kernel_name="python3")
    with client.setup_kernel():
        for n, cell in enumerate(cells):
            client.execute_cell(cell, n)
            if n == 3:  # the user moves the slider: the message of a browser, to the kernel
                content = {
                    "comm_id": cell.outputs[0].text.strip(),
                    "data": {"method": "update", "state": {"value": 0.05}, "buffer_paths": []},
                }
                client.kc.shell_channel.send(client.kc.session.msg("comm_msg", content))
    assert "application/vnd.jupyter.widget-view+json" in cells[1].outputs[0].data
    assert cells[4].outputs[0].text == "0.05 True True\n"
