"""`gaspart advise`: engine, settings and length of a run for a required accuracy, and its cost."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING

from gaspart.cli.arguments import Parser, UsageError, of_configs, print_line, real, set_command
from gaspart.cli.progress import waiting
from gaspart.engines import TimeStepped
from gaspart.scene.scene import Scene

if TYPE_CHECKING:
    from gaspart.tradeoff.advice import Advice, Setting

_EXAMPLES = """examples:
  gaspart advise scene.yaml --observable Z --accuracy 1e-3
  gaspart advise scene.yaml --observable D --accuracy 1e-2 --budget 60
  gaspart advise --config config/config.yaml     the cost of a complete grid, in core-hours"""


def add_advise(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "The cheapest setting for a relative accuracy (half the width of a 95 % interval) of an observable "
        "of a gas of one species in a periodic container, from measured errors and times; or, with "
        "--config, the cost of the simulations of a config. The speed of this machine is measured by a run "
        "of a tenth of a second."
    )
    set_command(parser, _advise, text, _EXAMPLES)
    add = parser.add_argument
    add("scene", nargs="?", help="scene file (YAML)")
    add("--observable", default="Z", metavar="NAME", help="Z (default), collision_rate or D")
    add("--accuracy", type=real(above=0.0), default=1e-2, metavar="X", help="relative; default: 0.01")
    add("--budget", type=_seconds, metavar="S", help="largest processor time, in s (60 or 60s)")
    add("--config", metavar="FILE", help="a config instead of a scene")


def _seconds(text: str) -> float:
    return real(above=0.0)(text.removesuffix("s"))


def _advise(given: argparse.Namespace) -> None:
    if (given.scene is None) == (given.config is None):
        raise UsageError("give a scene or --config, and not both")
    if given.config:
        with waiting("predicting the cost of every point"):
            lines = of_configs("advise")(given.config)
        print_line("\n".join(lines))
        return
    from gaspart.tradeoff.advice import advise

    scene = Scene.from_file(given.scene)
    with waiting("measuring the speed of this machine; the first time, compiling kernels"):
        found = advise(scene, given.observable, given.accuracy, given.budget)
    print_line("\n".join(_lines(found)))


def _lines(advice: Advice) -> list[str]:
    """The advice as text."""
    from gaspart.tradeoff.advice import EQUILIBRATION

    best, gas = advice.setting, advice.gas
    length = f"{advice.collisions_per_body:.3g} collisions per particle, duration {advice.duration:.4g}"
    boxes = "automatic, about one per particle" if best.engine.name == "event" else "none: a neighbour list"
    lines = [
        f"engine            {_name(best)}",
        f"boxes             {boxes}",
        f"particles         {gas.count}{_bulk(advice)}",
        f"replicas          {advice.replicas}",
        f"run length        {length}, in each replica; {EQUILIBRATION:g} collisions of equilibration",
        f"predicted cost    {best.seconds:.3g} s of processor time",
        f"95 % half-width   {best.half_width:.2g} of {advice.observable} (steps: at most {best.bias:.1g})",
    ]
    if advice.observable in ("D", "collision_rate") and advice.scatter:
        text = f"{advice.scatter:.2g} of {advice.observable} from run to run, beyond this"
        lines.append(f"drawn velocities  {text}: exact_temperature: true removes it")
    if not advice.within_budget:
        lines.append(f"the budget does not suffice for {advice.accuracy:g}")
    for other in advice.others:
        lines.append(f"why: {_name(other)} takes {other.seconds:.3g} s")
    if len({other.engine.name for other in advice.others} | {best.engine.name}) == 1:
        lines.append("why: no time step is known to be as accurate at this density")
    return lines


def _name(setting: Setting) -> str:
    engine = setting.engine
    if not isinstance(engine, TimeStepped):
        return f"{engine.name}, float64"
    return f"step, time_step {engine.time_step:.4g}, {engine.precision}, {engine.passes} passes"


def _bulk(advice: Advice) -> str:
    """The effect of the finite size."""
    if not math.isfinite(advice.finite_size):
        return ""
    text = f"; {advice.observable} differs by {100.0 * advice.finite_size:+.2g} % from an infinite gas"
    if advice.bulk_count > advice.gas.count:
        text += f": correct for it, or take {advice.bulk_count:.2g}"
    return text
