"""`gaspart check`: validate a scene, a config, or a trajectory of any program."""

from __future__ import annotations

import argparse
from dataclasses import fields
from pathlib import Path

from gaspart.cli.arguments import (
    CheckFailed,
    Parser,
    config_command,
    print_line,
    print_lines,
    real,
    set_command,
    several,
)
from gaspart.cli.progress import waiting
from gaspart.errors import SceneError
from gaspart.errors.words import meant
from gaspart.scene.scene import Scene
from gaspart.yaml_text import read_yaml

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
