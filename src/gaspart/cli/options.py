"""Options of engines and runs: added to a parser, and stated as a command."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.cli.arguments import alone, several
from gaspart.engines import ENGINES, engine_to_dict
from gaspart.errors import SceneError, short_repr
from gaspart.keys import Kind, describe, schema_of
from gaspart.trajectory.run_options import OPTIONS, stated_options

if TYPE_CHECKING:
    from gaspart.accuracy.reached import AccuracyStatus
    from gaspart.trajectory.recipe import Recipe


def accuracy_lines(path: Path) -> list[str]:
    """Describe the required and the reached accuracies of a run with --until."""
    from gaspart.accuracy.reached import reached_accuracy
    from gaspart.trajectory.opening import PARTIAL

    lines, reached = [], reached_accuracy(path)
    for status in reached:
        where = f" ({status.component})" if status.component and status.request.face is None else ""
        required = f"required {status.request.accuracy:g}"
        if status.rule:
            lines.append(f"{status.request.name}: {required}, not measured: {status.rule}")
            continue
        low, high = status.interval
        value = f"{status.value:.6g} +- {status.error:.2g}, 95 % interval {low:.6g} to {high:.6g}"
        error = f"relative error {status.accuracy:.2g}, by its uncertainty at most {status.bound:.2g}"
        verdict = "reached" if status.met else "not reached"
        lines.append(
            f"{status.request.name}{where} = {value}{_starts(status)}; {error}; {required}: {verdict}"
        )
    if path.suffix != PARTIAL and not all(status.met for status in reached):
        lines.append(_why_ended(path, reached))
    return lines + _drift_lines(path, {status.request.start for status in reached})


def _drift_lines(path: Path, starts: set[float | None]) -> list[str]:
    """Return remarks if a run, or its replicas, is not steady after the start times."""
    from gaspart.analysis.drift import drift_of
    from gaspart.trajectory.replicas import files_of

    remarks = [drift_of(*files_of(path), start=start) for start in starts]
    return [f"(not steady: {remark})" for remark in dict.fromkeys(filter(None, remarks))]


def other_seeds(scatter: float) -> str:
    """Return the remark that a single run's interval excludes the scatter of energies."""
    return f"for the energy of this run; other seeds scatter by {100.0 * scatter:.2g} %"


def _starts(reached: AccuracyStatus) -> str:
    """Return a remark on the initial energies of runs; "" if they do not scatter."""
    if not reached.scatter:
        return ""
    if reached.replicas == 1:
        return f" {other_seeds(reached.scatter)}"
    return f", {100.0 * reached.of_starts:.2g} % of it by the energies of the starts"


def _why_ended(path: Path, reached: list[AccuracyStatus]) -> str:
    """Return the reason why a run with --until ended before it was accurate."""
    from gaspart.trajectory.replicas import find_run

    if limited := [status for status in reached if status.excess <= 1.0 and not status.met]:
        remedy = f"no longer run makes the mean of {limited[0].replicas} replicas as accurate"
        return f"{remedy}: the energies of their starts scatter; exact_temperature: true, or more replicas"
    until = find_run(path)[1].until
    if until is not None and until.at_most is None:
        return "the run was given up: nothing that could be measured has happened; --at-most makes it longer"
    return "the longest duration (--at-most) ended the run before all were reached"


def run_options(path: Path, recipe: Recipe) -> list[str]:
    """Return the options of `gaspart run` for a recipe. For a replica, the options start all replicas."""
    from gaspart.trajectory.replicas import of_all, path_of_all

    path, (recipe, replicas) = path_of_all(path, recipe), of_all(recipe)
    settings = engine_to_dict(recipe.engine)
    options = ["-o", str(path), "--engine", settings["name"], "--seed", join_numbers(recipe.seed)]
    if recipe.until is None:
        options += ["--duration", repr(recipe.duration)]
    else:
        accuracies = recipe.until.accuracies
        options += ["--until", ",".join(f"{accuracy.name}={accuracy.accuracy!r}" for accuracy in accuracies)]
        options += [] if accuracies[0].start is None else ["--start", repr(accuracies[0].start)]
        options += [] if recipe.until.at_most is None else ["--at-most", repr(recipe.until.at_most)]
    options += ["--sample-interval", repr(recipe.sample_interval)]
    options += ["--replicas", str(replicas)] if replicas > 1 else []
    options += changed_options(engine_settings(), settings)
    if recipe.initial is not None:
        options += ["--from", "OTHER.nc"]  # the file has the final state of this run
    options += changed_options(OPTIONS, stated_options(recipe))
    if recipe.correlations is not None:
        correlations = recipe.correlations
        options += ["--correlations", f"{correlations.interval!r},{correlations.lags},{correlations.start!r}"]
        options += ["--stress"] if correlations.stress else []
    return options


@cache
def engine_settings() -> dict[str, Kind]:
    """Return the settings of all engines by name; descriptions list the engines that have them."""
    settings: dict[str, Kind] = {}
    for name, engine in ENGINES.items():
        for key, kind in schema_of(engine)["properties"].items():
            meaning = f"{name} engine: {kind['description']}"
            previous = settings.get(key)
            settings[key] = describe(kind, f"{previous['description']}; {meaning}" if previous else meaning)
    return settings


def add_setting(group: argparse._ArgumentGroup, name: str, kind: Kind) -> None:
    """Add the option of a setting: a number, a word, a text, or a flag. The option of a boolean setting is a
    flag that inverts the default.
    """
    option, meaning, default = name.replace("_", "-"), kind["description"], kind.get("default")
    usual = "" if default is None else f"; default: {default}"
    types = kind.get("type", ())
    if types == "boolean":
        option, action = (f"no-{option}", "store_false") if default else (option, "store_true")
        meaning = f"switches off: {meaning}" if default else meaning
        group.add_argument(f"--{option}", dest=name, action=action, default=None, help=meaning)
    elif "enum" in kind:
        words = one_of(choice for choice in kind["enum"] if choice is not None)
        group.add_argument(f"--{option}", metavar="NAME", help=f"{meaning}: {words}{usual}")
    elif types == "string":
        group.add_argument(f"--{option}", dest=name, metavar=kind["title"], help=f"{meaning}{usual}")
    else:
        sides = "array" in types
        read: Any = _sides if sides else int if "integer" in types else float
        metavar = "N[,N...]" if sides else "N" if read is int else "X"
        group.add_argument(f"--{option}", type=read, metavar=metavar, help=f"{meaning}{usual}")


def _sides(text: str) -> int | tuple[int, ...]:
    return alone(several(int)(text))


def one_of(words: Iterable[str]) -> str:
    """Join words to a text such as "a, b or c"."""
    *first, last = words
    return f"{', '.join(first)} or {last}" if first else last


def as_option(error: SceneError, engine: str) -> str:
    """Return the text of an error, with command-line options instead of engine settings."""
    name = error.key.removeprefix("engine.")
    option = {"name": "--engine", "rewind": "--no-rewind"}.get(name, f"--{name.replace('_', '-')}")
    rule = f"has no meaning with --engine {engine}" if "unknown key" in error.rule else error.rule
    return f"{option}: {'is required' if error.value is None else f'{short_repr(error.value)}: {rule}'}"


def changed_options(kinds: Mapping[str, Kind], settings: Mapping[str, Any]) -> list[str]:
    """Return the options for all settings that differ from their defaults. `kinds` contains the kinds of the
    settings. The result always includes the options of settings without a default.
    """
    options: list[str] = []
    for name, kind in kinds.items():
        value, option = settings.get(name), name.replace("_", "-")
        if isinstance(value, bool):
            if value != kind["default"]:
                options.append(f"--no-{option}" if kind["default"] else f"--{option}")
        elif value is not None:
            options += [f"--{option}", value if isinstance(value, str) else join_numbers(value)]
    return options


def join_numbers(numbers: float | tuple[int, ...] | list[int]) -> str:
    """Format numbers in the form that an option accepts."""
    return ",".join(map(repr, numbers)) if isinstance(numbers, tuple | list) else repr(numbers)
