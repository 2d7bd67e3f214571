"""Choices of a reader on the page, from measured data of figures.

The reader selects the packing fraction of a virial series. For the choice of an engine, the reader selects
observable, packing fraction and accuracy.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.reproduction import registry
from gaspart.theory.state import compressibility_factor
from gaspart.theory.virial import HIGHEST_ORDER, partial_sum
from gaspart.yaml_text import read_yaml

if TYPE_CHECKING:
    import xarray as xr


_STEPS = 100


def states(paths: Mapping[str, str]) -> list[dict[str, Any]]:
    """Return the `series` of all measured equations of state in {figure: path}."""
    import xarray as xr

    stated = {figure: declaration for figure, declaration in registry.series().items() if figure in paths}
    return series({figure: xr.load_dataset(paths[figure]) for figure in stated}, stated)


def choice_of_engine(paths: Mapping[str, str]) -> dict[str, Any] | None:
    """Return the `engines` of the figure on the cost of an accuracy, with the figure's name. None if the
    figure is not on the page.
    """
    import xarray as xr

    figures = [figure for figure in registry.costs() if figure in paths]
    return {"figure": figures[0], **engines(xr.load_dataset(paths[figures[0]]))} if figures else None


def series(
    datasets: Mapping[str, xr.Dataset], states: Mapping[str, tuple[int, float]]
) -> list[dict[str, Any]]:
    """Return the data of each figure of an equation of state. The data are the available packing fractions,
    the partial sums of the virial series by order, Z of the best equation of state, and the measured Z with
    its standard error. `states` has the dimension of each figure, and the largest available packing fraction.
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
    """Return the costs and errors of all engines, from the data set of `time_to_accuracy`. `count` is the
    number of particles. `engines` has name and colour of each engine. `parts` are the causes of errors.
    `observables` has for each observable its name, its packing fractions and two arrays. The array `cost`, in
    s, is over packing fraction, accuracy and engine. An element equals None if the engine was not run, and -1
    if no setting is accurate enough. The array `error` has `parts` as further axis. It is relative, and None
    if unknown. `accuracies` has the values of the second axis.
    """
    from matplotlib.colors import to_hex

    from gaspart.reproduction.figures import time_to_accuracy as panels

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
    """Convert an array to nested lists for JSON; numbers have three digits."""
    if values.ndim > 1:
        return [_nest(part) for part in values]
    return [float(f"{value:.3g}") if math.isfinite(value) else None for value in values.tolist()]


def _numbers(values: np.ndarray) -> list[float | None]:
    """Convert numbers for JSON, with six digits; infinite numbers and NaN become None."""
    return [
        float(f"{value:.6g}") if math.isfinite(value) else None for value in np.asarray(values, dtype=float)
    ]


# Numbered references of the page, and citations of them. A text cites a reference by its key in square
# brackets: "the law of [Haff 1983]", "figure 4 of [source A]".


CITATION = re.compile(r"\[([^][<>]+)\]")


@dataclass(frozen=True)
class Reference:
    """Reference of the literature.

    number : number in the list, from 1.
    key : key by which texts cite the reference.
    authors : surnames, the last perhaps "others".
    where : journal, volume, page, or a title.
    doi : DOI, or "".
    """

    number: int
    key: str
    authors: tuple[str, ...]
    year: int
    where: str
    doi: str = ""

    @property
    def is_source(self) -> bool:
        """True if the key is a name, such as "source A". Other keys consist of an author and a year."""
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
    """Read the references of a file by key, numbered in the order of the file. Raises SceneError for invalid
    YAML.
    """
    return {
        key: Reference(**{**entry, "number": number, "key": key, "authors": tuple(entry["authors"])})
        for number, (key, entry) in enumerate(read_yaml(path).items(), 1)
    }


def find_reference(citation: re.Match[str], references: Mapping[str, Reference]) -> Reference | None:
    """Return the reference that a match of `CITATION` cites. None for other texts in square brackets."""
    key = " ".join(citation[1].split())
    return references.get(key) or references.get(key[0].lower() + key[1:])


def cited_references(texts: Iterable[str], references: Mapping[str, Reference]) -> dict[str, Reference]:
    """Return the references that some texts cite, by key. The references are in the order of `references`,
    and are numbered from 1.
    """
    matches = (find_reference(citation, references) for text in texts for citation in CITATION.finditer(text))
    keys = {reference.key for reference in matches if reference is not None}
    kept = (reference for key, reference in references.items() if key in keys)
    return {item.key: replace(item, number=number) for number, item in enumerate(kept, 1)}


def split_citations(text: str, references: Mapping[str, Reference]) -> Iterator[tuple[str, Reference | None]]:
    """Yield the parts of a text, with the reference that is cited at the end of a part. The names of authors
    take the place of the key in brackets.
    """
    start = 0
    for citation in CITATION.finditer(text):
        if (reference := find_reference(citation, references)) is not None:
            yield text[start : citation.start()], None
            yield text[slice(*citation.span(1))] if reference.is_source else reference.short, reference
            start = citation.end()
    yield text[start:], None
