"""The report can be read by all: axe-core finds nothing serious in it, wide, narrow and dark."""

from importlib.resources import files

import pytest
from browser import CHROMIUM, found_by

pytestmark = [
    pytest.mark.workflow,
    pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here to look at the report with"),
]

AXE = files("axe_core_python").joinpath("axe.min.js").read_text(encoding="utf-8")
RUN = """
const found = await axe.run(document, { resultTypes: ["violations"] });
return {
  dark: matchMedia("(prefers-color-scheme: dark)").matches,
  rules: found.passes.length,
  violations: found.violations.filter(one => ["serious", "critical"].includes(one.impact)).map(
    one => `${one.id}, ${one.nodes.length} times: ${one.nodes[0].html.slice(0, 200)}`),
};
"""


@pytest.mark.parametrize(("width", "dark"), [(1400, False), (390, True)])
def test_axe_finds_no_serious_problem(smoke, tmp_path, width, dark):
    script = AXE.replace("</script", "<\\/script") + RUN
    found = found_by(script, smoke.path / "results/smoke/report.html", tmp_path, width, dark)
    assert found["dark"] == dark and found["rules"] > 15
    assert found["violations"] == []
