"""`gaspart films`: a film of each scene by one command."""

from pathlib import Path

from PIL import Image

from gaspart.cli import main
from gaspart.cli.new import templates
from gaspart.cli.view import _BY_SPECIES


def test_a_film_of_a_scene_is_made_once_and_kept(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = ["films", "slides", "gas", "--gif", "--size", "160x90"]
    assert main(command) == 0 and capsys.readouterr().out == "slides/gas.gif\n"
    film = Path("slides/gas.gif")
    with Image.open(film) as picture:
        assert picture.size == (160, 90) and picture.n_frames > 50
    made = film.stat().st_mtime_ns
    assert main(command) == 0 and film.stat().st_mtime_ns == made
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["gas.gif", "slides"]


def test_an_unknown_scene_is_refused_before_any_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["films", "slides", "gas", "shakn"]) == 2
    assert "unknown name; did you mean shaken?" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_the_scenes_coloured_by_species_exist():
    assert set(_BY_SPECIES) <= set(templates())


def test_a_trajectory_is_no_folder_of_films(capsys):
    assert main(["films", "gas.nc"]) == 2
    assert "of one trajectory: gaspart film gas.nc -o gas.mp4" in capsys.readouterr().err


def test_a_film_of_a_trajectory_has_a_clock_unless_it_is_plain(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("gas.yaml").write_text(templates()["gas"].text)
    words = ["run", "gas.yaml", "-o", "gas.nc", "--duration", "0.8", "--sample-interval", "0.4", "--quiet"]
    assert main(words) == 0
    made = {}
    for name, more in {"clock": [], "plain": ["--plain"]}.items():
        words = ["film", "gas.nc", "-o", f"{name}.gif", "--size", "240x180", *more]
        assert main(words) == 0
        with Image.open(f"{name}.gif") as picture:
            made[name] = picture.convert("RGB").tobytes()
    assert made["clock"] != made["plain"]
    capsys.readouterr()
    assert main(["film", "gas.nc", "-o", "gas.png"]) == 2
    assert "must end in .mp4, .gif" in capsys.readouterr().err
