"""`gaspart new`: every template is a valid scene, with a command that runs it."""

import shlex
from pathlib import Path

import pytest

import gaspart as gp
from gaspart.cli import commands, main
from gaspart.cli.new import templates
from gaspart.reproduction.registry import families

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", templates())
def test_a_template_is_a_scene_with_its_command_and_picture(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    template = templates()[name]
    assert main(["new", "my scene.yaml", "--template", name]) == 0
    printed = capsys.readouterr().out.splitlines()[-1]
    written = Path("my scene.yaml").read_text(encoding="utf-8")
    assert f"#   {printed}\n" in written and "figure" not in written
    program, command, *arguments = shlex.split(printed)
    given = commands()[command].parse_args(arguments)
    assert (program, given.scene, given.path) == ("gaspart", "my scene.yaml", "my scene.nc")
    assert gp.Scene.from_file("my scene.yaml").to_dict()["container"]
    samples = given.duration / given.sample_interval
    assert samples == pytest.approx(round(samples)) and 50 <= samples <= 200
    assert template.figure is None or template.figure in families()
    assert (ROOT / f"docs/scenes/{name}.png").stat().st_size < 120_000


def test_no_template_is_left_out():
    assert {path.stem for path in (ROOT / "src/gaspart/cli/templates").iterdir()} == set(templates())


def test_a_run_of_the_first_template(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "gas.yaml"]) == 0
    command = shlex.split(capsys.readouterr().out.splitlines()[-1])[1:]
    assert main([*command, "--duration", "4", "--quiet"]) == 0
    with gp.open_trajectory("gas.nc") as run:
        assert run.sizes["frame"] == 11


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ([], "scene = None: give the name of the file, or --list"),
        (["gas"], "scene = 'gas': must be a printable name that ends in .yaml"),
        (["a\nb.yaml"], "must be a printable name that ends in .yaml"),
        (["notes.yaml", "--force"], "exists and is not a scene file"),
        (["scene.yaml"], "exists; move it away, or overwrite it (--force)"),
        (["gas.yaml", "--template", "ga"], "--template: 'ga': unknown name; did you mean gas?"),
    ],
)
def test_what_is_refused(arguments, complaint, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("notes.yaml").write_text("a: 1\n")
    Path("scene.yaml").write_text(templates()["heat"].text)
    assert main(["new", *arguments]) == 2
    assert complaint in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["notes.yaml", "scene.yaml"]
    assert main(["new", "scene.yaml", "--force"]) == 0
