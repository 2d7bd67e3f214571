"""`gaspart measure` of several files, and along axes."""

import csv
import math

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.cli import main

GAS = gas(3, 64, 0.2, exact_temperature=True)


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    return [
        str(gp.run(GAS, gp.EventDriven(), seed, 40.0, 0.25, folder / f"{seed}.nc", displacements=True))
        for seed in (1, 2, 3)
    ]


def printed(capsys, *arguments):
    assert main(["measure", *arguments]) == 0
    return capsys.readouterr().out.splitlines()


def refused(capsys, *arguments):
    assert main(["measure", *arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        next(file)
        return list(csv.DictReader(file))


def test_several_files_are_replicas(paths, capsys):
    z, d = printed(capsys, *paths, "Z", "D")
    found = gp.analysis.replicas("Z", paths)
    assert z.startswith(f"Z = {float(found.estimate):.6g} +- {float(found.error):.1g}, theory ")
    assert d.startswith(f"D = {float(gp.analysis.replicas('D', paths).estimate):.6g} +- ")


def test_the_values_of_replicas_are_written(paths, capsys, tmp_path):
    found = gp.analysis.replicas("Z", paths)
    printed(capsys, *paths, "Z", "-o", str(tmp_path / "z.csv"))
    table = rows(tmp_path / "z.csv")
    assert [float(row["stretches"]) for row in table] == found[
        "compressibility_factor_replicas"
    ].values.tolist()
    assert {float(row["compressibility_factor"]) for row in table} == {float(found.estimate)}
    printed(capsys, *paths, "rdf", "-o", str(tmp_path / "rdf.csv"))
    table, found = rows(tmp_path / "rdf.csv"), gp.analysis.replicas("rdf", paths)
    assert len(table) == found.sizes["distance"]
    for n in range(3):
        column = [float(row[f"rdf_replicas_{n + 1}"] or math.nan) for row in table]
        assert np.array_equal(column, found["rdf_replicas"][n], equal_nan=True)
    printed(capsys, *paths, "Z", "-o", str(tmp_path / "z.png"))
    assert (tmp_path / "z.png").read_bytes().startswith(b"\x89PNG")


def test_files_of_different_scenes_are_refused_with_the_first_difference(paths, capsys, tmp_path):
    other = gp.run(gas(3, 64, 0.1), gp.EventDriven(), 9, 20.0, 0.25, tmp_path / "other.nc")
    line = refused(capsys, paths[0], str(other), "Z")
    assert line.startswith(f"gaspart: error: {other}: scene.container.lengths[0] = 6.9")
    assert f" in {paths[0]}: replicas differ in nothing but seed and first state" in line
    line = refused(capsys, *paths, paths[1], "Z")
    assert (
        f"{paths[1]}: seed = '2': and the first state give the same run, bit for bit, as {paths[1]}" in line
    )


def test_words_are_sorted_into_files_and_names(paths, capsys):
    assert "NAME is missing after the files" in refused(capsys, *paths)
    assert "files stand before the names" in refused(capsys, paths[0], "Z", paths[1])
    assert "'mds': unknown name; did you mean msd?" in refused(capsys, *paths, "mds")
    assert "missing.nc" in refused(capsys, paths[0], "missing.nc", "Z")


def test_displacement_and_diffusion_along_each_axis(paths, capsys, tmp_path):
    head, *lines = printed(capsys, paths[0], "msd", "--per-axis")
    of_axis = "msd {} error theory its error"
    assert head.split() == ["lag", *" ".join(map(of_axis.format, "xyz")).split()]
    found = gp.analysis.mean_squared_displacement(paths[0], per_axis=True)
    assert float(lines[1].split()[5]) == pytest.approx(
        float(found.estimate.sel(axis="y").sel(lag=float(lines[1].split()[0]), method="nearest")), rel=1e-4
    )
    assert lines[-2] == f"(theory: {found.attrs['source']})"
    head, *lines = printed(capsys, paths[0], "D", "--per-axis")
    assert head.split() == ["axis", "D", "error", "theory", "its", "error"]
    assert [line.split()[0] for line in lines[:3]] == ["x", "y", "z"]
    known = gp.measure(paths[0], "D", per_axis=True)
    unsure = float(known["diffusion_coefficient_theory_error"][0])
    assert float(lines[0].split()[4]) == pytest.approx(unsure, rel=1e-4) and unsure > 0.0
    assert lines[3] == f"(theory: {known.attrs['source']})"
    assert lines[4].startswith("(by the slope between the lags ") and len(lines) == 5
    printed(capsys, *paths, "msd", "--per-axis", "-o", str(tmp_path / "msd.csv"))
    table = rows(tmp_path / "msd.csv")
    assert {row["axis"] for row in table} == {
        "x",
        "y",
        "z",
    } and "mean_squared_displacement_replicas_3" in table[0]
    printed(capsys, *paths, "msd", "--per-axis", "-o", str(tmp_path / "msd.png"))


def test_a_profile_along_an_axis(paths, capsys):
    lines = {axis: printed(capsys, paths[0], "density", "--axis", axis) for axis in "xyz"}
    assert lines["z"] == printed(capsys, paths[0], "density")
    assert lines["x"] != lines["z"]


def test_what_an_observable_cannot_be_is_refused(paths, capsys):
    assert "per_axis = True: cannot be chosen for Z, only for msd, D" in refused(
        capsys, paths[0], "Z", "--per-axis"
    )
    assert "axis = 'x': cannot be chosen for msd" in refused(capsys, paths[0], "msd", "--axis", "x")
    assert "--axis: 'w': unknown name" in refused(capsys, paths[0], "density", "--axis", "w")
    flat = gp.run(gas(2, 64, 0.2), gp.EventDriven(), 1, 20.0, 0.25, f"{paths[0]}.flat.nc")
    assert "axis = 'z'" in refused(capsys, str(flat), "density", "--axis", "z")


def test_theory_numbers_species_from_0_as_measurements_do(capsys):
    main(["theory", "contact_value", "--eta", "0.3", "--diameters", "1,0.5"])
    first = capsys.readouterr().out.splitlines()[0]
    values = gp.theory.mixture_contact_values(0.3, 3, [1.0, 0.5], theory="boublik")
    assert f"0-0 {values[0, 0]:.8g}, 0-1 {values[0, 1]:.8g}, 1-0 " in first
