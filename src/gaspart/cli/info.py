"""`gaspart info`: contents of a trajectory, and the command that reproduces it."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.cli.arguments import Parser, add_trajectory, print_line, print_lines, set_command
from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.trajectory.recipe import Recipe

_EXAMPLES = """examples:
  gaspart info run.nc
  gaspart info run.nc --scene > scene.yaml   # to run it again"""


def add_info(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = "Contents and quality of a trajectory, and the command that reproduces it."
    set_command(parser, _info, text, _EXAMPLES)
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
