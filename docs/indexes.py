"""The indexes of the site: figures with pictures and findings, public names and commands with a line.

Findings are the beginnings of the captions, lines those of the docstrings and of `gaspart --help`.
"""

import importlib
import inspect
import re
import shutil
from pathlib import Path

from sphinx.pycode import ModuleAnalyzer

from gaspart.cli import lines
from gaspart.reproduction.claims.table import fill_caption, read
from gaspart.reproduction.config import merged_with_default
from gaspart.reproduction.registry import chapter, families
from gaspart.reproduction.report.page import CHAPTERS

ROOT = Path(__file__).parents[1]
_FINDING = re.compile(r"\*\*(.+?)\*\*", re.DOTALL)
_MAY_BREAK = "\N{ZERO WIDTH SPACE}"
_CITED = re.compile(r"\[(source [A-Z])\]")
_OPENING, _CLOSING = "([{", ")]}"
_ABBREVIATED = ("", "Chem", "J", "Mol", "Phys", "Rev")
"""Words before a full stop that ends no sentence, as in names of journals; one may also stand alone."""


def figures(folder):
    """The index of all figures, by the chapters of the report, with small pictures of those drawn."""
    text = (
        _heading("Figures")
        + "Each picture leads to its figure, with theory, claims and the command that makes it.\n\n"
    )
    folder.mkdir(parents=True, exist_ok=True)
    stated = merged_with_default(ROOT / "config/config.yaml")[0]["figures"]  # in the order of the report
    for title in CHAPTERS:
        shown = [figure for figure in stated if chapter(families()[figure]) == title]
        if shown:
            text += _heading(title, "-") + ".. container:: cards\n\n"
            text += "".join(_indented(_card(figure, folder)) + "\n" for figure in shown)
    return text


def _card(figure, folder):
    """A figure in the index: its picture, its name and its finding."""
    address = f"{families()[figure]}.html#figure-{figure.replace('_', '-')}"
    key = ROOT / f"results/figures/key/{figure}.png"
    text = ".. container:: card\n\n"
    if key.exists():
        shutil.copyfile(key, folder / key.name)
        text += f"   .. image:: {folder.name}/{key.name}\n      :target: {address}\n      :alt: {figure}\n\n"
    return text + f"   :ref:`{_breakable(figure)} <figure-{figure}>`\n\n   {finding(figure)}\n"


def finding(figure):
    """The finding of a figure, reStructuredText, with its measured numbers if the workflow has run."""
    caption = (ROOT / f"workflow/report/{figure}.rst").read_text(encoding="utf-8")
    claims = ROOT / f"results/claims/{figure}.csv"
    caption = fill_caption(caption, read(claims) if claims.exists() else [], "…")
    return _CITED.sub(r"\1", " ".join(_FINDING.match(caption)[1].split()))


def interface(groups):
    """The index of the public names and the commands, with a line for each. groups: page -> title, and its
    names by section; the first section has no title."""
    text = _heading("Public names and commands")
    text += (
        "Names are importable from ``gaspart``, those of theory from ``gaspart.theory``, observables from\n"
    )
    text += "``gaspart.analysis``.\n\n"
    for page, (title, sections) in groups.items():
        text += _heading(title, "-") + f":doc:`Arguments, units and errors <{page}>`.\n\n"
        for section, names in sections.items():
            text += (f".. rubric:: {section}\n\n" if section else "") + _listed(
                {f":py:obj:`{_breakable(_short(name))} <{name}>`": sentence(name) for name in names}
            )
    text += _heading("Commands", "-") + ":doc:`What each prints with --help <../command-line>`.\n\n"
    commands = {f":ref:`gaspart {name} <command-{name}>`": _begun(line) for name, line in lines().items()}
    pages = "".join(f"   {page}\n" for page in groups)
    return text + _listed(commands) + f".. toctree::\n   :hidden:\n\n{pages}"


def sentence(name):
    """The first sentence of a public name's docstring, as reStructuredText."""
    module, _, last = name.rpartition(".")
    thing = getattr(importlib.import_module(module), last)
    if inspect.ismodule(thing) or inspect.isclass(thing) or callable(thing):
        doc = inspect.getdoc(thing)
    else:
        doc = _of_constant(name) or f"{thing!r}"
    first = _until_full_stop(" ".join(doc.split("\n\n")[0].split()))
    return first.rstrip(". ").replace("|", "\\|") + "."


def _until_full_stop(text):
    """The first sentence of a text, without its full stop; one that leads to a formula ends at the colon."""
    depth = 0
    for place in range(1, len(text)):
        depth += (text[place - 1] in _OPENING) - (text[place - 1] in _CLOSING)
        if text[place] == "." and text[place + 1 : place + 2] in ("", " ") and depth == 0:
            word = text[:place].rpartition(" ")[2]
            if word not in _ABBREVIATED and not word.endswith("."):
                return text[:place]
    return text.partition(": ")[0].rstrip(":")


def _of_constant(name):
    """The text below the assignment of a constant, in the module of its package that has one."""
    package, _, last = name.rpartition(".")
    stub = Path(importlib.import_module(package).__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    home = re.search(rf"^from (\S+) import {last} as", stub, re.MULTILINE)
    documented = ModuleAnalyzer.for_module(home[1]).find_attr_docs() if home else {}
    return " ".join(documented.get(("", last), ()))


def _short(name):
    """A name as it is written in code: theory.Z, analysis.rdf, Scene."""
    return name.removeprefix("gaspart.")


def _breakable(name):
    """A name that may be broken between its words, on a narrow screen."""
    return re.sub("([_.])", rf"\1{_MAY_BREAK}", name)


def _begun(line):
    return f"{line[0].upper()}{line[1:]}."


def _listed(entries):
    """A list of terms with a line for each; the style sheet makes two columns of it."""
    return (
        ".. rst-class:: names\n\n" + "".join(f"{term}\n   {line}\n" for term, line in entries.items()) + "\n"
    )


def _heading(text, mark="="):
    return f"{text}\n{mark * len(text)}\n\n"


def _indented(text):
    return "".join(f"   {line}".rstrip() + "\n" for line in text.splitlines())
