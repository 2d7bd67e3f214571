"""The interactive view: one page with all data in it, which works in headless Chromium."""

import base64
import json
import re
import zlib

import numpy as np
import pytest
from site_pages import CHROMIUM, found_on

import gaspart as gp
from gaspart.analysis import bond_order as order
from gaspart.cli import main
from gaspart.rendering.view import _compressed_text

needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
PIXELS = """
const pixels = () => {
  const gl = window.eval("gl"), found = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, found);
  return found;
};
const painted = () => pixels().filter((value, n) => n % 4 < 3 && value < 250).length / pixels().length;
const print = () => pixels().reduce((sum, value, n) => (31 * sum + value * (n % 97 + 1)) % 1000000007, 7);
const get = id => document.getElementById(id), set = (id, event, value) => {
  get(id).value = value; get(id).dispatchEvent(new window.Event(event)); return print(); };
const drag = (dx, dy) => {
  for (const [kind, x, y] of [["down", 9, 9], ["move", 9 + dx, 9 + dy], ["up", 0, 0]]) {
    const where = { pointerId: 1, clientX: x, clientY: y };
    get("canvas").dispatchEvent(new window.PointerEvent("pointer" + kind, where));
  }
  return print();
};
"""


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """A folder with views of discs and spheres, and their trajectories."""
    folder = tmp_path_factory.mktemp("views")
    species = [gp.Species(20, 0.5, temperature=1.0), gp.Species(5, 1.0, temperature=1.0)]
    discs = gp.Scene(gp.Container((14.0, 10.0), ("periodic", "wall")), species)
    plate = gp.Plate((3.0, 2.0, 2.0), ((0.0, 2.0, 0.0), (0.0, 0.0, 2.0)))
    spheres = gp.Scene(gp.Container((8.0,) * 3), [gp.Species(20, 0.5, temperature=1.0)], walls=[plate])
    for name, scene in (("discs", discs), ("spheres", spheres)):
        search = "direct" if name == "discs" else "boxes"
        gp.run(scene, gp.EventDriven(search), 1, 4.0, 0.5, folder / f"{name}.nc")
        gp.view(folder / f"{name}.nc").save(folder / f"{name}.html")
    return folder


def content(page):
    """The data in a page."""
    return json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script>', page)[1])


def unpacked(text, shape, kind, modulus):
    """Whole numbers, frame by frame, from their compressed changes, as the page reads them."""
    planes = np.frombuffer(zlib.decompress(base64.b64decode(text)), "u1").reshape(np.dtype(kind).itemsize, -1)
    codes = np.ascontiguousarray(planes.T).view(kind).reshape(shape).astype(int)
    changes = np.where(codes % 2, -(codes + 1) // 2, codes // 2)
    changes[0] = codes[0]
    return changes.cumsum(axis=0) % modulus


@pytest.mark.parametrize("modulus", [256, 65535, 642])
def test_any_numbers_are_unpacked_from_their_changes(modulus):
    values = np.random.default_rng(1).integers(0, modulus, (40, 50), endpoint=False)
    values[1], values[2], values[3] = 0, modulus - 1, modulus // 2
    kind = "u1" if modulus <= 256 else "<u2"
    text = _compressed_text(values.astype(kind), modulus)
    assert np.array_equal(unpacked(text, values.shape, kind, modulus), values)


@pytest.mark.parametrize("name", ["discs", "spheres"])
def test_the_page_has_the_positions_of_every_frame_and_needs_no_other_file(pages, name):
    page = (pages / f"{name}.html").read_text()
    data = content(page)
    with gp.open_trajectory(pages / f"{name}.nc") as run:
        places = unpacked(data["places"], (9, data["count"], 3), "<u2", data["steps"] + 1)
        d = run.attrs["dimension"]
        lengths = np.array(data["lengths"])[:d]
        seen = places[..., :d] / data["steps"] * lengths
        assert np.allclose(seen, run["coordinates"], rtol=0.0, atol=0.5 / 64)  # of the smallest radius, 0.5
        assert data["time"] == run["time"].values.tolist()
        assert np.array_equal(np.frombuffer(base64.b64decode(data["species"]), "u1"), run["type"])
    assert not re.search(r"(?:src|href)=|https?://|@import|fetch\(", page)
    lines = np.frombuffer(base64.b64decode(data["lines"]), "<f4").reshape(-1, 2, 3)
    assert len(lines) == data["ends"] / 2 == (12 if name == "discs" else 16)


@pytest.mark.thorough
@pytest.mark.parametrize("face", [gp.Vibrating(0.5, 1.0), gp.Piston(20.0, 1.0)], ids=["vibrating", "piston"])
def test_a_wall_that_moves_is_in_every_frame(face):
    scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.3, temperature=1.0)], faces={"x_high": face})
    simulation = gp.Simulation(scene, gp.EventDriven(), seed=1)
    simulation.advance(duration=0.75)
    data = content(gp.view(simulation, frames=4).page)
    lines = np.frombuffer(base64.b64decode(data["lines"]), "<f4").reshape(4, -1, 2, 3)
    assert data["ends"] == 2 * 13 and lines.shape[1] == 13
    again = gp.Simulation(scene, gp.EventDriven(), seed=1)
    for time, wall in zip(data["time"], lines[:, -1], strict=True):
        again.advance(until=time)
        piston = again.state.piston
        expected = 9.0 - float(face.places(time)) if piston is None else piston[0]
        assert wall[:, 0] == pytest.approx([expected] * 2, rel=1e-6)


def test_a_simulation_shows_itself_in_a_notebook(pages):
    scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.5, temperature=1.0)])
    simulation = gp.Simulation(scene, gp.EventDriven(search="direct"), seed=1)
    with pytest.raises(gp.SceneError, match="has not advanced"):
        gp.view(simulation)
    simulation.advance(duration=1.0)
    shown = simulation.show(frames=10)
    assert shown == gp.view(simulation, frames=10)
    assert len(content(shown.page)["time"]) == 10 and shown._repr_html_().startswith("<iframe srcdoc=")
    with pytest.raises(gp.SceneError, match="a view needs frames"):
        gp.view(simulation.state)


@pytest.mark.parametrize(("lengths", "name"), [((6.0, 6.0), "|ψ6|"), ((4.0,) * 3, "q6")])
def test_the_local_order_of_every_particle_is_in_the_page(lengths, name):
    scene = gp.Scene(gp.Container(lengths, "periodic"), [gp.Species(14, 0.4, temperature=1.0)])
    simulation = gp.Simulation(scene, gp.EventDriven(search="direct"), seed=1)
    simulation.advance(duration=0.5)
    found = content(gp.view(simulation, frames=2, order=True).page)["order"]
    values = unpacked(found["values"], (2, 14), "u1", 256) / 254.0 * found["highest"]
    state = simulation.state
    measure = order.hexatic if len(lengths) == 2 else order.local_steinhardt
    expected = abs(measure(state.positions, state.lengths))
    assert found["name"] == name and np.allclose(values[-1], expected, atol=0.5 / 254.0 * found["highest"])
    assert content(gp.view(simulation).page)["order"] is None


def test_order_of_walls_or_of_few_particles_is_refused(pages):
    with pytest.raises(gp.SceneError, match="needs a periodic container"):
        gp.view(pages / "discs.nc", order=True)
    few = gp.Scene(gp.Container((9.0, 9.0), "periodic"), [gp.Species(12, 0.5, temperature=1.0)])
    simulation = gp.Simulation(few, gp.EventDriven(search="direct"))
    simulation.advance(duration=0.1)
    with pytest.raises(gp.SceneError, match="more than 12 particles"):
        gp.view(simulation, order=True)


def test_the_command_writes_a_page(pages, capsys):
    source, page = str(pages / "discs.nc"), pages / "few.html"
    assert main(["view", source, "-o", str(page), "--frames", "3"]) == 0
    assert len(content(page.read_text())["time"]) == 3
    assert main(["view", source, "-o", str(page)]) == 2
    assert "overwrite it (--force)" in capsys.readouterr().err
    assert main(["view", source, "-o", str(page), "--force"]) == 0
    assert main(["view", source, "-o", str(pages / "a.htm")]) == 2
    assert "must end in .html" in capsys.readouterr().err
    page.unlink()


@needs_chromium
@pytest.mark.parametrize("width", [1400, 390])
def test_it_draws_turns_and_plays(pages, width):
    script = f"""{PIXELS}
const first = print(), share = painted();
const later = set("frame", "input", "5"), clock = get("clock").textContent;
const coloured = set("colour", "change", "species"), bar = get("bar").textContent.trim();
const dragged = drag(40, 25);
get("canvas").dispatchEvent(new window.WheelEvent("wheel", {{ deltaY: -400, cancelable: true }}));
const zoomed = print();
get("reset").click(); set("colour", "change", "speed");
const again = set("frame", "input", "0");
get("toggle").click();
return {{ prints: [first, later, coloured, dragged, zoomed], again: again === first, share, clock, bar,
  label: get("toggle").textContent, over: document.documentElement.scrollWidth > window.innerWidth,
  buttons: document.querySelector("footer").getBoundingClientRect().bottom <= window.innerHeight }};
"""
    for name, found in found_on(["discs.html", "spheres.html"], script, pages, width).items():
        different = found["prints"] if name == "discs.html" else found["prints"][:2] + found["prints"][3:]
        assert len(set(different)) == len(different), (name, found)
        assert found["again"] and 0.01 < found["share"] < 0.7, (name, found)
        assert found["clock"] == "t = 2.500" and found["bar"].startswith("species 0")
        assert found["label"] == "pause" and found["buttons"] and not found["over"]


@pytest.fixture(scope="module")
def faces(tmp_path_factory):
    """The view of a shock: a piston that moves in, before a hot face."""
    folder = tmp_path_factory.mktemp("faces")
    moving = {"x_low": gp.Piston(speed=0.5), "x_high": gp.Thermal(2.0, accommodation=0.5)}
    scene = gp.Scene(gp.Container((14.0, 10.0)), [gp.Species(20, 0.3, temperature=1.0)], faces=moving)
    simulation = gp.Simulation(scene, seed=1)
    simulation.advance(duration=8.0)
    gp.view(simulation, frames=5).save(folder / "faces.html")
    return folder


@pytest.mark.thorough
def test_faces_have_the_looks_of_pictures_where_they_are(faces):
    data = content((faces / "faces.html").read_text())
    assert [one["text"] for one in data["surfaces"]] == [
        "x low: piston, speed 0.5",
        "x high: T = 2, accommodation 0.5",
    ]
    assert data["surfaces"][0]["hatched"] and data["surfaces"][1]["dashed"]
    assert data["surfaces"][0]["motion"] == [1.0, 0.0, 0.0] and not data["surfaces"][0]["to_and_fro"]
    for time, (piston, hot) in zip(data["time"], data["surface_ends"], strict=True):
        assert piston["depth"] == pytest.approx(0.5 * time, abs=1e-5)
        assert {corner[0] for corner in hot["corners"]} == {14.0}


@pytest.mark.thorough
@needs_chromium
@pytest.mark.parametrize("width", [1400, 390])
def test_the_page_draws_faces_and_names_them(faces, pages, width):
    script = """
const paper = document.getElementById("looks"), { width, height } = paper;
const count = colour => {
  const pixels = paper.getContext("2d").getImageData(0, 0, width, height).data;
  let found = 0;
  for (let n = 0; n < pixels.length; n += 4)
    if (pixels[n + 3] === 255 && colour.every((value, k) => Math.abs(pixels[n + k] - value) < 3)) found++;
  return found / width / height;
};
const slider = document.getElementById("frame"), shades = [];
for (const frame of [0, slider.max]) {
  slider.value = frame; slider.dispatchEvent(new window.Event("input")); shades.push(count([224, 224, 224]));
}
return { shades, hot: count([242, 140, 26]), legend: document.getElementById("faces").innerText,
  over: document.documentElement.scrollWidth > window.innerWidth };
"""
    found = found_on(["faces.html"], script, faces, width)["faces.html"]
    assert found["shades"][0] == 0.0 and found["shades"][1] > 0.05
    assert found["hot"] > 0.0002 and not found["over"]
    assert "piston, speed 0.5" in found["legend"] and "T = 2, accommodation 0.5" in found["legend"]
    plain = found_on(["discs.html"], script.replace("slider.max", "0"), pages, width)["discs.html"]
    assert plain["legend"] == "" and plain["hot"] == 0.0


@needs_chromium
def test_it_colours_by_order_where_the_page_has_it(pages):
    scene = gp.Scene(gp.Container((6.0, 6.0), "periodic"), [gp.Species(14, 0.4, temperature=1.0)])
    simulation = gp.Simulation(scene, gp.EventDriven(search="direct"), seed=1)
    simulation.advance(duration=0.5)
    gp.view(simulation, frames=2, order=True).save(pages / "order.html")
    script = f"""{PIXELS}
const first = print(), names = [...get("colour").options].map(option => option.text);
const ordered = names.length > 2 && set("colour", "change", "order");
return {{ names, changed: ordered !== first, bar: get("bar").textContent.trim() }};
"""
    found = found_on(["order.html", "discs.html"], script, pages, 800)
    assert found["order.html"] == {
        "names": ["speed", "species", "order"],
        "changed": True,
        "bar": "|ψ6| 0 to 1",
    }
    assert found["discs.html"]["names"] == ["speed", "species"]


@needs_chromium
def test_playing_advances_the_frames(pages):
    script = """
window.eval('get("rate").value = "60"; get("toggle").click()');
const seen = new Set();
for (let n = 1; n < 40; n++) { window.eval(`step(due + ${n})`); seen.add(window.eval("frame")); }
return [...seen].sort();
"""
    assert found_on(["discs.html"], script, pages, 800)["discs.html"] == list(range(9))
