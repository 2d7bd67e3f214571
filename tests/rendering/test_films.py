import sys

import imageio.v3 as imageio
import numpy as np
import pytest

import gaspart as gp
from gaspart.cli import main
from gaspart.rendering import films
from gaspart.rendering.films import film, pieces, poster
from gaspart.rendering.frames import particles_of
from gaspart.rendering.particles import Labels, legend_of, round_length, time_format


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A folder with trajectories of five frames, of discs between walls and of spheres."""
    folder = tmp_path_factory.mktemp("films")
    discs = gp.Scene(
        gp.Container((12.0, 9.0)),
        [gp.Species(20, 0.5, temperature=1.0)],
        particles=[gp.Particle((6.0, 4.5), (0.0, 0.0), 1.5, 10.0)],
        walls=[gp.Wall((1.0, 1.0), (1.0, 3.0))],
    )
    spheres = gp.Scene(gp.Container((6.0,) * 3), [gp.Species(20, 0.5, temperature=1.0)])
    for name, scene in (("discs", discs), ("spheres", spheres)):
        gp.run(scene, gp.EventDriven("direct"), 1, 2.0, 0.5, folder / f"{name}.nc")
    return folder


@pytest.mark.thorough
@pytest.mark.parametrize("suffix", ["mp4", "gif"])
def test_a_film_has_a_picture_for_every_frame(runs, suffix):
    path = runs / f"discs.{suffix}"
    assert film(runs / "discs.nc", path, size=(121, 91), clock=False, trail=0) == path
    shape = (91, 121) if suffix == "gif" else (90, 120)
    images = imageio.imread(path, plugin="FFMPEG" if suffix == "mp4" else None)
    assert images.shape == (5, *shape, 3)
    assert (images[0] != images[-1]).any()
    assert not list(runs.glob("*.partial"))


def test_pictures_of_a_gif_are_written_when_they_are_drawn(tmp_path):
    path, sizes = tmp_path / "a.gif", []
    drawn = np.random.default_rng(1).integers(0, 256, (20, 40, 60, 3), dtype=np.uint8)
    drawn[5] = drawn[4]

    def pictures():
        for picture in drawn:
            yield picture
            sizes.append(path.stat().st_size)

    films._gif(path, pictures(), (60, 40), 25.0)
    assert sizes[10] > 8 * sizes[1] / 2 and sizes[-1] < path.stat().st_size + 1
    images = imageio.imread(path)
    assert images.shape == drawn.shape
    assert np.abs(images.astype(int) - drawn).mean() < 20.0  # 256 colours


@pytest.mark.interpreted
def test_a_film_of_a_part_has_its_frames(runs):
    with gp.open_trajectory(runs / "discs.nc") as data:
        times = data["time"].values
        part = gp.film(
            data, runs / "part.gif", size=(64, 48), clock=False, start=times[1], stop=times[4], every=2
        )
        chosen = gp.film(data.isel(frame=[1, 3]), runs / "chosen.gif", size=(64, 48), clock=False)
        with pytest.raises(gp.SceneError, match="start = 1000000000.0: must have a frame between it and"):
            gp.film(data, runs / "none.gif", start=1e9)
    assert part.read_bytes() == chosen.read_bytes()


@pytest.mark.interpreted
def test_what_a_signal_removes_is_not_made_again(runs, tmp_path, monkeypatch):
    """The thread of signals removes the scratch file while ffmpeg has not yet opened it."""
    pictures = films._pictures

    def removing(*arguments):
        for picture in pictures(*arguments):
            for scratch in tmp_path.glob(".gaspart-*.partial"):
                scratch.unlink()
            yield picture

    monkeypatch.setattr(films, "_pictures", removing)
    with pytest.raises(gp.SceneError, match="cannot be written"):
        film(runs / "discs.nc", tmp_path / "film.mp4", size=(120, 90), clock=False)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.interpreted
def test_the_poster_of_a_film_is_its_middle_picture(runs):
    path = runs / "shown.mp4"
    film(runs / "discs.nc", path, size=(120, 90), clock=False)
    poster(path, runs / "shown.jpg")
    still = imageio.imread(runs / "shown.jpg").astype(int)
    images = imageio.imread(path, plugin="FFMPEG").astype(int)
    assert still.shape == (90, 120, 3)
    assert np.argmin(np.abs(images - still).mean(axis=(1, 2, 3))) == 2


@pytest.mark.thorough
def test_a_film_of_spheres_is_made_of_their_pictures(runs):
    with gp.open_trajectory(runs / "spheres.nc") as trajectory:
        film(trajectory, runs / "spheres.gif", size=(64, 48), clock=False, colour="species")
        last = gp.render(trajectory, size=(64, 48), colour="species")
        first = gp.render(trajectory, 0, size=(64, 48), colour="species")
    images = imageio.imread(runs / "spheres.gif").astype(int)
    assert np.abs(images[-1] - last).mean() < 4.0 < np.abs(images[-1] - first).mean()


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param("discs", marks=pytest.mark.interpreted),
        pytest.param("spheres", marks=pytest.mark.thorough),  # rays take minutes as plain Python
    ],
)
def test_labels_are_above_and_below_the_picture_and_the_time_runs(runs, scene):
    timed, size = runs / f"{scene}-timed.gif", (240, 180)
    film(runs / f"{scene}.nc", timed, size=size, colour="species", clock=True)
    images = imageio.imread(timed).astype(int)
    with gp.open_trajectory(runs / f"{scene}.nc") as trajectory:
        shown = particles_of(trajectory, -1)
    labels = Labels(size, shown.parameters, legend_of(shown, "species"))
    width, height = labels.inner
    inside = slice(labels.top, labels.top + height)
    alone = gp.render(runs / f"{scene}.nc", size=(width, height), colour="species")
    assert np.abs(images[-1, inside] - alone).mean() < 4.0
    above, below = images[:, : labels.top], images[:, labels.top + height :]
    assert (above < 100).any(axis=(1, 2, 3)).all()
    assert (below[:, :, :80] < 100).any(axis=(1, 2, 3)).all() and (below[:, :, 160:] < 100).any()
    assert (below[0, :, :80] != below[4, :, :80]).any()
    assert shown.parameters[0] == {"discs": "21 discs", "spheres": "20 spheres"}[scene]
    assert (legend_of(shown, "species") is None) == (scene == "spheres")


@pytest.mark.interpreted
def test_the_colours_of_species_are_named_by_what_differs(runs):
    with gp.open_trajectory(runs / "discs.nc") as trajectory:
        legend = legend_of(particles_of(trajectory), "species")
    assert (legend.title, legend.texts) == ("radius, mass", ("0.5, 1", "1.5, 10"))
    scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(2, 0.5), gp.Species(2, 0.5)])
    legend = legend_of(particles_of(gp.Simulation(scene, gp.EventDriven())), "species")
    assert (legend.title, legend.texts) == ("species", ("0", "1"))


def test_parameters_are_in_lines_that_fit():
    texts = ("240 discs", "packing fraction 0.198", "gravity 1", "restitution 0.8")
    narrow, wide = Labels((200, 400), texts), Labels((640, 480), texts)
    assert len(narrow.lines) > len(wide.lines) == 1
    assert all(narrow.font.getlength(line) < 200 for line in narrow.lines)
    assert ", ".join(narrow.lines) == ", ".join(texts)
    assert Labels((200, 60), texts).lines == []
    with pytest.raises(gp.SceneError, match="too small for a clock"):
        Labels((200, 30), texts)


@pytest.mark.parametrize(
    ("times", "text"), [([0, 5], ".0f"), ([0, 0.25, 0.5], ".2f"), ([0, 1 / 3], ".4g"), ([1e-9], ".4g")]
)
def test_all_times_of_a_film_have_as_many_decimals(times, text):
    assert time_format(np.array(times)) == text


@pytest.mark.parametrize(("longest", "length"), [(37.0, 20.0), (0.7, 0.5), (1.0, 1.0), (9.99, 5.0)])
def test_the_bar_has_a_round_length(longest, length):
    assert round_length(longest) == length


@pytest.mark.interpreted
def test_walls_of_the_scene_are_drawn(runs):
    with gp.open_trajectory(runs / "discs.nc") as trajectory:
        image = gp.render(trajectory, size=(240, 180), colour=np.ones((21, 3)))
    dark = np.argwhere(image[5:-5, 10:-10].max(axis=-1) < 100)
    assert len(dark) and np.ptp(dark[:, 1]) <= 2 and 34 <= np.ptp(dark[:, 0]) <= 42


def test_a_trail_is_cut_where_a_periodic_face_is_crossed():
    way = [np.array(p) for p in ((8.0, 5.0), (9.5, 5.0), (0.5, 5.0), (1.0, 5.0), (1.0, 9.9))]
    lengths = np.array([10.0, 10.0])
    assert [len(piece) for piece in pieces(way[:4], lengths)] == [2, 2]
    assert [len(piece) for piece in pieces(way[:3], lengths)] == [2]
    assert pieces(way[:1], lengths) == []


@pytest.mark.interpreted
def test_the_command_line_makes_pictures_and_films(runs, capsys):
    source, size = str(runs / "discs.nc"), ["--size", "120x90"]
    assert main(["render", source, "-o", str(runs / "a.png"), "--frame", "2", *size]) == 0
    assert main(["render", source, "-o", str(runs / "b.png"), "--frame", "-3", *size]) == 0
    assert (runs / "a.png").read_bytes() == (runs / "b.png").read_bytes()
    other = ["--camera", "30,90", "--clock", *size]
    assert main(["render", str(runs / "spheres.nc"), "-o", str(runs / "c.png"), *other]) == 0
    wanted = gp.render(runs / "spheres.nc", size=(120, 90), camera=(30.0, 90.0), clock=True)
    assert (imageio.imread(runs / "c.png") == wanted).all()
    options = ["--colour", "species", "--frames-per-second", "10", "--trail", "0"]
    assert main(["render", source, "-o", str(runs / "a.gif"), *size, *options]) == 0
    assert capsys.readouterr().out.split() == [
        str(runs / name) for name in ("a.png", "b.png", "c.png", "a.gif")
    ]


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["discs.nc", "-o", "a.jpg"], "output = 'a.jpg': must end in .png, .mp4, .gif"),
        (["discs.nc", "-o", "new.png", "--frame", "5"], "frame = 5: must be one of 5 frames, counted from 0"),
        (["discs.nc", "-o", "new.gif", "--frame", "1"], "frame = 1: has no meaning for a film"),
        (
            ["discs.nc", "-o", "new.gif", "--trail", "21"],
            "trail = 21: must be below 21, the number of particles",
        ),
        (["spheres.nc", "-o", "new.gif", "--trail", "0"], "trail = 0: requires discs"),
        (["discs.nc", "-o", "new.png", "--size", "9"], "argument --size: '9' must be of the form 1000x750"),
        (["discs.nc", "-o", "new.png", "--colour", "red"], "colour = 'red': must be one of speed, species"),
        (["discs.nc", "-o", "none/a.png"], "path = 'none/a.png': cannot be written: No such file"),
        (
            ["discs.nc", "-o", "new.gif", "--frames-per-second", "1e-300"],
            "frames_per_second = 1e-300: must be from 0.01 to 1000",
        ),
    ],
)
def test_a_mistake_costs_one_line(runs, monkeypatch, capsys, options, complaint):
    monkeypatch.chdir(runs)
    before = sorted(runs.iterdir())
    assert main(["render", *options]) == 2
    output = capsys.readouterr().err
    assert complaint in output and output.count("\n") == 1
    assert sorted(runs.iterdir()) == before


@pytest.mark.interpreted
def test_a_film_as_mp4_names_the_package_that_is_missing(runs, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(gp.SceneError, match=r"films as .mp4 .* not installed: pip install 'gaspart\[film\]'"):
        film(runs / "discs.nc", runs / "new.mp4")
    film(runs / "discs.nc", runs / "without.gif", size=(40, 30), clock=False)
    assert not (runs / "new.mp4").exists() and (runs / "without.gif").exists()
