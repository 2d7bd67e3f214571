"""Every command block of README and docs: accepted in `make test`, run in `make test-all`."""

import re
import shlex
from pathlib import Path

import pytest

from gaspart.cli import _parser, main

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(r"^```sh\n(.*?)^```", re.MULTILINE | re.DOTALL)
INDENTED = re.compile(r"^(?: {4,}|# {2,}|# \S+: +)((?:gaspart|snakemake) .*)$", re.MULTILINE)


def commands(program, pages=PAGES):
    """The command lines (page, words) of the blocks of pages, without their comments."""
    for page in pages:
        text = page.read_text(encoding="utf-8")
        for line in [*"".join(BLOCK.findall(text)).splitlines(), *INDENTED.findall(text)]:
            words = shlex.split(line, comments=True)
            if words[:1] == [program]:
                yield page, words[1:]


GASPART = list(commands("gaspart"))
SNAKEMAKE = list(commands("snakemake", [*PAGES, *sorted((ROOT / "config").glob("*.yaml"))]))


def test_the_pages_have_commands():
    assert len(GASPART) > 30 and len(SNAKEMAKE) > 10


def test_every_command_of_gaspart_is_accepted():
    for page, words in GASPART:
        assert vars(_parser(words).parse_args(words)), (page.name, words)


def test_a_target_is_never_read_as_a_config():
    """`--configfile FILE TARGET` takes both as configs, and ends in a traceback."""
    parser = pytest.importorskip("snakemake.cli").get_argument_parser()
    for page, words in SNAKEMAKE:
        files = [Path(file) for file in parser.parse_args(words).configfile or ()]
        written = re.findall(
            r"^ *(?:# |title=\"|```yaml title=\")([\w/-]+\.yaml)",
            page.read_text(encoding="utf-8"),
            re.MULTILINE,
        )
        assert all((ROOT / file).exists() or str(file) in written for file in files), (page.name, words)


@pytest.mark.thorough
@pytest.mark.parametrize("page", ["estimators", "scenes"])
def test_the_commands_of_a_page_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for _, words in commands("gaspart", [ROOT / f"docs/{page}.md"]):
        assert main(words) == 0, words


@pytest.mark.thorough
@pytest.mark.parametrize("page", ["dsmc", "event-driven", "time-stepped"])
def test_the_lines_of_a_page_run(page):
    import gaspart as gp

    scene = gp.Scene(gp.Container((20.0, 20.0)), [gp.Species(40, 0.5, temperature=1.0)])
    for block in re.findall(r"^```python\n(.*?)^```", (ROOT / f"docs/{page}.md").read_text(), re.M | re.S):
        exec(compile(block, page, "exec"), {"gp": gp, "scene": scene})


@pytest.mark.thorough
@pytest.mark.workflow
def test_every_command_of_snakemake_plans(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "tests/workflow"))
    from workspace import copy_of_project

    copy, plain = copy_of_project(tmp_path), ("--report", "--workflow-profile", "--delete-temp-output")
    for page in PAGES:
        blocks = r"^```yaml(?: title=\"([\w-]+\.yaml)\")?\n(?:# ([\w-]+\.yaml)[^\n]*\n)?(.*?)^```"
        for title, named, text in re.findall(blocks, page.read_text(encoding="utf-8"), re.M | re.S):
            if (name := title or named) and "experiments:" in text:
                (copy.path / name).write_text(text, encoding="utf-8")
    failed = []
    of_code = ("fast_particles", "free_path")  # figures of modules that a page prints
    for page, words in SNAKEMAKE:
        if not set(words) & set(plain) and not any(name in " ".join(words) for name in of_code):
            result = copy.snakemake("--dry-run", *words)
            if result.returncode:
                failed.append((page.name, words, result.stdout[-1000:]))
    assert not failed
