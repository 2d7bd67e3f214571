"""The report can be read by all: it fits, stays in its place, and axe-core finds nothing in it."""

import re
from importlib.resources import files

import pytest
from browser import CHROMIUM, found_by

pytestmark = pytest.mark.workflow

needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium to look at it with")
AXE = files("axe_core_python").joinpath("axe.min.js").read_text(encoding="utf-8")
RUN = """
await new Promise(loaded => addEventListener("load", loaded));
const moved = [], note = list => moved.push(...list.getEntries().map(one => one.value));
new PerformanceObserver(note).observe({ type: "layout-shift", buffered: true });
await new Promise(go => setTimeout(go, 1500));
const found = await axe.run(document, { resultTypes: ["violations"] });
const clips = it => it.closest(".wide, pre, table, math, nav, .strip");
return {
  moved,
  dark: matchMedia("(prefers-color-scheme: dark)").matches,
  rules: found.passes.length,
  violations: found.violations.map(
    one => `${one.id}, ${one.nodes.length} times: ${one.nodes[0].html.slice(0, 200)}`),
  page: document.documentElement.scrollWidth,
  wide: [...document.querySelectorAll("main *")].filter(
    it => it.getBoundingClientRect().right > innerWidth + 1 && !clips(it)).map(it => it.outerHTML),
};
"""


@needs_chromium
@pytest.mark.parametrize(("width", "dark"), [(1400, False), (390, True)])
def test_the_report_fits_stays_in_its_place_and_has_no_problem_for_axe(smoke, tmp_path, width, dark):
    script = AXE.replace("</script", "<\\/script") + RUN
    found = found_by(script, smoke.path / "results/smoke/report.html", tmp_path, width, dark)
    assert found["dark"] == dark and found["rules"] > 15
    assert found["violations"] == [] and found["moved"] == []
    assert found["wide"] == [] and found["page"] <= width


PLAIN = """
const frame = document.createElement("iframe");
Object.assign(frame, { width: 1400, height: 900, src: "report.html" });
frame.sandbox = "allow-same-origin";  // without scripts
document.body.prepend(frame);
await new Promise(loaded => { frame.onload = loaded; });
const page = frame.contentDocument, seen = it => it.getClientRects().length > 0;
const gas = () => page.querySelector(".live iframe").contentDocument;
while (!gas().querySelector("#still path")) await new Promise(go => setTimeout(go, 50));
return {
  figures: [...page.querySelectorAll("section.figure h3")].filter(seen).length,
  seen: ["nav summary", ".result", "#claims"].filter(name => seen(page.querySelector(name))),
  gas: [...gas().querySelectorAll("header, aside, canvas, button, #still")].filter(seen).map(it => it.id),
};
"""


@needs_chromium
def test_without_scripts_the_report_has_its_contents_and_a_still_gas(smoke, tmp_path):
    found = found_by(PLAIN, smoke.path / "results/smoke/report.html", tmp_path, 1400)
    assert found["figures"] == len(smoke.figures) and found["gas"] == ["still"]
    assert found["seen"] == ["nav summary", ".result", "#claims"]


def test_the_first_screen_is_small_and_nothing_is_fetched_from_elsewhere(smoke):
    results = smoke.path / "results/smoke"
    page, gas = ((results / name).read_text(encoding="utf-8") for name in ("report.html", "play.html"))
    first = page[: page.index('<h2 id="findings">')]
    assert 'src="play.html"' in first and "<video" not in first
    assert len(first.encode()) + len(gas.encode()) < 300_000 and len(gas.encode()) < 200_000
    form = r'(?:src|srcset|poster)="([^"]+)"|<link[^>]+href="([^"]+)"|@import|url\('
    fetched = re.findall(form, page + gas)
    assert fetched and not [one for one in fetched if "//" in "".join(one)]
