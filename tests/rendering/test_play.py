"""The page on which a gas runs: it has the bits of simulations, and works in browsers."""

import json
import re
import subprocess
from pathlib import Path

import axe_core_python
import numpy as np
import pytest
import yaml
from browsers import CHROMIUM, FIREFOX, found_in
from sessions import NODE, SEED, SESSION, asked, differences, in_node, natively, page_data, random_steps

import gaspart as gp
from gaspart.cli import main
from gaspart.cli.new import templates
from gaspart.kernels.compile import webassembly
from gaspart.rendering import play
from gaspart.rendering.controls import Controls
from gaspart.state.initial import initial_state

needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
BROWSERS = [
    pytest.param(CHROMIUM, marks=needs_chromium, id="chromium"),
    pytest.param(FIREFOX, marks=pytest.mark.skipif(FIREFOX is None, reason="no Firefox"), id="firefox"),
]
MOST = 1_000_000  # bytes of a page
OLD = Path(__file__).with_name("old_states.json")  # of the scene `lorentz`, by a page of commit 74e2cd31
AXE = Path(axe_core_python.__file__).with_name("axe.min.js")
DRIVE = """
const wait = ms => new Promise(go => setTimeout(go, ms)), byId = id => document.getElementById(id);
const ready = async () => { await wait(50); while (busy) await wait(20); };
const set = async (id, value) => {
  byId(id).value = value; byId(id).oninput?.(); byId(id).onchange(); await ready();
};
const steps = async number => {
  for (let n = 0; n < number; n++) { byId("step").click(); while (busy) await wait(1); }
};
const over = () => document.documentElement.scrollWidth > innerWidth;
await ready();
"""


def scene_of(name):
    return gp.Scene.from_dict(yaml.safe_load(templates()[name].text))


def lorentz():
    """Light discs among fixed ones: their pages need a single kind of kernels."""
    species = [gp.Species(60, 0.2, temperature=1.0), gp.Species(8, 0.5, fixed=True)]
    return gp.Scene(gp.Container((12.0, 9.0), ("wall", "periodic")), species)


@pytest.fixture(scope="module")
def gas(tmp_path_factory):
    """A page of the template gas, which has all kinds of kernels."""
    return gp.play(scene_of("gas"), SEED).save(tmp_path_factory.mktemp("play") / "gas.html")


def compared(scene, folder, number, seed, duration):
    """What differs between page and simulations, and the number of collisions."""
    data = page_data(scene, folder)
    controls, steps = random_steps(scene, number, seed, duration)
    ours, theirs = in_node(controls, steps, data, folder), natively(controls, steps)
    return differences(controls, steps, ours, theirs), sum(result["collisions"] for result in theirs)


@needs_node
def test_a_page_has_the_bits_of_simulations(tmp_path):
    # Of this seed all contacts lose energy and a face is thermal: natively, one kind of kernels does.
    differ, collisions = compared(lorentz(), tmp_path, 3, 17, 300.0)
    assert not differ
    assert collisions > 10_000


@needs_node
@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", ["gas", "heat", "rough", "chambers"])
def test_pages_of_all_kinds_have_the_bits_of_simulations(name, seed, tmp_path):
    differ, collisions = compared(scene_of(name), tmp_path, 10, seed, 1500.0)
    assert not differ
    assert collisions > 20_000


@pytest.mark.thorough
@pytest.mark.parametrize("browser", BROWSERS)
def test_browsers_have_the_bits_of_simulations(browser, gas, tmp_path):
    controls, steps = random_steps(scene_of("gas"), 10, 5, 1500.0)
    script = f"{SESSION.read_text()} while (busy) await new Promise(go => setTimeout(go, 20));"
    script += f"return await session(Gas, startOf, data, {json.dumps(asked(controls, steps, 2))});"
    ours, lines = found_in(browser, gas, script, tmp_path)
    theirs = natively(controls, steps)
    assert not lines and not differences(controls, steps, ours, theirs)
    assert sum(result["collisions"] for result in theirs) > 100_000


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A page of the scene `lorentz`."""
    return gp.play(lorentz(), SEED).save(tmp_path_factory.mktemp("play") / "page.html")


@needs_chromium
def test_a_page_runs_in_a_browser(page, tmp_path):
    script = """
await steps(70);
await set("x_low", 3);
const time = gas.time + elapsed;
return { rows: byId("meters").innerText, flags: gas.flags, over: over(), width: innerWidth, time };
"""
    found, lines = found_in(CHROMIUM, page, DRIVE + script, tmp_path, width=390)
    assert not lines and not found["over"] and found["width"] == 390
    assert found["flags"] == "rt" and found["time"] > 0.0


@needs_chromium
def test_links_and_files_of_the_first_pages_open(page, tmp_path):
    script = """
const inPage = () => {
  const { positions, velocities } = gas.state;
  return [[...positions], [...velocities], byId("x_low").value, byId("note").textContent];
};
const give = async text => {
  const files = new DataTransfer(); files.items.add(new File([text], "gas.json"));
  byId("open").files = files.files; byId("open").onchange({ target: byId("open") }); await ready();
};
const seen = [inPage()];
byId("anew").click(); await ready();
await give(JSON.stringify(FILE)); seen.push(inPage());
byId("link").click(); await ready();
const saved = JSON.parse(decodeURIComponent(location.hash.slice(7)));
seen.push([saved.settings, new Float64Array(bytesOf(saved.positions).buffer).length]);
FILE.page.values.x_low = 99; await give(JSON.stringify(FILE)); seen.push(inPage());
FILE.page.values.x_low = 3; FILE.state.spins.pop(); await give(JSON.stringify(FILE)); seen.push(inPage());
await give("{}"); seen.push(inPage());
return seen;
"""
    old = json.loads(OLD.read_text())
    script = f"{DRIVE} const FILE = {json.dumps(old['file'])}; {script}"
    found, lines = found_in(CHROMIUM, page, script, tmp_path, fragment=old["link"])
    link, file, again, *refused = found
    state = [np.array(old["file"]["state"][name]).ravel().tolist() for name in ("positions", "velocities")]
    assert not lines and link == file == [*state, "3", ""]
    assert again == [{"restitution": 1, "roughness": -1, "x_low": 1, "x_high": 0}, 136]
    assert [values[:3] for values in refused] == [file[:3]] * 3
    assert all(note.startswith("this file does not fit this page: ") for *_, note in refused)


@needs_chromium
def test_a_broken_link_opens_the_gas_with_a_line(page, tmp_path):
    script = f'{DRIVE} return [gas.flags, byId("note").textContent];'
    found, lines = found_in(CHROMIUM, page, script, tmp_path, fragment="#state=%7B")
    flags, note = found
    assert not lines and flags == "r" and note.startswith("this link does not fit this page")


def test_a_page_shows_all_particles_before_it_runs(gas):
    (still,) = re.findall('<svg id="still".*?</svg>', gas.read_text(), re.DOTALL)
    assert still.count("h0") == scene_of("gas").count and 'viewBox="0 0 48 36"' in still


@needs_chromium
def test_in_a_frame_of_another_page_the_gas_runs_alone(page, tmp_path):
    named = tmp_path / "page.html"
    named.write_text(page.read_text().replace("<head>", '<head><script>window.name = "alone"</script>'))
    script = """
for (let n = 0; n < 200 && !gas.time; n++) await wait(50);
const shown = [...document.querySelectorAll("h1, aside, footer, fieldset, svg, canvas, button")].filter(
  it => it.getClientRects().length).map(it => it.id);
return { shown, time: gas.time, over: document.documentElement.scrollHeight > innerHeight };
"""
    found, lines = found_in(CHROMIUM, named, DRIVE + script, tmp_path, width=600, height=400)
    assert not lines and found["time"] > 0.0 and not found["over"]
    assert found["shown"] == ["canvas", "run"]


@pytest.mark.thorough
@pytest.mark.parametrize("width", [1400, 390])
@pytest.mark.parametrize("browser", BROWSERS)
def test_controls_and_gauges_work(browser, width, gas, tmp_path):
    assert gas.stat().st_size < MOST
    script = """
const seen = {};
await steps(70);
seen.plain = gauges();
await set("gravity", 6); await steps(20);
seen.gravity = [gas.flags, byId("heights").parentNode.hidden];
await set("x_low", 12); await set("restitution", 4);
seen.grains = gas.flags;
await set("x_low", 0);
seen.refused = [byId("note").textContent, byId("x_low").value];
await set("restitution", 0); await set("gravity", 0); await set("x_low", 0);
await set("piston", 1); await set("place", 10);
for (let n = 0; n < 100 && goal; n++) await steps(4);
await steps(70);
seen.pressed = [gas.flags, gas.pistonAt(gas.clock) / data.lengths[0], gauges()];
byId("reverse").click(); await ready();
seen.echo = byId("meters").innerText;
byId("link").click(); await ready();
const kept = gas.state, { hash } = location;
await steps(5);
const saved = JSON.parse(decodeURIComponent(hash.slice(7)));
seen.kept = new Float64Array(bytesOf(saved.positions).buffer).every((x, n) => x === kept.positions[n]);
seen.over = over();
return seen;
"""
    found, lines = found_in(browser, gas, DRIVE + script, tmp_path, width=width)
    assert not lines and not found["over"]
    names = [name for name, *_ in found["plain"]]
    assert [name for name in names if "pressure" in name] == [
        f"pressure, {side} wall" for side in ("left", "right", "lower", "upper")
    ]
    assert found["gravity"] == ["g", False] and found["grains"] == "grt"
    assert "grains" in found["refused"][0] and found["refused"][1] == "12"
    flags, place, gauges = found["pressed"]
    assert flags == "p" and place == pytest.approx(0.7)
    for name, *numbers in gauges:
        if "pressure" in name:
            value, error, theory = numbers
            assert abs(value - theory) < 5.0 * error
    assert "echo" in found["echo"] and found["kept"]


@needs_chromium
@pytest.mark.thorough
def test_axe_finds_nothing(gas, tmp_path):
    script = f"{DRIVE} {AXE.read_text()}; return (await axe.run()).violations.map(one => one.id);"
    found, _ = found_in(CHROMIUM, gas, script, tmp_path)
    assert found == []


@pytest.mark.thorough
def test_modules_are_reproducible_and_import_only_memory_and_fmod(tmp_path):
    scene = lorentz()
    image = play._image(scene, Controls(scene), "r", initial_state(scene, 1), 1)
    (first,), (second,) = (webassembly._build([image["kernels"]]) for _ in range(2))
    assert first == second
    path = tmp_path / "module.wasm"
    path.write_bytes(first)
    script = "const code = new WebAssembly.Module(require('fs').readFileSync(process.argv[1]));"
    script += "console.log(WebAssembly.Module.imports(code).map(item => item.name).join(' '))"
    names = subprocess.run(
        [NODE, "-e", script, path], capture_output=True, text=True, check=True
    ).stdout.split()
    assert set(names) <= {"__linear_memory", "__stack_pointer", "fmod"}


def test_a_saved_state_continues(tmp_path, capsys):
    scene = lorentz()
    state = gp.Simulation(scene, seed=1).state
    saved = {"positions": state.positions.tolist(), "velocities": state.velocities.tolist()}
    saved |= {"spins": state.spins.tolist(), "piston": None}
    path = tmp_path / "gas.json"
    path.write_text(json.dumps({"scene": scene.to_dict(), "state": saved}))
    assert gp.Scene.from_file(path) == scene
    assert (gp.read_state(path, scene).velocities == state.velocities).all()
    old = json.loads(OLD.read_text())["file"]
    path.write_text(json.dumps(old))
    read = gp.read_state(path, gp.Scene.from_file(path))
    assert read.positions.tolist() == old["state"]["positions"]
    path.write_text(json.dumps({"scene": scene.to_dict(), "state": {}}))
    assert (
        main(["run", str(path), "--from", str(path), "-o", str(tmp_path / "gas.nc"), "--duration", "1"]) == 2
    )
    assert capsys.readouterr().err.count("\n") == 1


def test_a_scene_that_cannot_run_in_a_browser_is_refused_in_one_line(tmp_path, capsys):
    for name in ("spheres", "sheared", "adsorption", "effusion"):
        assert main(["play", "--template", name, "-o", str(tmp_path / "page.html")]) == 2
        printed = capsys.readouterr().err
        assert printed.count("\n") == 1 and "browser" in printed
    assert not list(tmp_path.iterdir())
