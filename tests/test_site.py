"""The documentation site: it is built without a warning, complete, and fits into a window and a telephone."""

import os
import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

import pytest
from site_pages import CHROMIUM, found_on

import gaspart as gp
from gaspart import theory
from gaspart.cli import commands
from gaspart.cli.new import templates
from gaspart.reproduction.registry import families

pytestmark = pytest.mark.thorough

ROOT = Path(__file__).parents[1]
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
TOO_WIDE = """
const wide = [...document.querySelectorAll("article *, main > *")].filter(it =>
  it.getBoundingClientRect().right > window.innerWidth + 1 && !it.closest("table, pre, .math, .sig"));
if (document.documentElement.scrollWidth > window.innerWidth) return "the page";
return wide.map(it => it.outerHTML)[0] || "";
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, with its notebooks as they are kept: without output."""
    folder = tmp_path_factory.mktemp("site")
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "-D", "nb_execution_mode=off"]
    done = subprocess.run(
        [*command, "-d", folder / "doctrees", ROOT / "docs", folder / "html"],
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return folder / "html"


def pages(site):
    """All pages but the listings of source code."""
    return [path for path in site.rglob("*.html") if "_modules" not in path.parts]


def anchors(path):
    return set(re.findall(r'id="([^"]+)"', path.read_text(encoding="utf-8")))


def test_every_public_name_command_scene_and_figure_is_there(site):
    api = set().union(*(anchors(path) for path in (site / "generated/api").glob("*.html")))
    elsewhere = {"gaspart.__version__", "gaspart.analysis", "gaspart.theory"}
    assert {f"gaspart.{name}" for name in gp.__all__} - elsewhere <= api
    assert {f"gaspart.analysis.{name}" for name in gp.analysis.__all__} <= api
    assert {f"gaspart.theory.{name}" for name in theory.__all__} <= api
    assert {f"gaspart-{name}" for name in commands()} <= anchors(site / "generated/command-line.html")
    assert {f"scene-{name}" for name in templates()} <= anchors(site / "generated/gallery.html")
    for figure, family in families().items():
        assert f"figure-{figure.replace('_', '-')}" in anchors(site / f"generated/figures/{family}.html")


def test_links_lead_somewhere(site):
    count = 0
    for page in pages(site):
        for target in re.findall(r'(?:href|src)="([^":]+)"', page.read_text(encoding="utf-8")):
            path, _, place = unquote(target).partition("#")
            found = (page.parent / path.partition("?")[0]) if path else page
            made = found.resolve() == (site / "play/gas.html").resolve()  # by `make docs`
            assert found.exists() or made, (page.name, target)
            if place and found.suffix == ".html" and "_modules" not in found.parts:
                count += 1
                assert place in anchors(found) or place == "furo-main-content", (page.name, target)
    assert count > 1000


@needs_chromium
@pytest.mark.parametrize("width", [1400, 390])
def test_nothing_is_wider_than_its_column(site, width):
    wide = site / "wide.html"
    style = '<meta name="viewport" content="width=device-width"><main><p style="width: 1500px">A</p></main>'
    wide.write_text(f"<!doctype html>{style}")
    addresses = [str(page.relative_to(site)) for page in pages(site)]
    found = found_on(addresses, TOO_WIDE, site, width)
    wide.unlink()
    assert found.pop("wide.html") == "the page"  # what is too wide is noticed
    assert len(found) > 50 and not any(found.values()), found
