"""`gaspart advise`: engine, settings and length of a run for a wanted accuracy, and what it costs."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING

from gaspart.cli.arguments import Commands, UsageError, real

if TYPE_CHECKING:
    from gaspart.tradeoff.advice import Advice, Setting

_EXAMPLES = """examples:
  gaspart advise scene.yaml --observable Z --accuracy 1e-3
  gaspart advise scene.yaml --observable D --accuracy 1e-2 --budget 60
  gaspart advise --config config/config.yaml     what a whole grid costs, in core-hours"""


def add_advise(commands: Commands) -> None:
    """Add the command to the others."""
    text = (
        "The cheapest way to a relative accuracy (half the width of a 95 % interval) of an observable of a "
        "gas of one species, from errors and times that were measured; or, with --config, what the "
        "simulations of a config cost. A run of a tenth of a second finds out how fast this machine is."
    )
    advise = commands.add_parser(
        "advise", help="choose engine and settings", description=text, epilog=_EXAMPLES
    )
    advise.set_defaults(command=_advise)
    add = advise.add_argument
    add("scene", nargs="?", help="scene file (YAML)")
    add("--observable", default="Z", metavar="NAME", help="Z (default), collision_rate or D")
    add("--accuracy", type=real(above=0.0), default=1e-2, metavar="X", help="relative, default 0.01")
    add("--budget", type=_seconds, metavar="S", help="processor time that may be spent, in s (60 or 60s)")
    add("--config", metavar="FILE", help="a config instead of a scene")


def _seconds(text: str) -> float:
    return real(above=0.0)(text.removesuffix("s"))


def _advise(given: argparse.Namespace) -> None:
    if (given.scene is None) == (given.config is None):
        raise UsageError("give a scene or --config, one of them")
    if given.config:
        from gaspart.tradeoff.grids import predict

        print("\n".join(predict(given.config)))
        return
    from gaspart.scene import Scene
    from gaspart.tradeoff.advice import advise

    found = advise(Scene.from_file(given.scene), given.observable, given.accuracy, given.budget)
    print("\n".join(_told(found)))


def _told(advice: Advice) -> list[str]:
    """The advice in words."""
    from gaspart.tradeoff.advice import SETTLING

    best, gas = advice.setting, advice.gas
    length = f"{advice.collisions_per_body:.3g} collisions per body, duration {advice.duration:.4g}"
    boxes = "its own choice, about one a body" if best.engine.name == "event" else "none: a neighbour list"
    lines = [
        f"engine            {_name(best)}",
        f"boxes             {boxes}",
        f"bodies            {gas.count}{_bulk(advice)}",
        f"replicas          {advice.replicas}",
        f"run length        {length}, in each replica; {SETTLING:g} collisions before",
        f"predicted cost    {best.seconds:.3g} s of processor time",
        f"95 % half-width   {best.half_width:.2g} of {advice.observable} (steps: at most {best.bias:.1g})",
    ]
    if not advice.within_budget:
        lines.append(f"the budget does not suffice for {advice.accuracy:g}")
    for other in advice.others:
        lines.append(f"why: {_name(other)} would take {other.seconds:.3g} s")
    if len({other.engine.name for other in advice.others} | {best.engine.name}) == 1:
        lines.append("why: no time step is known to be as accurate at this density")
    return lines


def _name(setting: Setting) -> str:
    engine = setting.engine
    if engine.name == "event":
        return "event, float64"
    return f"step, time_step {engine.time_step:.4g}, {engine.precision}, {engine.passes} passes"


def _bulk(advice: Advice) -> str:
    """What the finite size does."""
    if not math.isfinite(advice.finite_size):
        return ""
    text = f"; {advice.observable} is {100.0 * advice.finite_size:+.2g} % off the infinite gas (periodic)"
    if advice.bulk_count > advice.gas.count:
        text += f": correct for it, or take {advice.bulk_count:.2g}"
    return text
