"""`gaspart run` and `gaspart resume`: write a trajectory."""

from __future__ import annotations

import argparse
import math
import shlex
import sys
from collections.abc import Iterable
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.analysis.observables import observables_with
from gaspart.cli.arguments import (
    Parser,
    UsageError,
    alone,
    integer,
    print_line,
    print_lines,
    set_command,
    several,
)
from gaspart.cli.options import accuracy_lines, add_setting, as_option, engine_settings, one_of
from gaspart.cli.progress import clear_line, progress, waiting
from gaspart.engines import ENGINES, engine_from_dict
from gaspart.errors import SceneError
from gaspart.interruption import set_note
from gaspart.kernels.compile.cache import load_numba
from gaspart.runs.ending import Accuracy
from gaspart.scene.scene import Scene
from gaspart.trajectory.run_options import OPTIONS, recipe_fields

if TYPE_CHECKING:
    from gaspart.accuracy.reached import AccuracyStatus
    from gaspart.trajectory.correlator import Correlations

_PREPARING = "placing particles, compiling kernels (once for each kind of scene)"

_EXAMPLES = """examples:
  gaspart run scene.yaml -o run.nc --duration 100 --sample-interval 1 --seed 1
  gaspart run scene.yaml -o run.nc --until Z=1e-3 --at-most 1000
  gaspart run scene.yaml -o run.nc --duration 100 --sample-interval 1 \\
    --engine step --time-step 0.01
  gaspart run scene.yaml -o run.nc --until Z=1e-3 --replicas 2    on two cores
  gaspart info run.nc"""

_USAGE = """gaspart run SCENE -o FILE --duration T --sample-interval T [options]
       gaspart run SCENE -o FILE --until NAME=X [--at-most T] [options]"""


def add_run(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "Run a scene and write its trajectory. A run of the same settings that was cut short is continued, "
        "and a complete one is not changed; another one is replaced only with --force. It ends after "
        "--duration, or when the standard errors, correlations included, of all observables of --until are "
        "as small as required, which is examined at 64, 96, 128, 192 ... frames."
    )
    set_command(parser, _run, text, _EXAMPLES)
    parser.usage = _USAGE
    add = parser.add_argument
    add("scene", metavar="SCENE", help="scene file (YAML)")
    add("-o", "--output", dest="path", required=True, metavar="FILE", help="trajectory (AMBER NetCDF)")
    add("--engine", default="event", metavar="NAME", help=f"{one_of(ENGINES)}; default: event")
    add("--seed", type=several(int), default=(0,), metavar="N[,N...]", help="default: 0")
    text = (
        "start from the last state of this run, from a .json file of `gaspart play`, or from the last frame "
        "of a .gsd or .xyz file, of the same particles in a container of the same size: "
        "other contacts, gravity, faces or engine, such as images that slide or a piston"
    )
    add("--from", dest="initial", metavar="FILE", help=text)
    _add_ends(parser.add_argument_group("when the run ends"))
    _add_contents(parser.add_argument_group("what the file has"))
    files = parser.add_argument_group("files and interruptions")
    text = "replace a trajectory of another run"
    files.add_argument("--force", dest="overwrite", action="store_true", help=text)
    _add_checkpoints(files)
    text = "for experts: by default chosen for the scene, all but --time-step of step"
    settings = parser.add_argument_group("settings of the engines", text)
    for name, kind in engine_settings().items():
        add_setting(settings, name, kind)


def _add_ends(group: argparse._ArgumentGroup) -> None:
    """Add the options that end a run."""
    add = group.add_argument
    add("--duration", type=float, metavar="T", help="duration of the run, in the scene's unit")
    text = (
        "time between frames, of which the duration is a multiple; default with --until, for plain gases: "
        "the mean time between collisions of a particle"
    )
    add("--sample-interval", type=float, metavar="T", help=text)
    text = (
        f"relative standard error at which the run ends, instead of --duration; several with commas, or by "
        f"repeating it; {one_of(observables_with(ends_runs=True))}; pressure:'x low' is that on one wall"
    )
    add("--until", action="extend", type=_requests, metavar="NAME=X", help=text)
    add("--at-most", type=float, metavar="T", help="longest duration of a run with --until")
    text = "time from which frames count for --until; default: a quarter of the run"
    add("--start", type=float, metavar="T", help=text)
    text = (
        "make so many independent runs at a time, of seeds N,1 N,2 ... in FILE-1.nc FILE-2.nc ...; --until "
        "is then of their mean; default: 1"
    )
    add("--replicas", type=integer(least=1.0), default=1, metavar="P", help=text)


def _add_contents(group: argparse._ArgumentGroup) -> None:
    """Add the options for the contents of the file."""
    add = group.add_argument
    for name, kind in OPTIONS.items():
        add_setting(group, name, kind)
    add(
        "--correlations",
        type=several(float),
        metavar="T,L[,START]",
        help="accumulate time correlations of samples every T, up to L of them apart, from START on",
    )
    text = "correlate the stress tensor and the heat flux instead of velocities"
    add("--stress", action="store_true", help=text)


def add_resume(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "Finish a run that was cut short, from FILE.partial and FILE.checkpoint.npz. With --duration, "
        "continue a complete run to that time: from the state at its end if it was kept (--keep-checkpoint), "
        "otherwise from its start. The file has then the bytes of one run of this duration."
    )
    examples = "examples:\n  gaspart resume run.nc\n  gaspart resume run.nc --duration 200"
    set_command(parser, _resume, text, examples)
    parser.add_argument("trajectory", metavar="FILE", help="trajectory of the run")
    text = "longer duration of a complete run, from its time 0 on"
    parser.add_argument("--duration", type=float, metavar="T", help=text)
    _add_checkpoints(parser)


def _add_checkpoints(group: argparse._ActionsContainer) -> None:
    text = "leave the state at the end in FILE.checkpoint.npz, for `gaspart resume --duration`"
    group.add_argument("--keep-checkpoint", action="store_true", help=text)
    text = "seconds between checkpoints, the most that is lost if the run is killed; default: 30"
    group.add_argument("--checkpoint-seconds", type=float, default=30.0, metavar="S", help=text)
    group.add_argument("--quiet", action="store_true", help="show no progress")


def _run(options: argparse.Namespace) -> None:
    set_note("no state was saved yet; the same command starts it again")
    from gaspart.accuracy.scales import scales
    from gaspart.runs.entry import run

    scene = Scene.from_file(options.scene)
    given = {
        **vars(options),
        **recipe_fields(_values(options, OPTIONS)),
        "scene": scene,
        "seed": alone(options.seed),
        "until": _until(options, scene),
        "correlations": _correlations(options.correlations, options.stress),
    }
    try:
        given["engine"] = engine_from_dict({"name": options.engine, **_values(options, engine_settings())})
    except SceneError as error:
        raise UsageError(as_option(error, options.engine)) from None
    status = _Status()
    with waiting(_PREPARING, options.quiet) as started:
        load_numba(ours=True)
        given |= {"progress": progress(options.quiet, started, status.remark), "examined": status.update}
        # options have the names of the arguments
        names = signature(run).parameters
        path = run(**{name: given[name] for name in names if given.get(name) is not None})
    _report(path)
    if not options.quiet:
        print_lines(line for line in scales(scene).lines if not line.startswith("suggested"))


def _values(arguments: argparse.Namespace, names: Iterable[str]) -> dict[str, Any]:
    """Return the values of the declared options in a command line."""
    return {name: value for name in names if (value := getattr(arguments, name)) is not None}


def _requests(text: str) -> list[tuple[str, float]]:
    """Return names (with optional faces) and accuracies from NAME=X,NAME=X."""
    requests = []
    for part in text.split(","):
        name, _, accuracy = part.partition("=")
        try:
            requests.append((name, float(accuracy)))
        except ValueError:
            rule = "must be the name of an observable, = and its relative accuracy, as Z=1e-3 for 0.1 %"
            raise argparse.ArgumentTypeError(f"{part!r} {rule}") from None
    return requests


def _until(options: argparse.Namespace, scene: Scene) -> list[Accuracy] | None:
    """Return the accuracies of --until. Raises UsageError for options that exclude or require each other.
    Without a duration, the message suggests a duration for the scene.
    """
    if options.until is not None:
        if options.duration is not None:
            raise UsageError("--duration: excludes --until; the longest duration is --at-most")
        return [Accuracy.from_name(name, value, options.start) for name, value in options.until]
    for option, value in (("--at-most", options.at_most), ("--start", options.start)):
        if value is not None:
            raise UsageError(f"{option}: needs --until")
    missing = [
        option
        for option, value in (
            ("--duration", options.duration),
            ("--sample-interval", options.sample_interval),
        )
        if value is None
    ]
    if missing:
        from gaspart.accuracy.scales import scales

        rule = f"the following arguments are required: {', '.join(missing)}, or --until"
        proposal = scales(scene).proposal
        hint = f"for this scene {proposal}" if proposal else "see `gaspart run --help`"
        raise UsageError(f"{rule}; {hint}")
    return None


class _Status:
    """Result of the last test of a run with --until, for the progress line."""

    def __init__(self) -> None:
        self._reached: list[AccuracyStatus] = []

    def update(self, reached: list[AccuracyStatus]) -> None:
        """Store the result of a test."""
        self._reached = reached

    def remark(self) -> str:
        """Return text about the error that is largest relative to the required error."""
        finite = [status for status in self._reached if status.accuracy < math.inf]
        if not finite:
            return ""
        worst = max(finite, key=lambda status: status.accuracy / status.request.accuracy)
        error = f"error {worst.accuracy:.2g}, at most {worst.bound:.2g}"
        return f"  {worst.request.name}: {error}, required {worst.request.accuracy:g}"


def _correlations(numbers: tuple[float, ...] | None, stress: bool) -> Correlations | None:
    if numbers is None:
        if stress:
            raise UsageError("--stress: needs --correlations")
        return None
    if len(numbers) not in (2, 3) or not numbers[1].is_integer():
        raise UsageError("--correlations: must be an interval, a whole number of lags and perhaps a start")
    from gaspart.trajectory.correlator import Correlations

    start = numbers[2] if len(numbers) > 2 else 0.0
    return Correlations(numbers[0], int(numbers[1]), start, stress)


def _resume(options: argparse.Namespace) -> None:
    set_note("nothing was changed; the same command starts it again")
    from gaspart.runs.entry import resume

    status = _Status()
    with waiting(_PREPARING, options.quiet) as started:
        load_numba(ours=True)
        show = progress(options.quiet, started, status.remark)
        lasts = {"duration": options.duration, "keep_checkpoint": options.keep_checkpoint}
        path = resume(options.trajectory, options.checkpoint_seconds, show, status.update, **lasts)
    _report(path)


def _report(path: Path) -> None:
    if wiped := clear_line():  # even an empty line fails if stderr is full
        print(wiped, end="", file=sys.stderr)
    from gaspart.trajectory.replicas import files_of

    for line in accuracy_lines(path):
        print_line(line)
    files = files_of(path)
    are = "is complete" if len(files) == 1 else "are complete, replicas of one run"
    command = f"`gaspart info {shlex.quote(str(files[0]))}` lists its contents"
    print_line(f"{', '.join(map(str, files))} {are}; {command}")
