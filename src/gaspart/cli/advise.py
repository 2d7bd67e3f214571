"""`gaspart advise`: engine, settings and length of a run for a required accuracy, and its cost."""

from __future__ import annotations

import argparse
import math
import os
import shlex
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.accuracy import PILOT_SECONDS
from gaspart.analysis.observables import OBSERVABLES
from gaspart.cli.arguments import (
    Parser,
    Suggested,
    UsageError,
    config_command,
    print_lines,
    print_note,
    real,
    set_command,
)
from gaspart.cli.options import one_of, run_options
from gaspart.cli.progress import waiting
from gaspart.scene.scene import Scene

if TYPE_CHECKING:
    from gaspart.accuracy.option import Option
    from gaspart.accuracy.plan import Plan
    from gaspart.accuracy.scatter import Scatter

_EXAMPLES = """examples:
  gaspart advise scene.yaml --observable Z --accuracy 1e-3
  gaspart advise scene.yaml --observable D --accuracy 1e-2 --budget 60
  gaspart advise heated.yaml --observable temperature --accuracy 3e-2
  gaspart advise --config config/config.yaml   # core-hours of all points"""


def add_advise(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "The cheapest engine, settings and run for a relative accuracy of an observable (the standard error, "
        "as of `run --until`, and systematic errors), and the command that runs it; or, with --config, the "
        "cost of the simulations of a config. For Z, D and the collision rate of one species in a periodic "
        "container errors and times are known, times of another machine. For all else short pilot runs are "
        "made, which are kept and reused."
    )
    set_command(parser, _advise, text, _EXAMPLES)
    add = parser.add_argument
    add("scene", nargs="?", help="scene file (YAML)")
    text = f'{one_of(OBSERVABLES)}, or the pressure on one wall, as "pressure:x low"; default: Z'
    add("--observable", default="Z", choices=Suggested(OBSERVABLES), metavar="NAME", help=text)
    add("--accuracy", type=real(above=0.0), default=1e-2, metavar="X", help="relative; default: 0.01")
    add("--budget", type=_seconds, metavar="S", help="largest processor time, in s (60 or 60s)")
    text = f"processor time of all pilot runs, in s; default: {PILOT_SECONDS:g}"
    add("--pilot", type=_seconds, default=PILOT_SECONDS, metavar="S", help=text)
    add("--config", metavar="FILE", help="a config instead of a scene")


def _seconds(text: str) -> float:
    return real(above=0.0)(text.removesuffix("s"))


def _advise(options: argparse.Namespace) -> None:
    if (options.scene is None) == (options.config is None):
        raise UsageError("give a scene or --config, and not both")
    if options.config:
        with waiting("predicting the cost of every point"):
            lines = config_command("advise")(options.config)
        print_lines(lines)
        return
    from gaspart.accuracy.plan import plan

    def announce(text: str) -> None:
        if sys.stderr.isatty():
            print_note(text)

    scene, request = Scene.from_file(options.scene), (options.observable, options.accuracy, options.budget)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # coarse settings, whose error is stated in the table
        advice = plan(scene, *request, options.pilot, announce)
    print_lines(_lines(advice, options.scene))


def _lines(plan: Plan, file: str) -> list[str]:
    """Return the advice as text; `file` is the scene file, which the advised command names."""
    from gaspart.accuracy.advisers import adviser_of

    best, target = plan.best, plan.target
    adviser = adviser_of(best.engine)
    notes = adviser.notes(target.scene, target.observable, target.declared.memory)
    lines = [_line("engine", adviser.describe()), *(_line(*note) for note in notes.items())]
    if math.isfinite(best.seconds):
        lines += _run(plan, file)
    lines += _rarely_visited(plan)
    scatter = plan.scatter
    lines += _energy_scatter(plan, scatter)
    lines.append(_extra_cost(plan))
    if not plan.affordable:
        lines.append(_shortfall(plan))
    for pilot in plan.pilots:
        cost = f"{pilot.seconds:.2g} s" if pilot.seconds else "kept from before"
        outcome = f"{pilot.value:.4g} to {100.0 * pilot.accuracy:.2g} %" if pilot.measured else pilot.rule
        lines.append(_line("pilot", f"{pilot.engine.title}, {cost}: {outcome}"))
    lines += _differences(plan)
    for other in plan.options[1:]:
        able = other.bias < plan.accuracy and math.isfinite(other.seconds)
        cost = f"{other.seconds:.3g} s" if able else "not as accurate"
        adviser = adviser_of(other.engine)
        reasons = f"{cost}; {_components(other)}; gives up {adviser.limitations}"
        lines.append(_line("why not", f"{adviser.describe()}: {reasons}"))
    lines += [_line("why not", f"{name}: {rule}") for name, rule in plan.refused.items()]
    return lines


def _line(title: str, text: str) -> str:
    return f"{title:18s}{text}"


def _run(plan: Plan, file: str) -> list[str]:
    """Describe the recommended run, its cost and its accuracy, in lines."""
    best, recipe, lines = plan.best, plan.recipe, []
    if gas := plan.gas:
        length = f"{plan.collisions_per_particle:.3g} measured collisions per particle"
        lines += [
            _line("particles", f"{gas.count}{_bulk(plan, gas.count)}"),
            _line(
                "run length", f"{length}, duration {plan.duration:.4g} with equilibration, in each replica"
            ),
        ]
    options = run_options(Path("run.nc"), recipe)
    options += ["--replicas", str(plan.replicas)] if plan.replicas > 1 else []
    command = shlex.join(["gaspart", "run", file, *options])
    total = "" if plan.gas else f", duration {plan.duration:.4g}"
    total += " of each" if total and plan.replicas > 1 else ""
    cores = min(plan.replicas, os.cpu_count() or 1)
    rounds = math.ceil(plan.replicas / cores)
    time = f"{rounds * plan.seconds / plan.replicas:.3g} s on {cores} core{'s' if cores > 1 else ''}"
    machine = " of the machine of the table" if plan.gas else ""
    cost = f"{plan.seconds:.3g} s of processor time{machine}, {time}{total}"
    value = f"{plan.target.name} (about {plan.value:.4g}): {_components(best)}"
    lines += [
        _line("replicas", f"{plan.replicas}"),
        _line("command", command),
        _line("predicted cost", cost),
        _line("standard error", f"{best.error:.2g} of {value}"),
    ]
    if correlations := recipe.correlations:
        lags = f"{correlations.interval:g} apart, up to {correlations.lags * correlations.interval:.4g}"
        lines.append(_line("lags", f"{lags}, the time of about 10 collisions of a particle"))
    return lines


def _bulk(plan: Plan, count: int) -> str:
    """Describe the effect of the finite size of the container."""
    differing, bulk_count = plan.finite_size
    text = f"; {plan.target.name} differs by {100.0 * differing:+.2g} % from an infinite gas"
    return text + (f": correct for it, or take {bulk_count:.2g}" if bulk_count > count else "")


def _rarely_visited(plan: Plan) -> list[str]:
    """Describe the range of a curve in which the required accuracy is reached."""
    visited, total = plan.points
    if visited == total:
        return []
    text = (
        f"{visited} of {total}, to which particles come in every part of the pilot: the accuracy is of these"
    )
    return [f"places            {text}"]


def _energy_scatter(plan: Plan, scatter: Scatter) -> list[str]:
    """Describe the error due to different initial energies of runs, in lines."""
    if not scatter.value:
        return []
    of_mean = f", {scatter.value / math.sqrt(plan.replicas):.2g} of their mean" if plan.replicas > 1 else ""
    text = f"{scatter.value:.2g} of {plan.target.name} from run to run{of_mean}, beyond this"
    lines = [_line("energy at start", text)]
    if scatter.drawn:
        lines.append("                  velocities are drawn: exact_temperature: true removes their part")
    if scatter.placed:
        lines.append(
            "                  heights are random: the mean of runs with several seeds, or of runs from "
            "one state (--from), which have one energy"
        )
    return lines


def _differences(plan: Plan) -> list[str]:
    """Describe pilot runs whose results differ by more than their error bounds. The lines also name the exact
    engine, whose pilot run is used.
    """
    lines = []
    for pilot in plan.differing:
        exact = plan.pilots[0]
        values = f"{pilot.value:.4g} against {exact.value:.4g} by the {exact.engine.title} engine"
        text = f"{pilot.engine.title}: {values}, more than its bound and their noise"
        lines.append(_line("pilots differ", text))
    return lines


def _extra_cost(plan: Plan) -> str:
    """Describe the cost of a run in addition to the collisions of a plain gas."""
    from gaspart.accuracy.table import price_of

    price = price_of(plan.target.scene, plan.best.engine, plan.target.observable)
    measured = ", ".join(f"{name} {ratio:.2f}" for name, ratio in price.ratios.items())
    parts = [f"{measured} times the time per event"] if measured else []
    parts += [f"not measured: {', '.join(price.unknown)}"] if price.unknown else []
    parts += [f"float32 takes {price.single:.2f} of the time of float64"] if price.single else []
    return _line("extra cost", "; ".join(parts) or "none beside its collisions")


def _components(option: Option) -> str:
    """Describe the contributions to the error of an option of the plan."""
    noise = option.error - option.bias
    of = option.candidate
    parts = {"noise": noise, "model": of.model, "steps and cells": of.discretisation}
    parts["difference of the pilots"] = option.bias if option.bias > of.bias else 0.0
    terms = [
        f"{name} {f'{value:.1g}' if value < 1.0 else 'above 1'}"
        for name, value in parts.items()
        if 0.0 < value < math.inf
    ]
    return ", ".join(terms) or "no systematic error"


def _shortfall(plan: Plan) -> str:
    """Describe what would be required for an accuracy that cannot be reached. The reason may be the time
    budget, the restriction to a single run, or the errors of the engines.
    """
    able = [option for option in plan.options if option.bias < plan.accuracy]
    if not able:
        return f"no engine is known to be as accurate as {plan.accuracy:g}"
    if plan.budget is None:
        advice = f"the mean of {plan.runs} runs with other seeds has it" if plan.runs else "no run reaches it"
        return f"one run does not reach {plan.accuracy:g}, however long it is: {advice}"
    least = min(able, key=lambda option: option.cost(plan.accuracy))
    cost, engine = f"{least.cost(plan.accuracy):.3g} s", least.engine.title
    return f"the budget does not suffice for {plan.accuracy:g}, which takes {cost}, {engine} engine"
