# What the rules share: the checked config, the points of its grids, and which modules each stage is made of.

import hashlib
import os
import shlex
import sys
from functools import cache
from pathlib import Path

ROOT = Path(workflow.basedir)
sys.path.insert(0, str(ROOT / "src"))
# Snakemake writes its interpreter's path into shell commands without quotes: with a space in it, no job would start.
if " " in sys.executable:
    sys.executable = shlex.quote(sys.executable)

from gaspart import grid
from gaspart.config import check
from gaspart.errors import SceneError
from gaspart.families import FAMILIES, TITLES
from gaspart.variants import task, variant

# A job on a cluster reads this file again, but need not judge ten thousand points again.
if workflow.is_main_process:
    try:
        files = ["config/config.yaml", *workflow.overwrite_configfiles]
        check(config, [str(name) for name in files if os.path.exists(name)])
        for kept in ("results", ".snakemake"):
            folder = kept if os.path.exists(kept) else "."
            if not os.access(folder, os.W_OK):
                told = f"this user may not write to it, where the workflow keeps {kept}"
                raise SceneError("folder", os.path.abspath(folder), told)
    except SceneError as error:
        # A user's mistake: one line and exit code 2, instead of a WorkflowError with its place in this file.
        print(f"gaspart: {error}", file=sys.stderr)
        sys.exit(2)

FIGURES = [figure for figure in FAMILIES if figure in config["figures"]]
ANIMATIONS = [name for name, block in config.get("animations", {}).items() if block]
POINTS = {
    experiment: {point.name: point for point in grid.points(config, experiment)}
    for experiment in config["experiments"]
}


def share(paths):
    """What is this process's of them, where several share the work: GASPART_SHARE is k/n, k from 1; or all."""
    number, of = map(int, os.environ.get("GASPART_SHARE", "1/1").split("/"))
    return paths[number - 1 :: of]


def experiments(job):
    """A pattern that matches the experiments made by one kind of job, and nothing if there are none."""
    names = [name for name, block in config["experiments"].items() if block.get("job", "simulate") == job]
    return "|".join(names) or "(?!)"


def point_of(wildcards):
    return POINTS[wildcards.experiment][wildcards.point]


def recipe_of(wildcards):
    return grid.recipe(point_of(wildcards))


def figure_points(wildcards):
    return grid.figure_points(config, wildcards.figure)


def animated(wildcards):
    """The point whose film is made: the first one of the experiment."""
    return next(iter(POINTS[config["animations"][wildcards.animation]["experiment"]].values()))


def settings_of_animation(wildcards):
    block = config["animations"][wildcards.animation]
    return {key: value for key, value in block.items() if key != "experiment"}


def family(wildcards):
    return FAMILIES[wildcards.figure]


def memory_of(wildcards):
    """MB for one simulation: the interpreter, and what each body costs."""
    return 800 + grid.extents(point_of(wildcards))[0] // 1000


def caption_of(wildcards):
    return (ROOT / f"workflow/report/{wildcards.figure}.rst").read_text(encoding="utf-8")


def flagged(path, kind):
    """A figure that `snakemake --report` shows too, under its family, with its caption."""
    return report(
        path,
        caption="../report/figure.rst",
        category=lambda wildcards: TITLES[family(wildcards)],
        subcategory="{figure}",
        labels={"figure": "{figure}", "type": kind},
    )


# A digest of the modules of gaspart that each stage uses is a parameter of its rules: editing one reruns what it
# touches. As inputs they would be half a million files for ten thousand points, each of them asked after in turn.
# `{family}` stands for the family of a figure, `*` for every module of a package; FAMILY_MODULES are what single
# families use beside. tests/workflow/test_modules.py compares these tables with the import graph of the scripts.
SCENE = [
    "__init__",
    "errors",
    "files",
    "interruption",
    "matter",
    "room",
    "scene",
    "surfaces",
    "validation",
    "yaml_text",
]
ENGINES = [
    "beside",
    "boxes",
    "compression",
    "contact",
    "coordinates",
    "draws",
    "engines/*",
    "falling",
    "fetch",
    "initial",
    "insertion",
    "kernel",
    "loading",
    "memory",
    "plates",
    "random",
    "segments",
    "simulation",
    "state",
    "tally",
    "wells",
]
TRAJECTORY = ["amber", "checkpoint", "provenance", "recipe", "recording", "trajectory"]
SIMULATE = [*SCENE, *ENGINES, *TRAJECTORY]
THEORY = ["theory/*", "theory/data/*.csv"]
RENDERING = [f"rendering/{name}" for name in ("__init__", "bodies", "camera", "discs", "pictures", "tracer")]
CLAIMS = ["__init__", "errors", "files", "interruption", "claims/__init__"]
MODULES = {
    "simulate": SIMULATE,
    "measure_cost": [*SCENE, *ENGINES, "measure/__init__", "measure/cost"],
    "compare": [*SCENE, *ENGINES, "measure/__init__", "measure/compare"],
    "echo": [*SCENE, *ENGINES, "measure/__init__", "measure/echo"],
    "fill": [
        *SCENE,
        "boxes",
        "coordinates",
        "fetch",
        "insertion",
        "kernel",
        "loading",
        "memory",
        "plates",
        "random",
        "segments",
        "measure/__init__",
        "measure/fill",
    ],
    "pack": [
        *SCENE,
        *[name for name in ENGINES if name != "simulation"],
        "measure/__init__",
        "measure/fill",
        "measure/pack",
    ],
    "measure": [
        *SIMULATE,
        *THEORY,
        "grid",
        "point",
        "point_scene",
        "measure/__init__",
        "measure/{family}",
        "statistics",
    ],
    "judge": [*CLAIMS, *THEORY, "claims/{family}"],
    "claims": CLAIMS,
    "draw": [
        "__init__",
        "errors",
        "files",
        "interruption",
        *THEORY,
        "figures/__init__",
        "figures/style",
        "figures/{family}",
    ],
    "animate": [*SIMULATE, "figures/__init__", "figures/style", *RENDERING, "rendering/films"],
    "report": ["__init__", "errors", "families", "files", "interruption", "provenance"],
}
FAMILY_MODULES = {
    ("measure", "extremes"): ["extremes/*"],
    ("measure", "gravity"): ["measure/columns"],
    ("measure", "buoyancy"): ["measure/columns"],
    ("judge", "adsorption"): ["statistics"],
    ("judge", "buoyancy"): ["statistics"],
    ("measure", "radius"): ["measure/pressure"],
    ("measure", "displacement"): ["measure/correlations"],
    ("measure", "velocity"): ["measure/correlations"],
    ("measure", "virial"): ["measure/pressure"],
    ("measure", "freezing"): ["measure/plateau", "measure/pressure", "measure/structure"],
    ("measure", "scaling"): ["measure/timings"],
    ("measure", "price"): ["measure/stripped", "measure/timings"],
    ("measure", "brownian"): ["measure/correlations"],
    ("measure", "tradeoff"): [
        "measure/accuracy",
        "measure/pressure",
        "measure/timings",
        "tradeoff/__init__",
        "tradeoff/table",
        "tradeoff/data/*.csv",
    ],
    ("judge", "displacement"): ["statistics"],
    ("draw", "price"): ["claims/__init__", "claims/price"],
    ("draw", "reversibility"): ["claims/__init__", "claims/reversibility"],
    ("judge", "radius"): ["statistics"],
    ("judge", "virial"): ["statistics"],
    ("judge", "wall_pressure"): ["statistics"],
    ("draw", "pictures"): [
        "kernel",
        "loading",
        *RENDERING,
        "state",
        "validation",
        "yaml_text",
    ],
    ("draw", "packing"): [
        "kernel",
        "loading",
        "rendering/__init__",
        "rendering/bodies",
        "rendering/camera",
        "rendering/discs",
        "rendering/pictures",
        "rendering/tracer",
        "state",
        "validation",
        "yaml_text",
    ],
}


def module_files(stage, family=None):
    """Paths of the modules of a stage, and of a family there."""
    names = [name.format(family=family) for name in MODULES[stage] + FAMILY_MODULES.get((stage, family), [])]
    patterns = [name if name.endswith(".csv") else f"{name}.py" for name in names]
    source = ROOT / "src/gaspart"
    return [path for pattern in patterns for path in sorted(source.glob(pattern)) or [source / pattern]]


def digest_of(paths):
    return hashlib.sha256(b"".join(content(path) for path in paths)).hexdigest()[:12]


@cache
def content(path):
    return path.read_bytes()


@cache
def modules(stage, family=None):
    """A digest of the modules of a stage, and of a family there."""
    return digest_of(module_files(stage, family))


def modules_of(stage):
    """The same where the figure is a wildcard."""
    return lambda wildcards: modules(stage, family(wildcards))


# The modules among them whose code is compiled.
KERNELS = [
    "contact",
    "coordinates",
    "draws",
    "engines/*",
    "falling",
    "fetch",
    "insertion",
    "kernel",
    "plates",
    "segments",
]


@cache
def digest(job):
    """A digest of the compiled modules that a job uses."""
    names = [name for name in KERNELS if name in MODULES[job]]
    return digest_of(path for name in names for path in sorted((ROOT / "src/gaspart").glob(f"{name}.py")))


@cache
def variant_of(experiment, point):
    return variant(POINTS[experiment][point])


def stamp_of(wildcards):
    point = point_of(wildcards)
    return f"results/kernels/{digest(point.job)}/{variant_of(point.experiment, point.name)}.stamp"


def task_of(wildcards):
    """What compiles a variant: a tiny run of the first point that needs it."""
    of_all = (point for experiment in POINTS.values() for point in experiment.values())
    return next(
        task(point) for point in of_all if variant_of(point.experiment, point.name) == wildcards.variant
    )


wildcard_constraints:
    experiment="[a-z][a-z0-9_]*",
    point="[^/]+",
    figure="|".join(FIGURES),
    animation="|".join(ANIMATIONS) or "(?!)",
    digest="[0-9a-f]+",
    variant="[^/]+",
