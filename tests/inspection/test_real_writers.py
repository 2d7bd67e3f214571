"""Forms in which real programs write right files: none of their lines is WRONG, and what is unknown is "-".

One gas, whose frames are known to be right, is written in each form by script: velocities in the first frame
only, or copied into all; steps never set; a centred origin; names of restart files and in capital letters;
the variables of OVITO; rows in any order, with ids and without.
"""

import tracemalloc

import netCDF4
import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.inspection import readers
from gaspart.inspection.checks import judge, judge_places
from gaspart.inspection.frames import Frames
from gaspart.inspection.readers import COPIES, read_frames

SIDE, COUNT, INTERVAL, RADIUS = 8.0, 150, 0.1, 0.5
DOUBTED = "energy", "momentum", "flights", "speed law", "kurtosis of speeds", "diffusion coefficient D"


@pytest.fixture(scope="module")
def right(tmp_path_factory):
    """Positions and velocities (T, N, 3) of a periodic gas of spheres, from one of our own files."""
    path = tmp_path_factory.mktemp("right") / "g.nc"
    box = gp.Container(lengths=(SIDE,) * 3, boundary="periodic")
    scene = gp.Scene(container=box, species=[gp.Species(count=COUNT, radius=RADIUS, temperature=1.0)])
    gp.run(scene, gp.EventDriven(), seed=1, duration=30 * INTERVAL, sample_interval=INTERVAL, path=path)
    with gp.open_trajectory(path) as data:
        return data.coordinates.values.astype(float), data.velocities.values.astype(float)


def lines(path, **options):
    """The lines of `gaspart check`, by the names of the checks."""
    return {check.name: check for check in judge(read_frames(path, **options))}


def without_wrong(found):
    assert [str(check) for check in found.values() if check.passed is False] == []
    return found


def gsd_file(path, positions, velocities, stored=None, steps=100, lengths=None, dimensions=3):
    """A GSD file with velocities in the frames `stored`, by default all."""
    hoomd = pytest.importorskip("gsd.hoomd")
    with hoomd.open(str(path), "w") as file:
        for n, places in enumerate(positions):
            frame = hoomd.Frame()
            frame.configuration.step = steps * n
            frame.configuration.box = [*(lengths or (SIDE,) * 3), 0, 0, 0]
            frame.configuration.dimensions = dimensions
            frame.particles.N = len(places)
            frame.particles.position = places
            if stored is None or n in stored:
                frame.particles.velocity = velocities[n]
            file.append(frame)
    return path


def xyz_file(path, positions, velocities=None, comment="", stored=None):
    """An extended XYZ file with velocities in the frames `stored`, by default all."""
    text = []
    for n, places in enumerate(positions):
        moving = velocities is not None and (stored is None or n in stored)
        rows = np.column_stack([places, velocities[n]]) if moving else places
        d = places.shape[1]
        names = f"pos:R:{d}" + (f":velo:R:{d}" if moving else "")
        text += [str(len(places)), f"Properties={names} Time={INTERVAL * n:.6f} {comment}"]
        text += [" ".join(f"{x:.9g}" for x in row) for row in rows]
    path.write_text("\n".join(text) + "\n")
    return path


def netcdf_file(path, variables, **attributes):
    """A netCDF file of AMBER's convention. variables: name to values (frame, ...), or (values, axes)."""
    with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_DATA") as file:
        file.setncatts({"Conventions": "AMBER", "ConventionVersion": "1.0", **attributes})
        for name, size in (("frame", None), ("spatial", 3), ("cell_spatial", 3), ("atom", COUNT)):
            file.createDimension(name, size)
        for name, values in variables.items():
            values = np.asarray(values)
            vector = {1: (), 2: ("atom",), 3: ("atom", "spatial")}[values.ndim]
            axes = ("cell_spatial",) if name.startswith("cell") else vector
            kind = "i8" if values.dtype.kind == "i" else "f8"
            file.createVariable(name, kind, ("frame", *axes))[:] = values
    return path


CUBE = f'Lattice="{SIDE} 0 0 0 {SIDE} 0 0 0 {SIDE}"'


def test_velocities_of_the_first_frame_only(tmp_path, right):
    places, velocities = right
    path = gsd_file(tmp_path / "a.gsd", places - 4, velocities, stored=(0,))
    for time_step in (None, 1e-3):
        found = without_wrong(lines(path, radius=RADIUS, time_step=time_step))
        for name in DOUBTED:
            assert found[name].passed is None
            assert "in frame 0 only" in found[name].text and "'momentum'" in found[name].text
    found = without_wrong(lines(xyz_file(tmp_path / "a.xyz", places, velocities, CUBE, (0,)), radius=RADIUS))
    assert "in 1 of 31 frames only" in found["energy"].text and found["energy"].passed is None
    path = netcdf_file(tmp_path / "a.nc", {"coordinates": places, "cell_lengths": np.full((31, 3), SIDE)})
    with netCDF4.Dataset(path, "a") as file:
        file.createVariable("velocities", "f8", ("frame", "atom", "spatial"))[:1] = velocities[:1]
    found = without_wrong(lines(path, radius=RADIUS))
    assert found["energy"].text == "velocities are stored in 1 of 31 frames only"


@pytest.mark.parametrize("time_step", [None, INTERVAL])
def test_velocities_that_were_copied_into_all_frames(tmp_path, right, time_step):
    places, velocities = right
    copied = np.broadcast_to(velocities[0], velocities.shape)
    path = xyz_file(tmp_path / "a.xyz", places, copied, CUBE)
    if time_step is None:
        path.write_text(path.read_text().replace("Time=", "Elapsed="))
    found = without_wrong(lines(path, radius=RADIUS, time_step=time_step))
    assert all(found[name].passed is None and "copies" in found[name].text for name in DOUBTED)


@pytest.mark.parametrize("timed", [True, False])
def test_an_ideal_gas_has_the_same_velocities_in_all_frames(tmp_path, timed):
    rng = np.random.default_rng(1)
    velocities = np.broadcast_to(rng.standard_normal((COUNT, 3)), (31, COUNT, 3))
    places = (SIDE * rng.random((COUNT, 3)) + velocities * INTERVAL * np.arange(31)[:, None, None]) % SIDE
    path = xyz_file(tmp_path / "a.xyz", places, velocities, CUBE)
    if not timed:
        path.write_text(path.read_text().replace("Time=", "Elapsed="))
    found = without_wrong(lines(path, radius=1e-9))
    assert found["energy"].passed and found["flights"].passed is (True if timed else None)
    # HOOMD's default does not store them again; positions show that they still hold
    path = gsd_file(tmp_path / "a.gsd", places - 4, velocities, stored=(0,))
    found = without_wrong(lines(path, radius=1e-9, time_step=1e-3))
    assert found["flights"].passed


def test_steps_that_were_never_set(tmp_path, right):
    places, velocities = right
    path = gsd_file(tmp_path / "a.gsd", places - 4, velocities, steps=0)
    found = without_wrong(lines(path, radius=RADIUS, time_step=INTERVAL))
    assert found["flights"].passed and " flights without a collision" in found["flights"].text
    assert "--time-step" in lines(path, radius=RADIUS)["flights"].text


def test_centred_positions_between_walls(tmp_path):
    path = tmp_path / "w.nc"
    gp.run(gas(3, 60, 0.1, "wall"), gp.EventDriven(), 1, 2.0, INTERVAL, path)
    with gp.open_trajectory(path) as data:
        places, velocities = data.coordinates.values.astype(float), data.velocities.values
        sides, radius = data.cell_lengths.values[0], float(data.radius[0])
    cell = " ".join(f"{x!r}" for x in np.diag(sides).ravel().tolist())
    file = xyz_file(tmp_path / "a.xyz", places - 0.5 * sides, velocities, f'Lattice="{cell}" pbc="F F F"')
    wrong = lines(file, radius=radius)["container"]
    assert wrong.passed is False and "give --origin centre" in wrong.text
    for origin in ("centre", tuple(-0.5 * sides)):
        found = without_wrong(lines(file, radius=radius, origin=origin))
        assert found["container"].passed and found["flights"].passed
    with pytest.raises(gp.SceneError, match="must be 3 numbers, or the word centre"):
        lines(file, radius=radius, origin=(0.0, 0.0))
    assert "--origin" not in lines(file, radius=radius, boundary="periodic")["container"].text


def granular(rng, places, n):
    """Heavy-tailed velocities that cool."""
    return 0.8**n * rng.laplace(size=places.shape)


def thermostat(rng, places, n):
    """Independent velocities of one temperature, of a uniform law."""
    return rng.uniform(-1.0, 1.0, places.shape)


def active(rng, places, n):
    """Velocities of one speed in a direction that turns."""
    vectors = rng.standard_normal(places.shape)
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


@pytest.mark.parametrize("law", [granular, thermostat, active])
def test_what_is_driven_is_no_equilibrium(tmp_path, law):
    rng = np.random.default_rng(1)
    places, frames, velocities = rng.uniform(0, 40, (1000, 3)), [], []
    for n in range(30):
        velocities.append(law(rng, places, n))
        frames.append(places % 40)
        places = places + velocities[-1]
    path = xyz_file(tmp_path / "a.xyz", frames, velocities, 'Lattice="40 0 0 0 40 0 0 0 40"')
    frames = read_frames(path, radius=1e-4, time_step=1.0)
    energy = next(check for check in judge(frames) if check.name == "energy")
    assert energy.passed is {granular: False, thermostat: None, active: True}[law]
    assert ("falls in nearly every frame" in energy.text) == (law is granular)
    found = without_wrong({check.name: check for check in judge(frames, driven=True)})
    for name in ("speed law", "kurtosis of speeds", "pressure Z", "diffusion coefficient D"):
        assert found[name].passed is None and "something acts on the particles (see" in found[name].text


@pytest.mark.parametrize("suffix", [".nc", ".NC", ".ncdf", ".ncrst", ".rst7", ".rst"])
def test_names_of_netcdf_files(tmp_path, right, suffix):
    places, velocities = right
    content = {"coordinates": places[:1], "velocities": velocities[:1], "cell_lengths": np.full((1, 3), SIDE)}
    path = netcdf_file(tmp_path / f"a{suffix}", content, Conventions="AMBERRESTART")
    found = without_wrong(lines(path, radius=RADIUS))
    assert found["overlaps"].passed and found["energy"].text == "needs two frames"


def test_capital_letters(tmp_path, right):
    places, velocities = right
    path = xyz_file(tmp_path / "A.XYZ", places, velocities, CUBE)
    path.write_text(
        path.read_text().replace("pos:R", "POS:R").replace("velo:", "Velo:").replace("Lattice", "LATTICE")
    )
    assert without_wrong(lines(path, radius=RADIUS))["flights"].passed
    path = gsd_file(tmp_path / "A.GSD", places - 4, velocities)
    assert without_wrong(lines(path, radius=RADIUS, time_step=1e-3))["flights"].passed


def shuffled(places, velocities):
    """The same with rows in another order in each frame, and the ids of the rows."""
    rng = np.random.default_rng(3)
    order = np.stack([rng.permutation(COUNT) for _ in places])
    pick = [np.take_along_axis(values, order[:, :, None], axis=1) for values in (places, velocities)]
    return *pick, order + 1


def ovito(path, right, **variables):
    """The form of OVITO 3.17: capital names, frames numbered in `time`, cells with an origin."""
    places, velocities, ids = shuffled(*right)
    frames = len(places)
    content = {
        "time": np.arange(float(frames)),
        "cell_origin": np.zeros((frames, 3)),
        "cell_lengths": np.full((frames, 3), SIDE),
        "cell_angles": np.full((frames, 3), 90.0),
        "Timestep": 40 * np.arange(frames),
        "coordinates": places,
        "velocities": velocities,
        "Radius": np.full((frames, COUNT), RADIUS),
        "Mass": np.full((frames, COUNT), 1.0),
        "identifier": ids,
        "Time": INTERVAL * np.arange(frames),
    }
    content = {name: values for name, values in {**content, **variables}.items() if values is not None}
    return netcdf_file(path, content, program="OVITO")


def test_ids_radii_and_times_of_ovito(tmp_path, right):
    plain = xyz_file(tmp_path / "a.xyz", *right, CUBE)
    expected = without_wrong(lines(plain, radius=RADIUS))
    found = lines(ovito(tmp_path / "a.nc", right))
    assert found["flights"].passed and int(found["flights"].text.split(" in ")[1].split()[0]) > 1000
    for name in ("speed law", "kurtosis of speeds", "pressure Z", "diffusion coefficient D"):
        assert str(found[name]) == str(expected[name])
    unknown = without_wrong(lines(ovito(tmp_path / "b.nc", right, Time=None)))
    assert "--time-step" in unknown["flights"].text
    given = lines(ovito(tmp_path / "b.nc", right, Time=None), time_step=INTERVAL)
    assert str(given["flights"]) == str(found["flights"])


@pytest.mark.parametrize("timed", [True, False])
def test_rows_in_any_order_without_ids(tmp_path, right, timed):
    times = {} if timed else {"Time": None}
    found = without_wrong(lines(ovito(tmp_path / "a.nc", right, identifier=None, **times)))
    assert found["energy"].passed and found["momentum"].passed and found["overlaps"].passed
    for name in ("flights", "speed law", "kurtosis of speeds", "pressure Z", "diffusion coefficient D"):
        assert found[name].passed is None and "another order in frame 1" in found[name].text


def test_rows_in_any_order_of_particles_that_all_change_their_velocities(tmp_path):
    rng = np.random.default_rng(4)
    velocity, fall = rng.standard_normal((COUNT, 3)), np.array([0.0, 0.0, -1.0])
    places, velocities = [], []
    start = SIDE * rng.random((COUNT, 3))
    for n in range(10):
        time = 0.01 * n
        places.append((start + velocity * time + 0.5 * fall * time**2) % SIDE)
        velocities.append(velocity + fall * time)
    ordered = np.array(places), np.array(velocities)
    for found, frames in ((None, ordered), (1, shuffled(*ordered)[:2])):
        path = xyz_file(tmp_path / "a.xyz", *frames, CUBE)
        assert read_frames(path, radius=1e-9, time_step=0.01).reordered == found


def test_sizes_of_rows_in_any_order_say_nothing(tmp_path, right):
    radii = np.where(np.arange(COUNT) % 2, 0.5, 0.4)
    places, velocities, _ = shuffled(*right)
    path = netcdf_file(
        tmp_path / "a.nc",
        {"coordinates": places, "velocities": velocities, "cell_lengths": np.full((31, 3), SIDE)},
    )
    with netCDF4.Dataset(path, "a") as file:
        file.createVariable("radius", "f8", ("atom",))[:] = radii
    assert "another order" in without_wrong(lines(path))["overlaps"].text


@pytest.mark.parametrize(("height", "dimensions"), [(0.0, 2), (0.0, 3), (1.0, 2), (1.0, 3)])
def test_discs_of_gsd(tmp_path, height, dimensions):
    run = gp.run(gas(2, 100, 0.2), gp.EventDriven(), 1, 3.0, INTERVAL, tmp_path / "d.nc")
    with gp.open_trajectory(run) as data:
        sides, radius = data.cell_lengths.values[0, :2], float(data.radius[0])
        places, velocities = (
            np.pad(data[name].values, [(0, 0), (0, 0), (0, 1)]) for name in ("coordinates", "velocities")
        )
    places[..., :2] -= 0.5 * sides
    path = gsd_file(tmp_path / "a.gsd", places, velocities, lengths=(*sides, height), dimensions=dimensions)
    assert read_frames(path, radius=radius).dimension == 2
    found = without_wrong(lines(path, radius=radius, time_step=1e-3))
    assert found["overlaps"].passed and found["flights"].passed
    places[3, 5] = places[3, 6] + [0.4 * radius, 0.0, 0.0]
    path = gsd_file(tmp_path / "b.gsd", places, velocities, lengths=(*sides, height), dimensions=dimensions)
    assert lines(path, radius=radius)["overlaps"].passed is False


def test_a_box_of_gsd_without_a_side_is_no_wall(tmp_path, right):
    places, velocities = right
    path = gsd_file(tmp_path / "a.gsd", places - 4, velocities, lengths=(0.0, SIDE, SIDE))
    with pytest.raises(gp.SceneError, match="must be positive: give --lengths"):
        read_frames(path, radius=RADIUS)
    assert without_wrong(lines(path, radius=RADIUS, lengths=(SIDE,) * 3, time_step=1e-3))["flights"].passed


@pytest.mark.parametrize(
    ("comment", "options"),
    [
        ('pbc="F F"', {"lengths": (8.0, 8.0)}),
        ('pbc="maybe"', {"lengths": (8.0, 8.0), "boundary": "wall"}),
        ('Lattice="8 0 0 8" pbc="F F"', {}),
        ('Lattice="8 0 0 8" pbc="T T"', {"boundary": "wall"}),
        ('Lattice="8 8" pbc="F F F"', {"lengths": (8.0, 8.0)}),
        ('Lattice="8 8 8" Origin="middle"', {"boundary": "wall", "origin": (0.0, 0.0)}),
        ('Lattice="9 9 9" Origin="2 2 2"', {"lengths": (8.0, 8.0), "boundary": "wall", "origin": (0.0, 0.0)}),
    ],
)
def test_options_come_before_what_an_xyz_file_states(tmp_path, comment, options):
    path = xyz_file(tmp_path / "a.xyz", [np.array([[1.0, 1.0], [6.0, 6.0]])], comment=comment)
    frames = read_frames(path, radius=0.5, **options)
    assert frames.dimension == 2 and tuple(frames.lengths) == (8.0, 8.0) and not any(frames.periodic)
    assert frames.positions[0].tolist() == [[1.0, 1.0], [6.0, 6.0]]


def test_no_number_of_collisions_is_negative(tmp_path, right):
    places, velocities = right
    path = xyz_file(tmp_path / "a.xyz", places[:2], velocities[[0, 0]] + [[[0.0]], [[1e-9]]], CUBE)
    assert "-0" not in lines(path, radius=RADIUS)["speed law"].text


def test_memory_is_known_before_a_file_is_read(tmp_path, right, monkeypatch):
    places, velocities = np.concatenate([right[0]] * 4), np.concatenate([right[1]] * 4)
    files = [
        xyz_file(tmp_path / "a.xyz", places, velocities, CUBE),
        gsd_file(tmp_path / "a.gsd", places - 4, velocities),
    ]
    for path in files:
        tracemalloc.start()
        read_frames(path, radius=RADIUS)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        size = path.stat().st_size
        assert peak < 1.5 * COPIES * size  # some of it for a first import
        monkeypatch.setattr(readers, "memory", lambda size=size: (COPIES - 1) * size)
        with pytest.raises(gp.SceneError, match="GB of memory for all frames"):
            read_frames(path, radius=RADIUS)
        monkeypatch.undo()


def test_ovito_leaves_out_a_corner_at_zero(tmp_path):
    """A container whose lower side is a piston, at 0 in the first frame."""
    path, text = tmp_path / "piston.xyz", ""
    for low in (0.0, 0.25):
        corner = f'Origin="{low} 0.0 0.0" ' if low else ""
        text += (
            f'1\nLattice="{8.0 - low} 0 0 0 8 0 0 0 8" {corner}pbc="F T T" Properties=species:S:1:pos:R:3\n'
        )
        text += "A 7.3 1.0 1.0\n"
    path.write_text(text)
    frames = read_frames(path, radius=0.5)
    assert frames.at(1).lengths[0] == 7.75
    assert [float(frames.at(n).positions[0, 0, 0]) for n in (0, 1)] == pytest.approx([7.3, 7.05])


def test_a_step_may_leave_overlaps_as_deep_as_the_way_of_two_particles_in_it():
    """A pair that a step has pushed together separates in the next ones (`overlaps_left` counts those that
    approach)."""
    velocities = np.array([[[-1.0, 0.0], [1.0, 0.0]]])
    for depth, passed in ((0.03, True), (0.05, False)):
        places = np.array([[[3.0, 3.0], [4.0 - depth, 3.0]]])
        about = {"lengths": np.full(2, 9.0), "radii": np.full(2, 0.5), "periodic": (True, True)}
        frames = Frames(places, **about, velocities=velocities, engine=gp.TimeStepped(0.02))
        assert judge_places(frames)[0].passed is passed
        assert judge_places(Frames(places, **about, velocities=velocities))[0].passed is False
