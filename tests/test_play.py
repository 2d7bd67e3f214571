"""The page of recorded runs with dials: a small grid of it works in headless Chromium."""

import importlib.util
import sys
from pathlib import Path

import pytest
from site_pages import CHROMIUM, found_on

pytestmark = pytest.mark.thorough

ROOT = Path(__file__).parents[1]
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")


@pytest.fixture(scope="module")
def play():
    """The script of docs/ as a module."""
    spec = importlib.util.spec_from_file_location("play", ROOT / "docs/play.py")
    loaded = sys.modules["play"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    yield loaded
    del sys.modules["play"]


@pytest.fixture(scope="module")
def pages(play, tmp_path_factory):
    """The folder of a page for one template, with two values of each dial."""
    folder = tmp_path_factory.mktemp("play")
    dials = tuple(play.Dial(one.name, one.values[:2], one.turned) for one in play.GRIDS["gas"])
    play.write(folder, {"gas": dials})
    return folder


def test_dials_turn_what_they_name(play):
    for name, dials in play.GRIDS.items():
        for dial in dials:
            scenes = [dial.turned(play.small(name), value) for value in dial.values]
            assert len({repr(scene) for scene in scenes}) == 3
    density, gravity = play.GRIDS["gas"]
    for value in density.values:
        assert density.turned(play.small("gas"), value).packing_fraction == pytest.approx(value, rel=0.03)
    assert [gravity.turned(play.small("gas"), value).gravity for value in gravity.values][1:] == [
        (0.0, -0.05),
        (0.0, -0.2),
    ]


def test_pages_that_are_too_large_are_refused(play, pages, monkeypatch):
    monkeypatch.setattr(play, "MOST", 1000)
    with pytest.raises(SystemExit, match="more than 1000"):
        play.write(pages / "again", {})


@needs_chromium
@pytest.mark.parametrize("width", [1400, 390])
def test_dials_choose_a_run_and_its_gauges(pages, width):
    script = """
const get = id => document.getElementById(id), seen = [];
for (const [first, second] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
  get("dial0").value = first; get("dial1").value = second;
  get("dial0").dispatchEvent(new window.Event("input"));
  seen.push([get("run").getAttribute("src"), get("value0").textContent, get("value1").textContent,
    get("meters").innerText]);
}
return { seen, over: document.documentElement.scrollWidth > window.innerWidth };
"""
    found = found_on(["index.html"], script, pages, width)["index.html"]
    sources, densities, gravities, meters = zip(*found["seen"], strict=True)
    assert list(sources) == [f"gas-{i}-{j}.html#play" for i, j in ((0, 0), (1, 0), (0, 1), (1, 1))]
    assert densities == ("0.05", "0.15", "0.05", "0.15") and gravities == ("0", "0", "0.05", "0.05")
    assert len(set(meters)) == 4 and all("pressure, y low" in one for one in meters)
    assert not found["over"]
    assert all((pages / source.partition("#")[0]).is_file() for source in sources)
