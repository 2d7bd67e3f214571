"""`gaspart info` and `gaspart check`: what a file has, and if it is valid."""

from __future__ import annotations

import argparse
import shlex
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.cli.arguments import (
    CheckFailed,
    Parser,
    add_trajectory,
    config_command,
    print_line,
    print_lines,
    real,
    set_command,
    several,
)
from gaspart.cli.progress import waiting
from gaspart.errors import SceneError, meant
from gaspart.scene.scene import Scene
from gaspart.yaml_text import read_yaml

if TYPE_CHECKING:
    from gaspart.trajectory.recipe import Recipe

_SCENE = [field.name for field in fields(Scene)]
_EXAMPLES = """examples:
  gaspart check scene.yaml                   # validity, placement
  gaspart check config/paper.yaml            # every point of every grid
  gaspart check run.nc                       # of gaspart, AMBER or LAMMPS
  gaspart check dump.gsd --time-step 0.005   # of HOOMD, which counts steps
  gaspart check frames.xyz --radius 0.5 --lengths 10,10,10

exit code: 0 if all checks pass, 1 if one fails, 2 if the file cannot be read"""


def add_check(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "Validate a scene, a config, or a trajectory of any program (AMBER or LAMMPS netCDF, GSD, XYZ): "
        "overlaps, the container, the speed distribution, g(sigma) and Z, and D, with a line for each."
    )
    set_command(parser, _check, text, _EXAMPLES)
    add = parser.add_argument
    add("file", metavar="FILE", help=".yaml, .nc, .gsd or .xyz")
    add("--radius", type=real(above=0.0), metavar="R", help="radius of all particles, if the file has none")
    add(
        "--lengths",
        type=several(real(above=0.0)),
        metavar="X,Y[,Z]",
        help="sides of the container, if the file has none",
    )
    text = "periodic or wall, of all axes or one for each, as periodic,periodic,wall; default: as in the file"
    add("--boundary", type=_words, metavar="NAME[,...]", help=text)
    text = "lower corner of the container, or the word centre if its middle is at 0, as --origin=-5,-5,-5"
    add("--origin", type=_corner, metavar="X,Y[,Z]", help=text)
    text = "time of a step (GSD) or between frames (netCDF, XYZ)"
    add("--time-step", type=real(above=0.0), metavar="T", help=text)
    text = (
        "a force, a thermostat or inelastic contacts may change the energy of a trajectory of another program"
    )
    add("--driven", action="store_true", default=None, help=text)
    add("--tolerance", type=real(least=0.0), metavar="X", help="allowed overlap, as a fraction of a diameter")


def _words(text: str) -> str | tuple[str, ...]:
    """Return a word, or several words separated by commas. `Container` rejects invalid words."""
    words = tuple(text.split(","))
    return words[0] if len(words) == 1 else words


def _corner(text: str) -> str | tuple[float, ...]:
    """Return a word, or numbers separated by commas."""
    return text if text.isalpha() else tuple(several(real())(text))


def _check(options: argparse.Namespace) -> None:
    from gaspart.trajectory.replicas import run_files

    healthy = [_is_healthy(options, file) for file in run_files(options.file)]
    if not all(healthy):
        raise CheckFailed


def _is_healthy(options: argparse.Namespace, file: str) -> bool:
    """Print the checks of a file; return False if a check fails."""
    if Path(file).suffix in (".yaml", ".yml"):
        for key in ("radius", "lengths", "boundary", "origin", "time_step", "driven"):
            if getattr(options, key) is not None:
                raise SceneError(key, getattr(options, key), "has a meaning for trajectories only")
        checks, scales = _written(file, options.tolerance)
    else:
        with waiting(f"checking {file}"):
            title, checks = _check_frames(file, options)
        print_line(title)
        scales = []
    for check in checks:
        print_line(check)
    print_lines(scales)
    return all(check.passed is not False for check in checks)


def _check_frames(file: str, options: argparse.Namespace) -> tuple[str, list]:
    """Check a trajectory. Returns a line about its particles, and the list of checks."""
    from gaspart.inspection.checks import judge, judge_open
    from gaspart.inspection.readers import is_open_run, read_frames

    stated = {key: getattr(options, key) for key in ("radius", "lengths", "boundary", "time_step", "origin")}
    if is_open_run(file):
        for key, value in stated.items():
            if value is not None:
                raise SceneError(key, value, "has no meaning for a run of gaspart with open faces")
        return judge_open(Path(file), options.tolerance)
    frames = read_frames(file, **stated)
    kind = "discs" if frames.dimension == 2 else "spheres"
    note = f"; {frames.note}" if frames.note else ""
    title = f"{file}: {frames.count} {kind} in {len(frames.positions)} frames{note}"
    return title, judge(frames, options.tolerance, bool(options.driven))


def _written(file: str, tolerance: float | None) -> tuple[list, list[str]]:
    """Check a YAML file: a scene (with its scales) or a config."""
    from gaspart.accuracy.scales import scales
    from gaspart.inspection.checks import judge_scene

    content, path = read_yaml(file), Path(file)
    if isinstance(content, dict) and content and not any(meant(str(key), _SCENE) for key in content):
        return config_command("check")(path), []
    return judge_scene(path, tolerance), scales(Scene.from_file(path)).lines


_EXAMPLES_OF_INFO = """examples:
  gaspart info run.nc
  gaspart info run.nc --scene > scene.yaml   # to run it again"""


def add_info(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = "Contents and quality of a trajectory, and the command that reproduces it."
    set_command(parser, _info, text, _EXAMPLES_OF_INFO)
    add_trajectory(parser)
    parser.add_argument("--scene", action="store_true", help="print the scene file and nothing else")


def _info(options: argparse.Namespace) -> None:
    from gaspart.accuracy.scales import scales
    from gaspart.cli.export import conventions
    from gaspart.cli.options import run_options
    from gaspart.inspection.energy import certificate
    from gaspart.trajectory.opening import PARTIAL, check_frames, open_netcdf_file, partial_path
    from gaspart.trajectory.recipe import read_recipe
    from gaspart.trajectory.replicas import run_files

    path = Path(run_files(options.trajectory)[0])
    stored_at = path if path.exists() or not partial_path(path).exists() else partial_path(path)
    recipe = read_recipe(stored_at)
    with open_netcdf_file(stored_at) as file:
        stored, frames = file.__dict__, len(file.dimensions["frame"])
    if options.scene:
        print_lines(_lines_of(stored["scene"]))
        return
    check_frames(stored_at)
    scene = recipe.scene
    complete = frames == recipe.frames if recipe.until is None else stored_at.suffix != PARTIAL
    state = "complete" if complete else _unfinished_state(stored_at, recipe)
    replica = "" if recipe.replica is None else ", replica {} of {}".format(*recipe.replica)
    of_all = f"{frames} frames" if recipe.until else f"{frames} of {recipe.frames} frames"
    versions = [f"{key.removesuffix('_version')} {stored[key]}" for key in stored if key.endswith("_version")]
    remake = [
        f"gaspart info --scene {shlex.quote(str(stored_at))} > scene.yaml",
        "gaspart run scene.yaml " + shlex.join(run_options(path, recipe)),
    ]
    print_line(f"{stored_at}: {stored['title']}{replica}, {of_all}, {state}")
    for line in _request(recipe, stored_at, frames):
        print_line(line)
    begun = "at the start: " if scene.is_open else ""
    density = f"packing fraction {scene.packing_fraction:.6g}, number density {scene.number_density:.6g}"
    print_line(f"{begun}{density}")
    print_lines(f"{begun}{line}" for line in scales(scene).lines)
    print_lines(certificate(stored_at))
    print_lines(_measurable(recipe))
    print_lines(filter(None, [conventions(scene, ".nc")]))
    for key, value in recipe.engine.predictions(scene).items():
        print_line(f"predicted {key.replace('_', ' ')}: {100.0 * value:+.2g} % (by its cells and steps)")
    print_line(f"checksums: the header and {'all frames' if frames else 'no frames yet'} are undamaged")
    print_line(f"written by {', '.join(versions)}; revision {stored.get('git_revision', 'none')}")
    print_line("reproduced, to the same bits, by")
    print_lines(f"    {line}" for line in remake)
    if recipe.initial is not None:
        print_line(
            "where OTHER.nc is the file whose last state this run was started from; this file holds it"
        )
    print_line("scene:")
    print_lines(f"    {line}" for line in _lines_of(stored["scene"]))


def _unfinished_state(path: Path, recipe: Recipe) -> str:
    """Describe how an interrupted run can be continued."""
    from gaspart.trajectory.recipe import begun_as

    if begun_as(path, recipe):
        return "unfinished: `gaspart resume` continues it"
    return "unfinished, and begun by another version: start it anew, as below"


def _lines_of(scene: str) -> list[str]:
    """Return the lines of a scene, as in its file."""
    return scene.rstrip("\n").split("\n")


def _measurable(recipe: Recipe) -> list[str]:
    """Describe the observables of a run, and observables that require another run. An observable can be
    measured if it is defined for the scene, and if the run has stored its data.
    """
    from gaspart.analysis.observables import OBSERVABLES, require_defined, require_kept

    measured, others = [], []
    for name, observable in OBSERVABLES.items():
        try:
            require_defined(name, recipe.scene)
        except SceneError:
            continue
        try:
            require_kept(name, recipe.kept)
            measured.append(name)
        except SceneError:
            others.append(f"{name} ({observable.needs})")
    lines = [f"observables: {', '.join(measured) or 'none'}"]
    return lines + ([f"of another run of this scene: {', '.join(others)}"] if others else [])


def _request(recipe: Recipe, path: Path, frames: int) -> list[str]:
    """Describe the accuracies at which a run ends, and the accuracies that it has reached."""
    from gaspart.cli.options import accuracy_lines

    if recipe.until is None:
        return []
    targets = ", ".join(f"{accuracy.name}={accuracy.accuracy:g}" for accuracy in recipe.until.accuracies)
    longest = f", at most until time {recipe.until.at_most:g}" if recipe.until.at_most else ""
    request = f"runs until {targets} (relative standard errors){longest}"
    try:
        return [request, *(accuracy_lines(path) if frames else [])]
    except SceneError as error:
        if recipe.replica is None:
            raise
        return [request, f"what all replicas have reached is not known: {error}"]
