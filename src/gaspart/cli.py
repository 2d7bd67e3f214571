"""The command line: `gaspart run | resume | info | render | theory`.

A user's mistake is one line on stderr and exit code 2; a run that broke an invariant, 1; Ctrl-C, 130.
"""

from __future__ import annotations

import argparse
import shlex
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from gaspart import __version__
from gaspart.errors import SceneError, SimulationError
from gaspart.rendering.command import add_render

_ENGINE_SETTINGS = ("time_step", "boxes_per_side", "precision", "rewind", "search")
_ENGINE_SETTINGS += ("passes", "skin", "near_boxes", "threads")

# `gaspart theory`: name -> (function of gaspart.theory, the body's properties it takes, what it is)
_BODY = ("diameter", "temperature", "mass")
_QUANTITIES = {
    "Z": ("compressibility_factor", (), "compressibility factor PV/(N k_B T), best reference"),
    "contact_value": ("contact_value", (), "pair distribution at contact g(sigma)"),
    "mean_free_path": ("mean_free_path", ("diameter",), "mean free path"),
    "collision_rate": ("collision_rate", _BODY, "collisions per body and time"),
    "diffusion_coefficient": ("enskog_diffusion", _BODY, "self-diffusion coefficient of Enskog's theory"),
    "viscosity": ("enskog_viscosity", _BODY, "shear viscosity of Enskog's theory"),
}


class _Parser(argparse.ArgumentParser):
    def error(self, message: str):
        raise _UsageError(message)


class _UsageError(Exception):
    """What argparse has to complain of."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Carry out a command line; returns the exit code."""
    try:
        given = _parser().parse_args(arguments)
        given.command(given)
    except (SceneError, _UsageError) as error:
        return _complain(error, 2)
    except MemoryError:
        return _complain("there is not enough memory for this", 2)
    except SimulationError as error:
        return _complain(error, 1)
    except KeyboardInterrupt:
        return _complain("interrupted; an unfinished run is kept, and `gaspart resume` goes on with it", 130)
    except BrokenPipeError:  # the reader of the output, `head` say, has had enough
        sys.stderr.close()
        return 0
    return 0


def _complain(error: object, code: int) -> int:
    text = " ".join(str(error).split())
    print(f"{_clear_line()}gaspart: error: {text}", file=sys.stderr)
    return code


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="gaspart", description="Hard-sphere and hard-disc gases.", allow_abbrev=False)
    parser.add_argument("--version", action="version", version=f"gaspart {__version__}")
    commands = parser.add_subparsers(required=True, metavar="run | resume | info | render | theory")
    _add_run(commands)
    _add_resume(commands)
    _add_info(commands)
    add_render(commands)
    _add_theory(commands)
    return parser


def _several(kind: type):
    """What reads `1` or `1,2,3` as a tuple of int or float."""

    def read(text: str) -> tuple:
        try:
            return tuple(kind(part) for part in text.split(","))
        except ValueError:
            rule = (
                f"must be {'a whole number' if kind is int else 'a number'}, or several with commas between"
            )
            raise argparse.ArgumentTypeError(f"{text!r} {rule}") from None

    return read


def _add_run(commands) -> None:
    text = (
        "Run a scene and write its trajectory. A run of the same settings that was cut short is continued, "
        "and one that is whole is left as it is; another one is replaced only with --force."
    )
    run = commands.add_parser("run", help="run a scene", description=text, allow_abbrev=False)
    run.set_defaults(command=_run)
    add, whole = run.add_argument, _several(int)
    add("scene", help="scene file (YAML)")
    add("-o", "--output", required=True, metavar="FILE", help="trajectory (AMBER NetCDF)")
    add("--engine", default="event", metavar="NAME", help="event (exact; the default) or step")
    add("--duration", type=float, required=True, metavar="T", help="in the scene's time")
    add("--sample-interval", type=float, required=True, metavar="T", help="a whole part of the duration")
    add("--seed", type=whole, default=(1,), metavar="N[,N...]", help="default: 1")
    add(
        "--displacements", action="store_true", help="write unwrapped float64 displacements since time 0, too"
    )
    add("--follow", type=int, metavar="N", help="write the first N bodies only")
    add("--time-step", type=float, metavar="T", help="step engine: a whole part of the sample interval")
    add("--boxes-per-side", type=whole, metavar="N[,N...]", help="one number for all sides, or one per side")
    add("--precision", metavar="TYPE", help="step engine: float64 (default) or float32")
    text = "step engine: collide pairs as they lie after the step, not as they were at their contact"
    add("--no-rewind", dest="rewind", action="store_false", default=None, help=text)
    add("--passes", type=int, metavar="N", help="step engine: how often a step may look for overlaps (4)")
    add("--skin", type=float, metavar="L", help="step engine: of its neighbour list; by default it chooses")
    text = "step engine: look only into boxes within reach of a contact"
    add("--near-boxes", action="store_true", default=None, help=text)
    add("--threads", type=int, metavar="N", help="step engine: how many share the work (1)")
    add("--search", metavar="NAME", help="event engine: boxes (default), direct or pairs")
    add("--force", action="store_true", help="replace a trajectory of another run")
    _add_progress(run)


def _add_resume(commands) -> None:
    text = "Finish a run that was cut short, from FILE.partial and FILE.checkpoint.npz alone."
    resume = commands.add_parser("resume", help="finish a run that was cut short", description=text)
    resume.set_defaults(command=_resume)
    resume.add_argument("trajectory", metavar="FILE", help="the trajectory that the run was to write")
    _add_progress(resume)


def _add_progress(parser) -> None:
    text = "time between checkpoints, default 30: what a kill may cost"
    parser.add_argument("--checkpoint-seconds", type=float, default=30.0, metavar="S", help=text)
    parser.add_argument("--quiet", action="store_true", help="show no progress")


def _add_info(commands) -> None:
    text = "What a trajectory holds, and the command that makes it again."
    info = commands.add_parser("info", help="what a trajectory holds", description=text)
    info.set_defaults(command=_info)
    info.add_argument("trajectory", metavar="FILE")
    info.add_argument("--scene", action="store_true", help="print the scene file and nothing else")


def _add_theory(commands) -> None:
    names = "; ".join(f"{name}: {meaning}" for name, (_, _, meaning) in _QUANTITIES.items())
    theory = commands.add_parser("theory", help="what theory says", description=f"{names}. Units: k_B = 1.")
    theory.set_defaults(command=_theory)
    theory.add_argument("quantity", choices=_QUANTITIES, metavar="QUANTITY", help=", ".join(_QUANTITIES))
    theory.add_argument(
        "--eta", type=_several(float), required=True, metavar="X[,X...]", help="packing fraction"
    )
    theory.add_argument("--dimension", type=int, choices=(2, 3), required=True)
    for name in _BODY:
        theory.add_argument(f"--{name}", type=float, help="default: 1")


def _run(given: argparse.Namespace) -> None:
    from gaspart.engines import engine_from_dict
    from gaspart.scene import Scene
    from gaspart.trajectory import run

    settings = {key: getattr(given, key) for key in _ENGINE_SETTINGS if getattr(given, key) is not None}
    if "boxes_per_side" in settings:
        settings["boxes_per_side"] = _alone(settings["boxes_per_side"])
    path = run(
        Scene.from_file(given.scene),
        engine_from_dict({"name": given.engine, **settings}),
        seed=_alone(given.seed),
        duration=given.duration,
        sample_interval=given.sample_interval,
        path=given.output,
        displacements=given.displacements,
        follow=given.follow,
        checkpoint_seconds=given.checkpoint_seconds,
        progress=_progress(given.quiet),
        overwrite=given.force,
    )
    _tell(path)


def _alone(numbers: tuple[int, ...]) -> int | tuple[int, ...]:
    return numbers[0] if len(numbers) == 1 else numbers


def _resume(given: argparse.Namespace) -> None:
    from gaspart.trajectory import resume

    _tell(resume(given.trajectory, given.checkpoint_seconds, _progress(given.quiet)))


def _tell(path: Path) -> None:
    print(f"{_clear_line()}", end="", file=sys.stderr)
    print(f"{path} is whole; `gaspart info {shlex.quote(str(path))}` tells what it holds")


def _progress(quiet: bool):
    """Something that shows the progress of a run on one line, or None where nobody would see it."""
    if quiet or not sys.stderr.isatty():
        return None
    begun = None

    def show(reached: float, duration: float, collisions: int) -> None:
        nonlocal begun
        now = time.monotonic()
        if begun is None:  # a resumed run begins in the middle
            begun = now, reached, collisions
            return
        took = now - begun[0]
        rate = (reached - begun[1]) / took
        left = f"{_clock((duration - reached) / rate)} left" if rate > 0.0 else ""
        speed = f"{(collisions - begun[2]) / took:.3g} collisions/s"
        print(
            f"{_clear_line()}{reached / duration:6.1%}  {speed}  {left}", end="", file=sys.stderr, flush=True
        )

    return show


def _clear_line() -> str:
    return "\r\033[K" if sys.stderr.isatty() else ""


def _clock(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{seconds:02d}"


def _info(given: argparse.Namespace) -> None:
    from gaspart.recipe import opened, read_recipe
    from gaspart.trajectory import partial_path

    path = Path(given.trajectory)
    found = path if path.exists() or not partial_path(path).exists() else partial_path(path)
    recipe = read_recipe(found)
    with opened(found) as file:
        stored, frames = file.__dict__, len(file.dimensions["frame"])
    if given.scene:
        print(stored["scene"], end="")
        return
    scene = recipe.scene
    state = "whole" if frames == recipe.frames else "unfinished: `gaspart resume` goes on with it"
    versions = [f"{key.removesuffix('_version')} {stored[key]}" for key in stored if key.endswith("_version")]
    remake = [
        f"gaspart info --scene {shlex.quote(str(found))} > scene.yaml",
        "gaspart run scene.yaml " + shlex.join(_run_options(path, recipe, stored)),
    ]
    print(f"{found}: {stored['title']}, {frames} of {recipe.frames} frames, {state}")
    print(f"packing fraction {scene.packing_fraction:.6g}, number density {scene.number_density:.6g}")
    print(f"written by {', '.join(versions)}; revision {stored.get('git_revision', 'none')}")
    print("made again, to the same bits, by")
    print("\n".join(f"    {line}" for line in remake))
    print("scene:")
    print("".join(f"    {line}\n" for line in stored["scene"].splitlines()), end="")


def _run_options(path: Path, recipe, stored: dict) -> list[str]:
    """The options of `gaspart run` that stand for a recipe."""
    from gaspart.engines import engine_to_dict

    settings = engine_to_dict(recipe.engine)
    options = ["-o", str(path), "--engine", settings["name"], "--seed", _joined(recipe.seed)]
    options += ["--duration", repr(recipe.duration), "--sample-interval", repr(recipe.sample_interval)]
    if "time_step" in settings:
        options += ["--time-step", repr(settings["time_step"])]
    if "boxes_per_side" in settings:
        options += ["--boxes-per-side", _joined(settings["boxes_per_side"])]
    for key in ("precision", "search"):
        if key in settings:
            options += [f"--{key}", settings[key]]
    for key in ("passes", "skin", "threads"):
        if key in settings:
            options += [f"--{key}", repr(settings[key])]
    if settings.get("near_boxes"):
        options.append("--near-boxes")
    if settings.get("rewind") is False:
        options.append("--no-rewind")
    if recipe.displacements:
        options.append("--displacements")
    if recipe.follow is not None:
        options += ["--follow", str(recipe.follow)]
    return options


def _joined(numbers: int | tuple[int, ...]) -> str:
    return ",".join(map(str, numbers)) if isinstance(numbers, tuple) else str(numbers)


def _theory(given: argparse.Namespace) -> None:
    from gaspart import theory

    function, takes, _ = _QUANTITIES[given.quantity]
    properties = {key: getattr(given, key) for key in _BODY}
    properties = {key: value for key, value in properties.items() if value is not None}
    for key in properties:
        if key not in takes:
            raise SceneError(key, properties[key], f"{given.quantity} does not depend on it")
    for eta in given.eta:
        try:
            value = getattr(theory, function)(eta, given.dimension, **properties)
            spread = theory.compressibility_uncertainty(eta, given.dimension)
        except ValueError as error:
            raise _UsageError(error) from None
        error = f" +- {float(spread):.1g}" if given.quantity == "Z" else ""
        print(f"{given.quantity}(eta = {eta:g}, dimension = {given.dimension}) = {float(value):.10g}{error}")
