"""Table of numbers measured by gaspart, from the measurements of a finished reproduction.

    python tools/measured.py results/measurements > src/gaspart/theory/data/measured.csv

writes the table that `gaspart.theory.measurements` reads. It has Z, contact values and transport coefficients
with their uncertainties.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Iterator
from pathlib import Path

import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.table import Row, Table

COLUMNS = ("dimension", "quantity", "packing_fraction", "count", "container", "value", "error", "source")
CONTAINERS = {2: "square", 3: "cube"}
ENSKOG = {
    "viscosity": theory.enskog_viscosity,
    "bulk_viscosity": theory.enskog_bulk_viscosity,
    "conductivity": theory.enskog_conductivity,
}
Value = tuple[int, str, Row, Estimate]
"""Dimension, quantity, row of the measurement, and value."""


def reference_values(folder: Path) -> Iterator[dict[str, object]]:
    """Yield the rows of the table, from the files <figure>.nc of a folder.

    Units are the diameter, the mass and k_B T. Raises OSError for a missing file.
    """
    for figure in ("virial_discs", "virial_spheres", "msd_spheres", "viscosity", "conductivity"):
        with xr.open_dataset(folder / f"{figure}.nc") as dataset:
            for dimension, quantity, row, value in _values(figure, dataset.load()):
                yield {
                    "dimension": dimension,
                    "quantity": quantity,
                    "packing_fraction": f"{row.packing_fraction:.9g}",
                    "count": int(row.count),
                    "container": CONTAINERS[dimension],
                    "value": f"{value.value:.{_decimals(value)}f}",
                    "error": f"{value.error:.{_decimals(value)}f}",
                    "source": figure,
                }


def _decimals(value: Estimate) -> int:
    """Return the number of decimals for an error of two digits."""
    return max(0, 1 - math.floor(math.log10(value.error)))


def _values(figure: str, dataset: xr.Dataset) -> Iterator[Value]:
    if figure.startswith("virial"):
        dimension = int(dataset.attrs["dimension"])
        for row in Table(dataset, "packing_fraction"):
            yield dimension, "Z", row, row.Z
            contact = (row.Z - 1.0) / (2.0 ** (dimension - 1) * row.packing_fraction)
            yield dimension, "contact_value", row, contact
    elif figure == "msd_spheres":
        for row in Table(dataset, "point"):
            if row.diffusion.error > 0.0:
                yield 3, "diffusion", row, row.diffusion
    else:
        for row in Table(dataset, "point"):
            ratios = {figure: row.value} | ({"bulk_viscosity": row.bulk} if figure == "viscosity" else {})
            for quantity, ratio in ratios.items():
                enskog = float(ENSKOG[quantity](row.packing_fraction, row.dimension))
                yield row.dimension, quantity, row, enskog * ratio


if __name__ == "__main__":
    writer = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(reference_values(Path(sys.argv[1])))
