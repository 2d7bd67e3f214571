"""Description of a run: required accuracies, reached accuracies, and options."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.cli.engine_options import changed_options, engine_settings, join_numbers
from gaspart.engines import engine_to_dict
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
