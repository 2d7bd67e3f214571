"""The pages of the site that follow from the code, written into docs/generated: a Sphinx extension.

The public names, the commands, the gallery of scenes, the referees, the symmetries, the exact values, and a
page for each family of figures, with its captions and, if the workflow has run, its figures and claims.
"""

import argparse
import csv
import importlib
import inspect
import shutil
from dataclasses import fields, is_dataclass
from pathlib import Path

import exact_values
import indexes
import symmetries
from reference import pages as reference

import gaspart
from gaspart import analysis, theory
from gaspart.cli import commands
from gaspart.cli.arguments import WIDTH
from gaspart.cli.new import templates
from gaspart.public import read_stub
from gaspart.reproduction.claims.table import fill_caption, read
from gaspart.reproduction.registry import families, home, titles
from gaspart.yaml_text import read_yaml

ROOT = Path(__file__).parents[1]
GROUPS = {
    "scenes": ("Scenes", ("scene",)),
    "simulations": ("Simulations", ("engines", "simulation", "state", "errors")),
    "trajectories": ("Trajectories", ("trajectory", "inspection", "accuracy", "runs", "reproduction")),
    "analysis": ("Analysis", ("analysis",)),
    "rendering": ("Pictures and films", ("rendering",)),
}
"""Pages of public names: name of the page -> title, packages."""


def heading(text, mark="="):
    """A heading of reStructuredText."""
    return f"{text}\n{mark * len(text)}\n\n"


def indented(text, by="   "):
    """Every line of a text after some blanks."""
    return "".join(f"{by}{line}".rstrip() + "\n" for line in text.splitlines())


def entry(name):
    """The directive for a public name."""
    thing = getattr(importlib.import_module(name.rpartition(".")[0]), name.rpartition(".")[2])
    if inspect.isclass(thing):
        return f".. autoclass:: {name}\n\n"
    if callable(thing):
        return f".. autofunction:: {name}\n\n"
    return f".. py:data:: {name}\n   :value: {thing!r}\n\n"


def public_names():
    """Page -> title, and the public names on it by section; the first section has no title."""
    groups, homes = {}, read_stub(f"{gaspart.__file__}i")
    for page, (title, packages) in GROUPS.items():
        names = [name for name, home in homes.items() if f"{home}.".split(".")[1] in packages]
        groups[page] = title, {"": [f"gaspart.{name}" for name in sorted(names)]}
    title, sections = groups["analysis"]
    observables = [f"gaspart.analysis.{name}" for name in sorted(analysis.__all__)]
    groups["analysis"] = title, {"": observables, "Collisions": sections[""]}
    return {**groups, "theory": ("Theory", theory_names())}


def theory_names():
    """The names of gaspart.theory, in sections by the module that defines them."""
    sections = {}
    for name in sorted(theory.__all__, key=str.lower):
        home = inspect.getmodule(getattr(theory, name))
        module = home.__name__.rpartition(".")[2] if home else "constants"
        sections.setdefault(module, []).append(f"gaspart.theory.{name}")
    return {module.replace("_", " ").capitalize(): names for module, names in sorted(sections.items())}


def api():
    """Pages of the public names, and their index: path -> text."""
    groups = public_names()
    about = {"analysis": inspect.getdoc(analysis), "theory": inspect.getdoc(theory)}
    pages = {"api/index.rst": indexes.interface(groups)}
    for page, (title, sections) in groups.items():
        text = heading(title) + (f"{about[page]}\n\n" if page in about else "")
        for section, names in sections.items():
            text += (heading(section, "-") if section else "") + "".join(map(entry, names))
        pages[f"api/{page}.rst"] = text
    return pages


def command_line():
    """The page of the commands: the help of each."""
    text = heading("Command line")
    text += "What each command prints with ``--help``.\n\n"
    for name, parser in commands().items():
        text += f".. _command-{name}:\n\n" + heading(f"gaspart {name}", "-")
        text += f".. code-block:: text\n\n{indented(helped(parser))}\n"
    return {"command-line.rst": text}


def helped(parser):
    """The help of a command, as a terminal of 80 columns shows it."""
    parser.formatter_class = lambda prog: argparse.RawDescriptionHelpFormatter(prog, width=WIDTH)
    return parser.format_help()


def gallery(folder):
    """The page of the templates, whose pictures are copied."""
    text = heading("Scenes of the gallery")
    text += "``gaspart new NAME.yaml --template NAME`` writes a scene file; the command below it runs it.\n\n"
    for name, template in templates().items():
        picture = ROOT / f"docs/scenes/{name}.png"
        shutil.copyfile(picture, folder / picture.name)
        scene = "".join(line for line in template.text.splitlines(True) if not line.startswith("#"))
        text += f".. _scene-{name}:\n\n" + heading(template.title, "-")
        text += f".. image:: {picture.name}\n   :alt: {template.title}\n   :width: 420\n\n"
        text += f"{template.description}\n\n"
        if template.figure:
            text += f"Measured in the figure :ref:`{template.figure} <figure-{template.figure}>`.\n\n"
        text += f".. code-block:: yaml\n   :caption: {name}.yaml\n\n{indented(scene)}\n"
        first = f"gaspart new {name}.yaml --template {name}"
        film = f"gaspart render {name}.nc -o {name}.mp4"
        text += f".. code-block:: sh\n\n{indented(chr(10).join((first, template.command, film)))}\n"
    return {"gallery.rst": text}


def figures(folder):
    """The pages of the families of figures; figures that the workflow has drawn are copied."""
    pages = {}
    for family, title in titles().items():
        text = heading(title)
        for figure in (name for name, its in families().items() if its == family):
            text += f".. _figure-{figure}:\n\n" + heading(figure, "-")
            drawn = ROOT / f"results/figures/{figure}.svg"
            if drawn.exists():
                shutil.copyfile(drawn, folder / f"figures/{figure}.svg")
                text += f".. image:: {figure}.svg\n   :alt: {figure}\n\n"
            caption = (ROOT / f"workflow/report/{figure}.rst").read_text(encoding="utf-8")
            text += fill_caption(caption, [], "(see the claims)") + "\n\n"
            text += claims_of(ROOT / f"results/claims/{figure}.csv")
            text += f".. code-block:: sh\n\n   snakemake --cores all results/figures/{figure}.png\n\n"
        name = home(family)
        doc = importlib.import_module(name).__doc__
        text += f".. code-block:: text\n   :caption: {name}\n\n{indented(doc.strip())}\n"
        pages[f"figures/{family}.rst"] = text
    listed = "".join(f"   {family}\n" for family in titles())
    index = indexes.figures(folder / "figures/small")
    pages["figures/index.rst"] = f"{index}.. toctree::\n   :hidden:\n\n{listed}"
    return pages


def claims_of(path):
    """A table of the claims with their verdicts; empty if the workflow has not run."""
    if not path.exists():
        return ""
    wanted = ("claim", "measured", "expected", "verdict")
    with path.open(newline="", encoding="utf-8") as file:
        rows = [wanted, *([row[key] for key in wanted] for row in csv.DictReader(file))]
    text = ".. list-table::\n   :header-rows: 1\n\n"
    for row in rows:
        cells = [cell.replace("\\", "\\\\").replace("*", "\\*").replace("|", "\\|") for cell in row]
        text += f"   * - {cells[0]}\n" + "".join(f"     - {cell}\n" for cell in cells[1:])
    return text + "\n"


REFEREES = """\
Runs of gaspart are judged by programs that others have written. gaspart writes the files; the referees
read them in an environment of their own, where gaspart is not installed. ``make referees`` makes the
runs, anew and with fixed seeds, and renews the table of this page, ``docs/referees.csv``; a job of the
repository repeats it every week. Each referee also judges a copy of the files with an error of 3 %, which it
must find.

Positions, velocities, energy, container, time and pairs are those that the recipes of :doc:`../tools` read,
of a periodic gas, one between walls, discs, two species, one with open faces and one under a piston.

*Distance* is between what gaspart and the referee say, with the largest one that is *allowed*: three
standard errors (p-values as the Gaussian deviation of the same chance, after Bonferroni's correction
where there are several), or a difference that single precision explains. *Planted* is the same distance
with the error in the files.

LAMMPS lets the same discs fall as gaspart, with springs and dashpots of the same restitution in place of
hard contacts. They collide many times before they rest, so that heaps agree in the mean only: 80 of gaspart,
40 of LAMMPS with each of three stiffnesses, continued to a stiffness without bound. Before that step LAMMPS's
mean heights are 0.8(2), 0.5(2) and 0.2(2) % lower.

SPARTA (`Plimpton and others, Phys. Fluids 31, 086101 (2019)
<https://doi.org/10.1063/1.5108534>`_) is a peer of the DSMC engine: it simulates the same dilute gases of
hard spheres, with as many cells and steps. It is no Python package and judges where somebody has installed
it, ``make referees GASPART_SPARTA=/path/to/spa_serial``; elsewhere it is skipped, and its lines of the table
stay. The error planted is one in its input: a diameter or a temperature.

"""
PUBLISHED = """\
Numbers that are known more precisely than a run of some minutes measures them: our deviation in our own
standard uncertainty and in the published one. The discs are in a periodic square, as the published ones;
the figure :ref:`freezing_discs <figure-freezing_discs>` compares others in a rectangle. :math:`Z` is
corrected to first order in :math:`1/N`. :math:`B_5` follows from :math:`Z` at one density with the other
coefficients, and the linear tail beyond :math:`B_{10}`, as published or extrapolated. The planted error
is one of 3 % in the measured pressure.

"""
NOT_JUDGED = """\
XYZ files; LAMMPS data files of style *sphere* in ASE, which accepts no such lines. freud's :math:`g(r)` is
compared with gaspart's in the tests of its kernels, not here.
"""


def referees():
    """The page of the referees, from the table that `make referees` writes."""
    with (ROOT / "docs/referees.csv").open(newline="", encoding="utf-8") as file:
        found = list(csv.DictReader(file))
    judged = {
        "referee": "{package} {version}", "judges": "{what}", "gaspart": "{ours}",
        "referee's": "{theirs}", "distance": "{distance}", "allowed": "{allowed} ({scale})",
        "error of 3 %": "{error}", "planted": "{planted}",
    }  # fmt: skip
    compared = {
        "number": "{what}", "gaspart": "{ours}", "published": "{theirs}", "in our σ": "{in_ours}",
        "in their σ": "{in_theirs}", "distance": "{distance}", "planted": "{planted}", "source": "{package}",
    }  # fmt: skip
    text = heading("Referees") + REFEREES + table(judged, [row for row in found if row["version"]])
    text += heading("Published numbers", "-") + PUBLISHED
    text += table(compared, [row for row in found if not row["version"]])
    return {"referees.rst": text + heading("What is not judged", "-") + NOT_JUDGED}


SOURCES = """\
Every statement of the three documents that gaspart reproduces, in our words, with its verdict. *Corrected*:
right but for what the evidence states. *Followed* and *replaced*: how gaspart treats a proposal. Numbers are
those of the last reproduction.

"""


def sources():
    """Return the page of the sources' statements, workflow/report/sources.yaml."""
    text = heading("The sources on trial") + SOURCES
    references = read_yaml(ROOT / "workflow/report/references.yaml")
    for document in read_yaml(ROOT / "workflow/report/sources.yaml"):
        about = references[document["source"]]
        text += heading(document["source"].replace("source", "Source"), "-")
        text += f"{' & '.join(about['authors'])}, {about['where']}\n\n"
        rows = []
        for entry in document["statements"]:
            figure = entry.get("figure", "")
            link = f" :ref:`{figure} <figure-{figure}>`" if figure else ""
            claims = ROOT / f"results/claims/{figure}.csv"
            why = fill_caption(entry["why"], read(claims) if claims.exists() else [], "(see the claims)")
            cells = {key: " ".join(entry[key].split()) for key in ("at", "says", "verdict")}
            rows.append({**cells, "why": " ".join(why.split()) + link})
        columns = {"statement": "{says} *{at}*", "verdict": "**{verdict}.** {why}"}
        text += table(columns, rows)
    return {"sources.rst": text}


def paper():
    """Return the page of method and results: workflow/report/paper.md with the numbers of judged claims.

    Its places begin with the figure, {{figure: beginning of a claim}}.
    """
    rows = []
    for path in sorted((ROOT / "results/claims").glob("*.csv")):
        with path.open(newline="", encoding="utf-8") as file:
            rows += [{**row, "claim": f"{row['figure']}: {row['claim']}"} for row in csv.DictReader(file)]
    text = (ROOT / "workflow/report/paper.md").read_text(encoding="utf-8")
    return {"paper.md": fill_caption(text, rows, "(see the claims)")}


def changelog():
    """Return the page of changes, which includes CHANGELOG.md."""
    include = "```{include} ../../CHANGELOG.md\n:start-line: 1\n:relative-docs: docs/\n```\n"
    return {"changelog.md": f"# Changes\n\n{include}"}


def table(columns, rows):
    """A table of rows: title of a column -> pattern of its cells."""
    text = ".. list-table::\n   :header-rows: 1\n\n"
    for cells in (list(columns), *([form.format(**row) for form in columns.values()] for row in rows)):
        text += f"   * - {cells[0]}\n" + "".join(f"     - {cell}\n" for cell in cells[1:])
    return text + "\n"


def write(folder):
    """Write all pages; those that are up to date are not touched, so that Sphinx reads only what is new."""
    for part in ("api", "figures", "reference"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    pages = {
        **api(),
        **command_line(),
        **gallery(folder),
        **figures(folder),
        **referees(),
        **sources(),
        **paper(),
        **reference(),
        **changelog(),
    }
    pages["symmetries.rst"] = symmetries.page(heading, table)
    pages["exact-values.rst"] = exact_values.page(heading, table)
    for path, text in pages.items():
        target = folder / path
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


def describe_keys(app, what, name, thing, options, lines):
    """Prepare a docstring: escape bars, and append the keys of a dataclass without Parameters."""
    lines[:] = [line.replace("|", "\\|") for line in lines]
    documented = any(line.strip(": ") == "Parameters" for line in lines)
    if what == "class" and is_dataclass(thing) and not documented:
        keys = [field for field in fields(thing) if "meaning" in field.metadata]
        lines += [""] + [f":param {field.name}: {field.metadata['meaning']}" for field in keys]


def setup(app):
    """Register with Sphinx."""
    app.connect("builder-inited", lambda app: write(Path(app.srcdir) / "generated"))
    app.connect("autodoc-process-docstring", describe_keys)
    return {"parallel_read_safe": True}
