"""Lines of errors that name the true cause, file and remedy."""

import pytest

import gaspart as gp
from gaspart.cli import main

GAS = "container: {lengths: [12.0, 12.0]}\nspecies:\n- {count: 120, radius: 0.5, temperature: 1.0}\n"
SHORT = ("--duration", "1", "--sample-interval", "0.5", "--quiet")


def refused(capsys, *words):
    """The one line of a refused command."""
    assert main([str(word) for word in words]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1
    return err


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def written(text):
        (tmp_path / "gas.yaml").write_text(text)
        return "gas.yaml"

    return written


def test_what_cannot_be_placed_names_the_file(file, capsys):
    scene = file(GAS)
    start = "gaspart: error: gas.yaml: species[0].count = 120: does not fit by random insertion"
    assert refused(capsys, "run", scene, "-o", "a.nc", *SHORT).startswith(start)
    assert refused(capsys, "collisions", scene, "-o", "a.nc", "--count", 9).startswith(start)
    scene = file(
        GAS.replace("temp", "arrangement: lattice, temp")
        .replace("120", "130")
        .replace("[12.0, 12.0]", "[10.7, 10.7]")
    )
    assert refused(capsys, "run", scene, "-o", "a.nc", *SHORT).startswith(
        "gaspart: error: gas.yaml: arrangement"
    )
    line = refused(capsys, "run", file(GAS.replace("120", "12")), "-o", "a.nc", *SHORT, "--seed", "-1")
    assert line.startswith("gaspart: error: seed = -1")  # which is not of the file


@pytest.mark.parametrize(("key", "value"), [("temperature: 1.0", "1.0 K"), ("radius: 0.5", "0.5 m")])
def test_a_unit_is_not_called_negative(file, capsys, key, value):
    text = GAS.replace(key, f"{key.partition(':')[0]}: {value}")
    assert f"= '{value}': must be a number, without a unit" in refused(capsys, "check", file(text))


@pytest.mark.interpreted
def test_python_is_told_of_overwrite_and_the_command_line_of_its_option(file, capsys):
    scene = file(GAS.replace("120", "12"))
    assert main(["run", scene, "-o", "a.nc", *SHORT]) == 0
    capsys.readouterr()
    assert "overwrite it (--force)" in refused(capsys, "run", scene, "-o", "a.nc", *SHORT, "--seed", 2)
    with pytest.raises(gp.SceneError, match=r"overwrite it \(overwrite=True\)"):
        gp.run(gp.Scene.from_file(scene), gp.EventDriven(), 2, 1.0, 0.5, "a.nc")


def test_a_folder_of_a_name_is_not_a_file(file, capsys):
    scene = file(GAS)
    for words in (("check",), ("run", "-o", "a.nc", *SHORT)):
        line = refused(capsys, words[0], f"{scene}/", *words[1:])
        assert "cannot be read: Not a directory" in line


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ["Z", "contact_value", "mean_free_path", "collision_rate", "viscosity"])
def test_a_density_beyond_all_ranges_is_one_line(capsys, name):
    assert "this formula holds from 0 to 0.539" in refused(capsys, "theory", name, "--eta=1e308")
