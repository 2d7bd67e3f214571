"""The pages in docs/: what they show runs as it stands there, and the reference is complete."""

import importlib.util
import re
import shlex
from pathlib import Path

import pytest

import gaspart as gp
from gaspart.cli import main
from gaspart.experiments.registry import families

DOCS = Path(__file__).parents[1] / "docs"


@pytest.mark.parametrize("name", ["quickstart", "tools"])
def test_a_page_runs_from_top_to_bottom(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = {}
    blocks = re.findall(r"^```(yaml|sh|python)\n(.*?)^```", (DOCS / f"{name}.md").read_text(), re.M | re.S)
    assert len(blocks) > 5
    for kind, text in blocks:
        if kind == "yaml":
            Path(re.match(r"# (\S+)\n", text)[1]).write_text(text)
        elif kind == "sh":
            for line in text.splitlines():
                program, *arguments = shlex.split(line)
                assert program == "gaspart"
                assert main(arguments) == 0, (line, capsys.readouterr())
        else:
            exec(compile(text, name, "exec"), names)
    assert "WRONG" not in capsys.readouterr().out


def test_links_between_pages_lead_somewhere():
    for path in [*DOCS.glob("*.md"), DOCS.parent / "README.md"]:
        for target in re.findall(r"\]\(([^)#:]+)\)", path.read_text(encoding="utf-8")):
            assert (path.parent / target).exists(), (path.name, target)


def test_the_reference_has_every_public_name_and_every_figure(tmp_path):
    spec = importlib.util.spec_from_file_location("build", DOCS / "build.py")
    build = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(build)
    build.build(tmp_path)
    api = (tmp_path / "api.html").read_text()
    for name in gp.__all__:
        assert f'<h3 id="{name}">' in api
    for figure, family in families().items():
        assert f'<h2 id="{figure}">' in (tmp_path / f"{family}.html").read_text()
    for page in tmp_path.glob("*.html"):
        text = page.read_text()
        assert "system-message" not in text, page.name  # a mistake in reStructuredText
        for target in re.findall(r'href="([^"#:]+)"', text):
            assert (tmp_path / target).exists()
