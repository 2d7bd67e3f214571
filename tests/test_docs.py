"""The pages in docs/: what they show runs as it stands there, the reference is complete, and pictures of the
README are those of complete results."""

import ast
import importlib.util
import re
import shlex
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from PIL import Image

import gaspart as gp
from gaspart.cli import commands, main
from gaspart.scene.faces import FACE_KINDS
from gaspart.yaml_text import parse_yaml

DOCS = Path(__file__).parents[1] / "docs"
SOURCE = DOCS.parent / "src/gaspart"
FAMILY = {SOURCE / name for name in ("measure.py", "claims.py", "figure.py")}  # one in each family


@pytest.mark.parametrize(
    "name",
    ["quickstart", *(pytest.param(page, marks=pytest.mark.thorough) for page in ("accuracy", "tools"))],
)
def test_a_page_runs_from_top_to_bottom(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names, printed = {}, ""
    blocks = re.findall(
        r"^```(yaml|sh|python|text)\n(.*?)^```", (DOCS / f"{name}.md").read_text(), re.M | re.S
    )
    assert len(blocks) > 3
    for kind, text in blocks:
        if kind == "text":
            printed += capsys.readouterr().out
            assert not [line for line in text.splitlines() if line not in printed.splitlines()]
        elif kind == "yaml":
            Path(re.match(r"# (\S+)\n", text)[1]).write_text(text)
        elif kind == "sh":
            for line in text.splitlines():
                program, *arguments = shlex.split(line)
                assert program == "gaspart"
                assert main(arguments) == 0, (line, capsys.readouterr())
        else:
            exec(compile(text, name, "exec"), names)
    assert "WRONG" not in printed + capsys.readouterr().out


def parts(page):
    """The statements of the Python blocks of a page, each with the value behind its # (None if there is
    none)."""
    for block in re.findall(r"^```python\n(.*?)^```", (DOCS / f"{page}.md").read_text(), re.M | re.S):
        lines = block.splitlines()
        for statement in ast.parse(block).body:
            stated = re.search(r"  # ([-\d.,e]+)$", lines[statement.end_lineno - 1])
            yield statement, stated and ast.literal_eval(stated[1])


def test_the_units_give_what_they_state():
    names, compared = {}, 0
    for statement, stated in parts("conventions"):
        if stated is None:
            exec(compile(ast.Module([statement], []), "conventions", "exec"), names)
            continue
        value = eval(compile(ast.Expression(statement.value), "conventions", "eval"), names)
        assert value == pytest.approx(stated, rel=1e-4), ast.unparse(statement)
        compared += 1
    assert compared >= 9


def script(name):
    """A script of docs/ as a module."""
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_architecture_is_that_of_the_code():
    picture = script("architecture_picture")
    graph, order = picture.imports(), list(picture.purposes())
    assert set(order) == set(graph)
    for package, used in graph.items():
        assert all(order.index(one) < order.index(package) for one in used), package
    drawn = re.search(r"<dc:description>(.*?)</dc:description>", (DOCS / "architecture.svg").read_text())[1]
    assert drawn.replace("&gt;", ">") == picture.stated(picture.reduced(graph)), "draw the picture again"


def named_files(text):
    """Paths of the files that a page names; in a row of a table, in the package of that row."""
    for line in text.splitlines():
        row = re.match(r"\| `(\w+)` \|", line)
        for name in re.findall(r"`([\w/.-]+(?:\.py|\.yaml|\.json|\.md|/))`", line):
            places = [SOURCE / row[1] / name] if row else [SOURCE / name, DOCS.parent / name]
            yield next((place for place in places if place.exists()), places[0])


def test_files_and_functions_that_the_architecture_names_exist():
    text = (DOCS / "architecture.md").read_text(encoding="utf-8")
    files = [path for path in named_files(text) if path not in FAMILY]
    assert len(files) > 20
    assert not [path for path in files if not path.exists()]
    found = re.findall(r"`(\w+)`(?: and `(\w+)`)? in\s+`([\w/]+\.py)`", text)
    assert len(found) > 30
    for *names, file in found:
        code = (SOURCE / file).read_text(encoding="utf-8")
        for name in filter(None, names):
            assert re.search(rf"^(?:def |class )?(?:\w+, )*{name}\b.*[:=(]", code, re.MULTILINE), (name, file)


def test_lines_that_the_page_on_help_explains_exist():
    source = "".join(path.read_text(encoding="utf-8") for path in SOURCE.rglob("*.py"))
    page = (DOCS / "installation.md").read_text(encoding="utf-8")
    text = page.partition("\n## When something goes wrong\n")[2]
    rows = re.findall(r"^\| (`.+?) \|", text, re.M)
    lines = [line for row in rows for line in re.findall(r"`([^`]+)`", row)]
    assert len(lines) > 12
    assert not [line for line in lines if line not in source]


def test_links_between_pages_lead_somewhere():
    for path in [*DOCS.glob("*.md"), DOCS.parent / "README.md"]:
        for target in re.findall(r"\]\(([^)#:]+)\)", path.read_text(encoding="utf-8")):
            made = target.startswith("generated/")  # by `make docs`, which fails for a link to nothing
            assert made or (path.parent / target).exists(), (path.name, target)


def test_the_guide_explains_every_option_of_a_run():
    guide = " ".join(
        path.read_text(encoding="utf-8") for path in [*DOCS.glob("*.md"), DOCS.parent / "README.md"]
    )
    words = set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", guide))
    options = [one.option_strings for one in commands()["run"]._actions if one.option_strings]
    assert len(options) > 30
    assert not [names for names in options if not words.intersection(names)]


def test_the_scenes_of_the_page_on_scene_files_are_valid():
    blocks = re.findall(r"^```yaml\n(.*?)^```", (DOCS / "scenes.md").read_text(), re.M | re.S)
    scenes = [gp.Scene.from_dict(parse_yaml(block)) for block in blocks]
    kinds = {face.kind for scene in scenes for face in scene.faces.values()}
    walls = {type(wall) for scene in scenes for wall in scene.walls}
    assert kinds == set(FACE_KINDS) and walls == {gp.Wall, gp.Plate}


@pytest.fixture(scope="module")
def gallery():
    return script("gallery")


@pytest.fixture
def results(tmp_path, gallery):
    """Figures of one colour, as a complete reproduction leaves them."""
    for folder in ("figures", "measurements"):
        (tmp_path / folder).mkdir()
    for n, name in enumerate(name for names in gallery.COLUMNS for name in names):
        Image.new("RGB", (700, 500), (40 * n, 0, 0)).save(tmp_path / f"figures/{name}.png")
        with netCDF4.Dataset(tmp_path / f"measurements/{name}.nc", "w") as data:
            data.config, data.git_revision = "full reproduction", "abc"
    return tmp_path


def test_it_is_made_of_the_figures_and_names_their_results(gallery, results):
    gallery.gallery(results, results / "a.png")
    gallery.gallery(results, results / "b.png")
    assert (results / "a.png").read_bytes() == (results / "b.png").read_bytes()
    with Image.open(results / "a.png") as picture:
        assert picture.text == {"config": "full reproduction", "revision": "abc"}
        first, second = gallery.COLUMNS.values()
        assert picture.width == first + gallery.GAP + second
        assert [picture.getpixel((x + 9, 9))[0] for x in (0, first + gallery.GAP)] == [0, 80]


def test_results_of_another_config_do_not_replace_it(gallery, results):
    with netCDF4.Dataset(results / "measurements/virial_spheres.nc", "a") as data:
        data.config = "smoke"
    with pytest.raises(ValueError, match="is of 'smoke', not of 'full reproduction'"):
        gallery.gallery(results, results / "a.png")
    (results / "figures/virial_spheres.png").unlink()
    with pytest.raises(ValueError, match="missing"):
        gallery.gallery(results, results / "a.png")
    assert not (results / "a.png").exists()


def test_the_picture_that_is_kept_names_its_results():
    with Image.open(DOCS / "gallery.png") as picture:
        assert picture.text["config"] == "full reproduction" and picture.text["revision"]


def test_the_gallery_and_its_picture_follow_from_the_scenes():
    """If not: python docs/contact_sheet.py."""
    contact_sheet = script("contact_sheet")
    assert (DOCS / "gallery.md").read_text(encoding="utf-8") == contact_sheet.page()
    with Image.open(DOCS / "scenes.png") as kept:
        difference = np.abs(np.asarray(kept.convert("RGB"), float) - np.asarray(contact_sheet.sheet(), float))
    assert difference.mean() < 2.0  # of 255: a palette of 256 colours
