"""Instructions that an absent feature leaves in the machine code of a kernel.

Absent optional physics is passed to kernels as None, and numba removes its branches. This job also removes
the branches from the source of the kernels, in a copy of the package. The instructions of both kernels are
counted.
"""

from __future__ import annotations

import ast
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaspart.interruption import scratch_folder
from gaspart.keys import Kind
from gaspart.reproduction.jobs.data import PointData

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point
    from gaspart.scene.scene import Scene

RESULT = "the machine code of both engines for the scene, with and without the source of absent features"
KEYS: dict[str, Kind] = {}
FEATURES = {
    "accommodation", "collapse", "duration", "faces", "fixed", "gravity", "impulses", "law",
    "masses", "motion", "moving", "opened", "oversized", "pace", "pairs", "per_area", "piston",
    "present", "ramp", "record", "reservoirs", "row", "rules", "shear", "sliding", "sticky", "stress",
    "support", "velocity", "vibrations", "viscous", "walls", "warm",
}  # fmt: skip
"""Arguments of the kernels that are None for a plain gas."""
COUNTED_ENGINES = ("event", "step")
_PACKAGE = Path(__file__).parents[2]


class Strip(ast.NodeTransformer):
    """Transformer of a syntax tree that removes the branches of absent features. Every comparison of such a
    feature with None is resolved. Code after a return is removed.
    """

    def _evaluate(self, test: ast.expr) -> bool | None:
        match test:
            case ast.Compare(ast.Name(name), [ast.Is() | ast.IsNot() as is_or_not], [ast.Constant(None)]):
                return isinstance(is_or_not, ast.Is) if name in FEATURES else None
        return None

    def visit_If(self, node: ast.If) -> ast.stmt | list[ast.stmt]:
        """Replace an if statement by the branch that is executed."""
        self.generic_visit(node)
        value = self._evaluate(node.test)
        if value is None:
            return node
        return (node.body if value else node.orelse) or ast.Pass()

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.stmt:
        """Remove the statements after a return that has become unconditional."""
        self.generic_visit(node)
        returns = [k for k, statement in enumerate(node.body) if isinstance(statement, ast.Return)]
        if returns:
            del node.body[returns[0] + 1 :]
        return node

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        """Replace a conditional expression by the value that is used."""
        self.generic_visit(node)
        value = self._evaluate(node.test)
        return node if value is None else node.body if value else node.orelse


def strip_features(source: str) -> str:
    """Return the source of a module without the branches of absent features."""
    return ast.unparse(ast.fix_missing_locations(Strip().visit(ast.parse(source))))


def engines(point: Point) -> list[Engine]:
    """Return the event-driven engine; the kernel of the other engine is compiled in the job."""
    return [point.engine]


def arguments(point: Point) -> dict:
    """Return the argument of `count_instructions`."""
    return {"scene": point.scene}


def count_instructions(scene: Scene) -> PointData:
    """Count the instructions of each engine's main kernel for a scene. The scene should be a plain gas.
    Returns over engine: `instructions`, and `stripped`, the instructions without the branches of absent
    features. Both are compiled in separate processes with separate caches.
    """
    counts = []
    with scratch_folder() as folder:
        for strip in (False, True):
            package = folder / str(strip) / "gaspart"
            shutil.copytree(_PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
            if strip:
                for module in package.joinpath("kernels").rglob("*.py"):
                    module.write_text(strip_features(module.read_text(encoding="utf-8")), encoding="utf-8")
            environment = {"PYTHONPATH": str(package.parent), "GASPART_CACHE": str(package.parent / "cache")}
            done = subprocess.run(
                [sys.executable, "-P", "-m", __name__, json.dumps(scene.to_dict())],
                env={**os.environ, **environment},
                capture_output=True,
                text=True,
                check=True,
            )
            counts.append([int(line) for line in done.stdout.split()])
    complete, bare = counts
    return PointData(
        {"instructions": ("engine", complete), "stripped": ("engine", bare)},
        {"engine": ("engine", list(COUNTED_ENGINES))},
    )


def count(scene: dict) -> None:
    """Print the number of instructions of each engine's main kernel for a scene."""
    import gaspart as gp
    from gaspart.kernels.event import loop as event_loop
    from gaspart.kernels.step import box_search as step_loop

    kernels: dict[Any, Any] = {
        gp.EventDriven(): event_loop.run,
        gp.TimeStepped(0.01): step_loop.run_steps,
    }
    for engine, kernel in kernels.items():
        gp.Simulation(gp.Scene.from_dict(scene), engine).advance(duration=0.1)
        (code,) = kernel.inspect_asm().values()
        lines = [line.strip() for line in code.splitlines() if line.startswith("\t")]
        print(sum(not line.startswith((".", "#")) for line in lines))


if __name__ == "__main__":
    count(json.loads(sys.argv[1]))
