# Shared by the rules: the validated config, the points of its grids, and the modules of each stage.

import gc
import os
import shlex
import shutil
import sys
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

# Planning makes a million objects, nearly all of which stay: looking for cycles among them takes a tenth of its time.
gc.set_threshold(100_000)


def checked_out(source):
    """The folder with the files of a commit: Snakemake reads a module from a repository file by file."""
    from git import Repo

    repository = source.hosted_repo.repo if hasattr(source, "hosted_repo") else Repo(source.repo_path)
    commit = repository.commit(source.ref)
    folder = Path(".snakemake/gaspart", commit.hexsha).resolve()
    if not folder.exists():
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent) as partial:
            repository.git.archive(commit.hexsha, "src", "workflow", output=f"{partial}/files.tar")
            shutil.unpack_archive(f"{partial}/files.tar", f"{partial}/files", filter="data")
            with suppress(OSError):  # another process was faster
                os.rename(f"{partial}/files", folder)
    return folder


# Where the workflow is, absolute, and from the working directory: another one where it is used as a module.
HERE = workflow.current_basedir
ROOT = checked_out(HERE) if hasattr(HERE, "ref") else Path(str(HERE.path)).resolve().parents[1]
RULES = ROOT / "workflow/rules"
FOLDER = Path(os.path.relpath(ROOT))
SCRIPTS = ROOT / "workflow/scripts"
sys.path.insert(0, str(ROOT / "src"))
# Snakemake writes its interpreter's path into shell commands without quotes: with a space in it, no job would start.
if " " in sys.executable:
    sys.executable = shlex.quote(sys.executable)

from gaspart.reproduction import job_server
from gaspart.reproduction.claims.table import fill_caption
from gaspart.reproduction.claims.table import summary
from gaspart.reproduction.config import EFFORTS, FAMILIES, add_families, check, explain_error, is_own
from gaspart.reproduction.config import keep_efforts, read_numbers, remove_null, write_efforts
from gaspart.reproduction import registry
from gaspart.reproduction.registry import caption, find, of_claims
from gaspart.reproduction.points.modules import digest, measuring_digest, point_sources, stage_sources, stamp
from gaspart.reproduction.points.point import TRAJECTORIES
from gaspart.reproduction.points.points import all_points, effort_of
from gaspart.reproduction.points.points import figure_points as points_of_figure
from gaspart.reproduction.points.point import compile_task
from gaspart.errors import SceneError


def folder_of_points():
    return Path(workflow.modifier.modify_path(str(config.get("points"))))


# A job on a cluster reads this file again, but need not validate ten thousand points again.
files = ["config/config.yaml", *workflow.overwrite_configfiles]
files = [str(name) for name in files if os.path.exists(name)]
FOLDER_OF_FAMILIES = Path(*files[:1] or ["config/config.yaml"]).parent / FAMILIES
if workflow.is_main_process:
    try:
        files = [*add_families(config, FOLDER_OF_FAMILIES), *files]
        read_numbers(config, files)
        if kept := keep_efforts(config, folder_of_points()):
            text = f"{len(kept)} experiments keep the larger effort with which they were made"
            print(f"{folder_of_points() / EFFORTS}: {text}; delete this file for less", file=sys.stderr)
        POINTS = check(config, files)
        for kept in (workflow.modifier.modify_path("results"), ".snakemake"):
            folder = next(path for path in (kept, *Path(kept).parents) if os.path.exists(path))
            if not os.access(folder, os.W_OK):
                problem = f"this user may not write to it, where the workflow keeps {kept}"
                raise SceneError("folder", os.path.abspath(folder), problem)
    except SceneError as error:
        # A user's mistake: one line and exit code 2, instead of a WorkflowError with its place in this file.
        used = Path(str(workflow.main_snakefile)).resolve() != ROOT / "workflow/Snakefile"
        print(f"gaspart: {explain_error(error, config, used)}", file=sys.stderr)
        sys.exit(2)
else:
    files = [*add_families(config, FOLDER_OF_FAMILIES), *files]
    remove_null(config)
    read_numbers(config, files)
    keep_efforts(config, folder_of_points())
    POINTS = all_points(config)

# A small run, such as the smoke run, is at no effort: its lengths are others.
EFFORTS_OF_RUNS = sorted(
    {effort_of(config, name) for name in config["experiments"]} if "sizes" not in config else ()
)
FIGURES = {name: find(name, block)[0] for name, block in config["figures"].items()}  # family of each
FIRST = [name for name in ("virial_discs", "speed_relaxation", "speed_distribution_discs") if name in FIGURES]
OWN_CAPTIONS = {name: caption(block) for name, block in config["figures"].items() if is_own(block)}
# Where figures, claims, tables, logs and the report of this run lie.
RESULTS = f"results/{config['run']}" if config.get("run") else "results"


pathvars:
    results=RESULTS,


ANIMATIONS = list(config.get("animations", {}))
FILMS = {name: config["animations"][name].get("figure", "") for name in ANIMATIONS}  # beside which figure


def of_project(name):
    """A file of this project, as an input: the prefix of a module is that of its results alone."""
    return local(str(FOLDER / name))


def share(paths):
    """The part of this process where several share the work (GASPART_SHARE is k/n, k from 1); else all."""
    number, of = map(int, os.environ.get("GASPART_SHARE", "1/1").split("/"))
    return paths[number - 1 :: of]


def pattern(trajectories):
    """A pattern that matches the experiments that make trajectories, or the others; nothing if there are none."""
    jobs = {name: block.get("job", "simulate") for name, block in config["experiments"].items()}
    return "|".join(name for name, job in jobs.items() if (job == TRAJECTORIES) == trajectories) or "(?!)"


def point_of(wildcards):
    return POINTS[wildcards.experiment][wildcards.point]


def parameters_of(wildcards):
    return point_of(wildcards).parameters


def figure_points(wildcards):
    return points_of_figure(config, wildcards.figure, POINTS)


def animated(wildcards):
    """The point whose film is made: the first one of the experiment."""
    return next(iter(POINTS[config["animations"][wildcards.animation]["experiment"]].values()))


def settings_of_animation(wildcards):
    block = config["animations"][wildcards.animation]
    return {key: value for key, value in block.items() if key not in ("experiment", "figure")}


def family(wildcards):
    return FIGURES[wildcards.figure]


def function_of(wildcards):
    return find(wildcards.figure, config["figures"][wildcards.figure])[1]


def settings_of(wildcards):
    """What the measurement of a figure depends on, without what its other stages read."""
    block = config["figures"][wildcards.figure]
    return {key: value for key, value in block.items() if key not in ("claims", "caption", "module")}


def stated_of(wildcards):
    return registry.stated_claims(config["figures"][wildcards.figure])


def other_claims(wildcards):
    """The claims tables of all other figures, for the figure that is made of them; none for others."""
    if wildcards.figure not in of_claims():
        return []
    return [f"{RESULTS}/claims/{figure}.csv" for figure in FIGURES if figure not in of_claims()]


def cores_of(wildcards):
    return (workflow.resource_settings.cores or 1) if point_of(wildcards).job == "measure_cost" else 1


def memory_of(wildcards):
    """MB for one simulation: the interpreter, the memory of each particle, and that of correlated samples."""
    point = point_of(wildcards)
    count, _, lengths = point.extents
    vectors = point.settings.get("lags", 0) * (2 if point.settings.get("displacements") else 1)
    return 800 + count // 1000 + count * len(lengths) * vectors * 8 // 10**6


def runtime_of(wildcards, attempt):
    """Minutes for one point on a cluster: five times the predicted time, more at each attempt."""
    from gaspart.reproduction.cost import predicted_seconds

    seconds = None if workflow.local_exec else predicted_seconds(point_of(wildcards))
    return attempt * (120 if seconds is None else max(10, round(5.0 * seconds / 60.0)))


def caption_of(wildcards):
    """The caption as it is known before anything is measured."""
    text = OWN_CAPTIONS.get(wildcards.figure)
    if text is None:
        text = (ROOT / f"workflow/report/{wildcards.figure}.rst").read_text(encoding="utf-8")
    return fill_caption(text, [], "(see the claims)")


def flagged(path, kind):
    """A figure that `snakemake --report` shows too, under its family, with its caption."""
    return report(
        path,
        caption="../report/figure.rst",
        category=lambda wildcards: registry.title(family(wildcards)),
        subcategory="{figure}",
        labels={"figure": "{figure}", "type": kind},
    )


# What families state about themselves, which the report reads by their names.
STATED = registry.modules()


# A digest of the modules of a job, found from its imports, is a parameter of its rule.
def sources(stage):
    return stage_sources(SCRIPTS, stage)


def sources_of(point):
    return point_sources(point, SCRIPTS)


def module_of(wildcards):
    return registry.home(family(wildcards))


def modules_of_figure(wildcards):
    """A digest of what a figure is made of."""
    return digest(*sources("figure"), module_of(wildcards))


def measuring_of(wildcards):
    """A digest of what the numbers of a figure are made of."""
    return measuring_digest(module_of(wildcards), function_of(wildcards))


@cache
def stamp_of_point(experiment, point):
    return stamp(POINTS[experiment][point], SCRIPTS)


def stamp_of(wildcards):
    return stamp_of_point(wildcards.experiment, wildcards.point)


def task_of(wildcards):
    """The task that compiles a variant: a tiny run of the first point that needs it."""
    of_all = (point for experiment in POINTS.values() for point in experiment.values())
    return next(
        compile_task(point)
        for point in of_all
        if Path(stamp_of_point(point.experiment, point.name)).stem == wildcards.variant
    )


wildcard_constraints:
    experiment="[a-z][a-z0-9_]*",
    point="[^/]+",
    figure="|".join(FIGURES) or "(?!)",
    animation="|".join(ANIMATIONS) or "(?!)",
    digest="[0-9a-f]+",
    variant="[^/]+",


def page_of(figures, claims, films):
    """The input of a page with some figures, the table of their claims and the films beside them."""
    stated = [figure for figure in figures if figure not in OWN_CAPTIONS]
    return dict(
        pictures=expand("<results>/figures/{figure}.png", figure=figures),
        vectors=expand("<results>/figures/{figure}.svg", figure=figures),
        columns=expand("<results>/figures/journal/{figure}.png", figure=figures),
        key_pictures=expand("<results>/figures/key/{figure}.png", figure=figures),
        datasets=expand("<results>/measurements/{figure}.nc", figure=figures),
        captions=[of_project(f"workflow/report/{figure}.rst") for figure in stated],
        claims=claims,
        films=expand("<results>/animations/{animation}.mp4", animation=films),
        posters=expand("<results>/animations/{animation}.jpg", animation=films),
        play="<results>/play.html" if config.get("opening") else [],
        template=of_project("workflow/report/report.html.j2"),
        style=[of_project(name) for name in ("workflow/report/page.css", "src/gaspart/rendering/style.css")],
        behaviour=[of_project(f"workflow/report/{name}") for name in ("page.js", "engines.js", "states.js")],
        findings=of_project("workflow/report/findings.yaml"),
        statements=of_project("workflow/report/sources.yaml"),
        references=of_project("workflow/report/references.yaml"),
    )
