"""`gaspart advise`: engine, settings and length of a run for a required accuracy, and its cost."""

from __future__ import annotations

import argparse
import math
import shlex
import sys
import warnings
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.accuracy import PILOT_SECONDS
from gaspart.analysis.observables import OBSERVABLES
from gaspart.cli.arguments import (
    Parser,
    Suggested,
    UsageError,
    of_configs,
    print_lines,
    real,
    set_command,
)
from gaspart.cli.engine_options import one_of, stated
from gaspart.cli.progress import waiting
from gaspart.cli.run import run_options
from gaspart.engines import DSMC, Engine, TimeStepped
from gaspart.errors import visible
from gaspart.kernels.compile.loading import load_numba
from gaspart.scene.scene import Scene

if TYPE_CHECKING:
    from gaspart.accuracy.advice import Advice, Setting
    from gaspart.accuracy.plan import Option, Plan
    from gaspart.trajectory.recipe import Recipe

_EXAMPLES = """examples:
  gaspart advise scene.yaml --observable Z --accuracy 1e-3
  gaspart advise scene.yaml --observable D --accuracy 1e-2 --budget 60
  gaspart advise heated.yaml --observable temperature --accuracy 3e-2
  gaspart advise --config config/config.yaml     the cost of a complete grid, in core-hours"""


def add_advise(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "The cheapest engine, settings and run for a relative accuracy (half the width of a 95 % interval) "
        "of an observable, and the command that runs it; or, with --config, the cost of the simulations of "
        "a config. For Z, D and the collision rate of one species in a periodic container errors and times "
        "are known, and the speed of this machine is measured by a run of a tenth of a second. For all else "
        "short pilot runs are made, which are kept and reused."
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


def _advise(given: argparse.Namespace) -> None:
    if (given.scene is None) == (given.config is None):
        raise UsageError("give a scene or --config, and not both")
    if given.config:
        with waiting("predicting the cost of every point"):
            lines = of_configs("advise")(given.config)
        print_lines(lines)
        return
    from gaspart.accuracy.advice import advise, is_tabulated

    scene = Scene.from_file(given.scene)
    if is_tabulated(scene, given.observable):
        with waiting("measuring the speed of this machine; the first time, compiling kernels"):
            load_numba(ours=True)
            advice = advise(scene, given.observable, given.accuracy, given.budget)
        print_lines(_lines(advice, given.scene))
        return
    from gaspart.accuracy.plan import plan

    def announce(text: str) -> None:
        if sys.stderr.isatty():
            print(f"gaspart: {visible(text)}", file=sys.stderr)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of coarse settings, whose error is stated in the table
        made = plan(scene, given.observable, given.accuracy, given.budget, given.pilot, announce)
    print_lines(_plan_lines(made, given.scene))


def _lines(advice: Advice, file: str) -> list[str]:
    """The advice as text. file: of the scene, for the command."""
    from gaspart.accuracy.advice import EQUILIBRATION

    best, gas = advice.setting, advice.gas
    length = f"{advice.collisions_per_particle:.3g} collisions per particle, duration {advice.duration:.4g}"
    lines = [
        f"engine            {_name(best)}",
        f"boxes             {_boxes(best)}",
        *_steps(advice.scene, best.engine, advice.observable),
        f"particles         {gas.count}{_bulk(advice)}",
        f"replicas          {advice.replicas}",
        f"run length        {length}, in each replica; {EQUILIBRATION:g} collisions of equilibration",
        f"predicted cost    {best.seconds:.3g} s of processor time",
        f"95 % half-width   {best.half_width:.2g} of {advice.observable} (bias: at most {best.bias:.1g})",
    ]
    if OBSERVABLES[advice.observable].power:
        lines += _drawn(advice.observable, advice.scatter, True, False)
    lines.append(_pays(advice.scene, best.engine, advice.observable))
    if not advice.within_budget:
        lines.append(f"the budget does not suffice for {advice.accuracy:g}")
    each = "" if advice.replicas == 1 else ", and the same with other seeds and files"
    lines.append(f"command           {_command(advice.recipe, file)}{each}")
    for other in advice.others:
        lines.append(f"why: {_name(other)} takes {other.seconds:.3g} s")
    if "step" not in {other.name for other in (best, *advice.others)}:
        lines.append("why: no time step is known to be as accurate at this density")
    return lines


def _rarely_visited(plan: Plan) -> list[str]:
    """What part of a curve the accuracy is of."""
    known, places = plan.places
    if known == places:
        return []
    text = (
        f"{known} of {places}, to which particles come in every part of the pilot: the accuracy is of these"
    )
    return [f"places            {text}"]


def _drawn(observable: str, scatter: float, velocities: bool, places: bool) -> list[str]:
    """What differences of the energy at the start add to the error, of drawn velocities and places."""
    if not scatter:
        return []
    lines = [f"energy at start   {scatter:.2g} of {observable} from run to run, beyond this"]
    if velocities:
        lines.append("                  velocities are drawn: exact_temperature: true removes their part")
    if places:
        lines.append(
            "                  heights are random: the mean of runs with several seeds, or of runs from "
            "one state (--from), which have one energy"
        )
    return lines


def _differences(plan: Plan) -> list[str]:
    """Pilots that do not agree within their bounds, of which the exact one is believed."""
    lines = []
    for one in plan.differing:
        exact = plan.pilots[0]
        values = f"{one.value:.4g} against {exact.value:.4g} by the event-driven engine"
        lines.append(f"pilots differ     {one.engine.title}: {values}, more than its bound and their noise")
    return lines


def _pays(scene: Scene, engine: Engine, observable: str) -> str:
    """What a run pays for beside the collisions of a plain gas."""
    from gaspart.accuracy.price import price_of

    price = price_of(scene, engine, observable)
    measured = ", ".join(f"{name} {ratio:.2f}" for name, ratio in price.ratios.items())
    parts = [f"{measured} times the time per event"] if measured else []
    parts += [f"not measured: {', '.join(price.unknown)}"] if price.unknown else []
    parts += [f"float32 takes {price.single:.2f} of the time of float64"] if price.single else []
    return f"pays for          {'; '.join(parts) or 'its collisions alone'}"


def _command(recipe: Recipe, file: str) -> str:
    """The command that makes a run."""
    return shlex.join(["gaspart", "run", file, *run_options(Path("run.nc"), recipe)])


def _plan_lines(plan: Plan, file: str) -> list[str]:
    """The advice of pilot runs as text. file: of the scene, for the command."""
    best = plan.best
    lines = [f"engine            {_settings(best)}"]
    if math.isfinite(best.seconds):
        recipe = plan.recipe
        lines += [
            f"command           {_command(recipe, file)}",
            f"predicted cost    {best.seconds:.3g} s of processor time, duration {best.duration:.4g}",
            f"95 % half-width   {best.half_width:.2g} of {plan.target.name} (about {plan.value:.4g}): "
            f"{_components(best)}",
        ]
        if asked := recipe.correlations:
            lags = f"{asked.interval:g} apart, up to {asked.lags * asked.interval:.4g}"
            lines.append(f"lags              {lags}, the time of about 10 collisions of a particle")
    lines += _rarely_visited(plan)
    scatter = plan.scatter
    lines += _drawn(plan.target.name, scatter.value, scatter.drawn, scatter.placed)
    lines.append(_pays(plan.target.scene, best.candidate.engine, plan.target.observable))
    if not plan.affordable:
        lines.append(_shortfall(plan))
    for pilot in plan.pilots:
        cost = f"{pilot.seconds:.2g} s" if pilot.seconds else "kept from before"
        shown = f"{pilot.value:.4g} to {100.0 * pilot.accuracy:.2g} %" if pilot.measured else pilot.rule
        lines.append(f"pilot             {pilot.engine.title}, {cost}: {shown}")
    lines += _differences(plan)
    for other in plan.options[1:]:
        cost = f"{other.seconds:.3g} s" if math.isfinite(other.seconds) else "not as accurate"
        without = f"gives up {other.candidate.gives_up}"
        lines.append(f"why not           {_settings(other)}: {cost}; {_components(other)}; {without}")
    lines += [f"why not           {name}: {rule}" for name, rule in plan.refused.items()]
    return lines


def _components(option: Option) -> str:
    """What makes the error of an option."""
    noise = option.half_width - option.bias
    of = option.candidate
    parts = {"noise": noise, "model": of.model, "steps and cells": of.discretisation}
    parts["difference of the pilots"] = option.bias if option.bias > of.bias else 0.0
    shown = [
        f"{name} {f'{value:.1g}' if value < 1.0 else 'above 1'}"
        for name, value in parts.items()
        if 0.0 < value < math.inf
    ]
    return ", ".join(shown) or "no systematic error"


def _settings(option: Option) -> str:
    """An engine with its settings, as options."""
    engine = option.candidate.engine
    changed = {
        item.name: getattr(engine, item.name)
        for item in fields(engine)
        if getattr(engine, item.name) != item.default
    }
    return " ".join([engine.name, *stated(changed)])


def _shortfall(plan: Plan) -> str:
    """What would reach an accuracy that the budget does not, or that no engine does."""
    costs = {
        one.seconds * ((one.half_width - one.bias) / (plan.accuracy - one.bias)) ** 2: one
        for one in plan.options
        if one.bias < plan.accuracy
    }
    if not costs:
        return f"no engine is known to be as accurate as {plan.accuracy:g}"
    least = min(costs)
    engine = costs[least].candidate.engine.title
    return f"the budget does not suffice for {plan.accuracy:g}, which takes {least:.3g} s, {engine} engine"


def _name(setting: Setting) -> str:
    engine = setting.engine
    if isinstance(engine, DSMC):
        return f"dsmc, model {engine.model}, time_step {engine.time_step:.4g}"
    if not isinstance(engine, TimeStepped):
        return f"{engine.name}, float64"
    return f"step, time_step {engine.time_step:.4g}, {engine.precision}, {engine.passes} passes"


def _boxes(setting: Setting) -> str:
    """How an engine finds pairs."""
    if setting.engine.name == "event":
        return "automatic, about one per particle"
    if isinstance(setting.engine, DSMC):
        return "cells, whose particles collide by chance: positions of pairs are given up"
    return "none: a neighbour list"


def _steps(scene: Scene, engine: Engine, observable: str) -> list[str]:
    """What steps do that are longer than those of the DSMC engine, of which the run warns."""
    if not isinstance(engine, DSMC):
        return []
    own = replace(engine, time_step=None).resolved(scene).time_step
    if not own or not engine.time_step or engine.time_step < 1.5 * own:
        return []
    effect = "which the bias includes" if observable == "D" else f"on which {observable} does not depend"
    return [f"time step         {engine.time_step / own:.2g} times the engine's own, {effect}"]


def _bulk(advice: Advice) -> str:
    """The effect of the finite size."""
    if not math.isfinite(advice.finite_size):
        return ""
    text = f"; {advice.observable} differs by {100.0 * advice.finite_size:+.2g} % from an infinite gas"
    if advice.bulk_count > advice.gas.count:
        text += f": correct for it, or take {advice.bulk_count:.2g}"
    return text
