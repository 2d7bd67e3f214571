"""Choices of a reader on the page, from data that the figures have measured.

The user selects the packing fraction of a virial series; or the observable, the packing fraction and the
accuracy for which an engine is wanted.
"""

from __future__ import annotations

import html
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.reproduction.families import registry
from gaspart.theory.state import compressibility_factor
from gaspart.theory.virial import HIGHEST_ORDER, partial_sum
from gaspart.yaml_text import read_yaml

if TYPE_CHECKING:
    import xarray as xr


_STEPS = 100


def states(paths: Mapping[str, str]) -> list[dict[str, Any]]:
    """Return `series` of all measured equations of state among {figure: path}."""
    import xarray as xr

    stated = {figure: declaration for figure, declaration in registry.series().items() if figure in paths}
    return series({figure: xr.load_dataset(paths[figure]) for figure in stated}, stated)


def choice_of_engine(paths: Mapping[str, str]) -> dict[str, Any] | None:
    """Return the `engines` of the figure of the cost of an accuracy, with its name.

    None unless the figure is on the page.
    """
    import xarray as xr

    figures = [figure for figure in registry.costs() if figure in paths]
    return {"figure": figures[0], **engines(xr.load_dataset(paths[figures[0]]))} if figures else None


def series(
    datasets: Mapping[str, xr.Dataset], states: Mapping[str, tuple[int, float]]
) -> list[dict[str, Any]]:
    """Return the data of each figure of an equation of state.

    The data are the packing fractions to choose from, the partial sums of the virial series to each order, Z
    of the best equation of state, and the measured Z with its standard error. `states` contains the dimension
    of each figure and the largest packing fraction that can be chosen.
    """
    rows = []
    for figure, (dimension, largest) in states.items():
        eta = np.linspace(0.0, largest, _STEPS + 1)
        orders = range(1, HIGHEST_ORDER + 1)
        measured = datasets[figure]
        rows.append(
            {
                "name": "discs" if dimension == 2 else "spheres",
                "figure": figure,
                "packing_fraction": _numbers(eta),
                "sums": [_numbers(partial_sum(eta, order, dimension)) for order in orders],
                "reference": _numbers(compressibility_factor(eta, dimension)),
                "measured": [
                    _numbers(measured[name].values) for name in ("packing_fraction", "Z", "Z_error")
                ],
            }
        )
    return rows


def engines(dataset: xr.Dataset) -> dict[str, Any]:
    """Return the costs and errors of all engines, from a dataset of `families.tradeoff.maps`.

    `count` of particles; `accuracies`; `engines`: name and colour of each; `parts`: causes of errors;
    `observables`: for each its name, its packing fractions and two arrays. Over packing fraction, accuracy
    and engine: `cost` in s (None if the engine was not run, -1 if no setting is so accurate). Over part too:
    `error`, relative (None if unknown).
    """
    from matplotlib.colors import to_hex

    from gaspart.reproduction.families.tradeoff import figure as panels

    observables = []
    for quantity in dataset["quantity"].values:
        of = dataset.sel(quantity=quantity)
        of = of.isel(fraction=(of["cost"] < np.inf).any(("accuracy", "solver")).values)
        if of.sizes["fraction"]:
            cost = of["cost"].transpose("fraction", "accuracy", "solver")
            observables.append(
                {
                    "key": str(quantity),
                    "name": panels.TITLES[str(quantity)].replace("$", ""),
                    "fractions": _numbers(of["fraction"].values),
                    "cost": _nest(np.where(np.isposinf(cost), -1.0, cost)),
                    "error": _nest(of["error"].transpose(*cost.dims, "part").values),
                }
            )
    return {
        "count": int(dataset["count"].values[0]),
        "accuracies": _numbers(dataset["accuracy"].values),
        "engines": [
            {"name": panels.NAMES[engine], "colour": to_hex(panels.tint(engine))}
            for engine in map(str, dataset["solver"].values)
        ],
        "parts": list(panels.PART_NAMES),
        "observables": observables,
    }


def _nest(values: np.ndarray) -> list:
    """Convert an array to nested lists of numbers for JSON, with three digits."""
    if values.ndim > 1:
        return [_nest(part) for part in values]
    return [float(f"{value:.3g}") if math.isfinite(value) else None for value in values.tolist()]


def _numbers(values: np.ndarray) -> list[float | None]:
    """Convert numbers for JSON, with six digits; None for numbers that are not finite."""
    return [
        float(f"{value:.6g}") if math.isfinite(value) else None for value in np.asarray(values, dtype=float)
    ]


# The numbered references of the page, and the citations of them.
#
# A text cites a reference by its key in square brackets: "the law of [Haff 1983]", "figure 4 of [source
# A]".


CITATION = re.compile(r"\[([^][<>]+)\]")


@dataclass(frozen=True)
class Reference:
    """Reference of the literature.

    number : from 1.
    key : by which texts cite it.
    authors : surnames, the last perhaps "others".
    where : journal, volume, page, or a title.
    doi : "" without a DOI.
    """

    number: int
    key: str
    authors: tuple[str, ...]
    year: int
    where: str
    doi: str = ""

    @property
    def is_source(self) -> bool:
        """True if its key is a name, such as "source A".

        Other keys have an author and a year.
        """
        return str(self.year) not in self.key

    @property
    def text(self) -> str:
        """Entry in the list of references, without the DOI."""
        *first, last = self.authors
        names = f"{', '.join(first)} and {last}" if first else last
        return f"{names}, {self.where} ({self.year})" + (f": {self.key}" if self.is_source else "")

    @property
    def short(self) -> str:
        """Citation in a text, by one or two authors and the year."""
        names = self.authors if len(self.authors) < 3 else (self.authors[0], "others")
        return f"{' and '.join(names)} {self.year}"


def read_references(path: str | Path) -> dict[str, Reference]:
    """Read the references of a file by key, numbered in its order.

    Raises SceneError if it is not YAML.
    """
    return {
        key: Reference(**{**entry, "number": number, "key": key, "authors": tuple(entry["authors"])})
        for number, (key, entry) in enumerate(read_yaml(path).items(), 1)
    }


def find_reference(citation: re.Match[str], references: Mapping[str, Reference]) -> Reference | None:
    """Return the reference that a match of `CITATION` cites; None for other texts in square brackets."""
    key = " ".join(citation[1].split())
    return references.get(key) or references.get(key[0].lower() + key[1:])


def cited_references(texts: Iterable[str], references: Mapping[str, Reference]) -> dict[str, Reference]:
    """Return the references that some texts cite, by key, in the same order, numbered from 1."""
    matches = (find_reference(citation, references) for text in texts for citation in CITATION.finditer(text))
    keys = {reference.key for reference in matches if reference is not None}
    kept = (reference for key, reference in references.items() if key in keys)
    return {item.key: replace(item, number=number) for number, item in enumerate(kept, 1)}


def link_citations(text: str, references: Mapping[str, Reference]) -> str:
    """Return HTML in which each citation has become names and a numbered link into the list."""

    def link(citation: re.Match[str]) -> str:
        reference = find_reference(citation, references)
        if reference is None:
            return citation[0]
        name = citation[1] if reference.is_source else html.escape(reference.short)
        title = html.escape(reference.text)
        anchor = f'<a href="#reference-{reference.number}" title="{title}">[{reference.number}]</a>'
        return f"{name}\N{NO-BREAK SPACE}{anchor}"

    return CITATION.sub(link, text)
