"""Write the reference pages: python docs/build.py FOLDER. An API reference, and a page for each family.

The API reference is made from the docstrings; the page of a family from its captions, the docstrings of its
modules and, if the workflow has run, its figures and claims.
"""

import csv
import html
import importlib
import inspect
import os
import sys
from pathlib import Path

from docutils.core import publish_parts

import gaspart
from gaspart import theory
from gaspart.claims.captions import filled
from gaspart.experiments.registry import families, titles

ROOT = Path(__file__).parents[1]
STYLE = """body { margin: auto; padding: 1rem; max-width: 50rem; font: 1rem/1.55 system-ui, sans-serif; }
img { max-width: 100%; }
pre { white-space: pre-wrap; font-size: .85rem; background: #f5f6f8; padding: .7rem; }
table { display: block; overflow-x: auto; font-size: .85rem; }
td, th { text-align: left; padding-right: 1rem; }"""


def page(title, body):
    """A complete page of HTML."""
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{title}</title>'
    head += f"<style>{STYLE}</style>"
    return f'<!doctype html><html lang="en"><head>{head}</head><body><h1>{title}</h1>{body}</body></html>'


def from_rst(text):
    """reStructuredText as HTML."""
    settings = {"file_insertion_enabled": False, "raw_enabled": False, "math_output": "MathML"}
    return publish_parts(text, writer="html5", settings_overrides=settings)["body"]


def entry(name, thing):
    """A public name: its signature and its docstring."""
    signature = ""
    if callable(thing) and thing is not gaspart.SimulationError:  # which has the signature of any exception
        signature = str(inspect.signature(thing)).replace("gaspart.", "")
    text = (inspect.getdoc(thing) if callable(thing) else repr(thing)) or ""
    return f'<h3 id="{name}">{name}</h3><pre>{html.escape(name + signature)}\n\n{html.escape(text)}</pre>'


def methods(kind):
    """The public methods and properties of a class, each with the first line of its docstring."""
    rows = []
    for name, thing in vars(kind).items():
        text = inspect.getdoc(thing)
        if (
            not name.startswith("_")
            and text
            and (callable(thing) or isinstance(thing, property | classmethod))
        ):
            rows.append(f"<tr><td><code>{name}</code></td><td>{html.escape(text.splitlines()[0])}</td></tr>")
    return f"<table>{''.join(rows)}</table>" if rows else ""


def api():
    """All public names of gaspart and of gaspart.theory."""
    parts = ["<h2>gaspart</h2>"]
    for name in sorted(gaspart.__all__, key=str.lower):
        thing = getattr(gaspart, name)
        parts.append(entry(name, thing) + (methods(thing) if inspect.isclass(thing) else ""))
    parts.append("<h2>gaspart.theory</h2>")
    parts += [
        entry(f"theory.{name}", getattr(theory, name)) for name in sorted(theory.__all__, key=str.lower)
    ]
    return page("gaspart: public names", "".join(parts))


def family_page(family, folder):
    """The page of a family: captions, figures, claims, and the docstrings of its modules."""
    parts = []
    for figure in (name for name, its in families().items() if its == family):
        parts.append(f'<h2 id="{figure}">{figure}</h2>')
        picture = ROOT / f"results/figures/{figure}.svg"
        if picture.exists():
            parts.append(f'<img alt="{figure}" src="{os.path.relpath(picture, folder)}">')
        caption = (ROOT / f"workflow/report/{figure}.rst").read_text(encoding="utf-8")
        parts.append(from_rst(filled(caption, [], "(see the claims)")))
        parts.append(claims_of(ROOT / f"results/claims/{figure}.csv"))
    for kind, title in (("measure", "Measurement"), ("claims", "Claims")):
        text = importlib.import_module(f"gaspart.experiments.{family}.{kind}").__doc__
        parts.append(f"<h2>{title}</h2><pre>{html.escape(text.strip())}</pre>")
    return page(titles()[family], "".join(parts))


def claims_of(path):
    """A table of the claims with their verdicts; empty if the workflow has not run."""
    if not path.exists():
        return ""
    with path.open(newline="", encoding="utf-8") as file:
        rows = [
            [row[key] for key in ("claim", "measured", "expected", "verdict")] for row in csv.DictReader(file)
        ]
    cells = "".join(f"<tr>{''.join(f'<td>{html.escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><tr><th>claim</th><th>measured</th><th>expected</th><th>verdict</th></tr>{cells}</table>"


def build(folder):
    """Write all pages into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "api.html").write_text(api(), encoding="utf-8")
    links = ['<li><a href="api.html">public names</a></li>']
    for family in titles():
        (folder / f"{family}.html").write_text(family_page(family, folder), encoding="utf-8")
        links.append(f'<li><a href="{family}.html">{html.escape(titles()[family])}</a> ({family})</li>')
    (folder / "index.html").write_text(page("gaspart", f"<ul>{''.join(links)}</ul>"), encoding="utf-8")


if __name__ == "__main__":
    build(Path(sys.argv[1]))
