"""`gaspart measure`: observables of a trajectory, with uncertainties and theory."""

from __future__ import annotations

import argparse
import io
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.analysis.measuring import measure
from gaspart.analysis.names import OBSERVABLES, SELECTIONS
from gaspart.cli.arguments import (
    Parser,
    UsageError,
    add_trajectory,
    print_line,
    real,
    set_command,
    several,
)
from gaspart.cli.progress import waiting
from gaspart.errors import SceneError
from gaspart.files import Kind, begins_with, output_path, writing

if TYPE_CHECKING:
    from gaspart.analysis.observable import Observable

_ROWS = 12  # of a curve that are printed
_TITLE = "# gaspart measure"
_TABLE = Kind("a table written by gaspart measure", begins_with(_TITLE.encode()))
_EXAMPLES = """examples:
  gaspart measure run.nc Z msd
  gaspart measure run.nc vacf -o vacf.png
  gaspart measure run.nc msd -o msd.csv --start 10"""


def add_measure(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    names = "; ".join(f"{name}: {meaning}" for name, (_, _, meaning) in OBSERVABLES.items())
    text = f"{names}. Uncertainties are one standard deviation; of curves a few rows are printed."
    set_command(parser, _measure, text, _EXAMPLES)
    add = parser.add_argument
    add_trajectory(parser)
    add("observables", nargs="+", choices=tuple(OBSERVABLES), metavar="NAME", help=", ".join(OBSERVABLES))
    text = "time from which frames count; default: a quarter of the run"
    add("--start", type=real(least=0.0), metavar="T", help=text)
    text = "of one species only, by its number in the scene, from 0 (single particles: after the last): "
    add("--species", type=int, metavar="N", help=text + ", ".join(SELECTIONS["species"]))
    text = "of these particles only, by their numbers in the file, from 0: "
    names = ", ".join(SELECTIONS["particles"])
    add("--particles", type=several(int), metavar="N[,N...]", help=text + names)
    add("-o", "--output", metavar="FILE", help="all rows of one observable as .csv, or a plot as .png")
    add("--force", action="store_true", help="replace a table or a picture")


def _measure(given: argparse.Namespace) -> None:
    from gaspart.trajectory.reading import open_trajectory

    write = _writer(given)
    asked = {key: getattr(given, key) for key in SELECTIONS}
    selection = {key: value for key, value in asked.items() if value is not None}
    with open_trajectory(given.trajectory) as trajectory:
        for name in given.observables:
            with waiting(f"measuring {name}"):
                observable = measure(name, trajectory, given.start, **selection)
            if observable.estimate.ndim:
                _print_curve(name, observable)
            else:
                _print_scalar(name, observable)
            write(observable)


def _print_scalar(name: str, observable: Observable) -> None:
    units = observable.estimate.attrs["units"]
    line = (
        f"{name} = {_with_error(observable.estimate, observable.error)}{'' if units == '1' else f' {units}'}"
    )
    if observable.theory is not None and observable.deviation is not None:
        unsure = observable[f"{observable.estimate.name}_theory_error"]
        line += f", theory {_with_error(observable.theory, unsure)}"
        if np.isfinite(observable.deviation):
            line += f": {float(observable.deviation):+.1f} standard deviations"
        line += f" ({observable.attrs['source']})"
    print_line(line)


def _with_error(value: Any, error: Any) -> str:
    return f"{float(value):.6g} +- {float(error):.1g}" if float(error) > 0.0 else f"{float(value):.6g}"


def _print_curve(name: str, observable: Observable) -> None:
    (along,) = observable.estimate.dims
    rows = observable.sizes[along]
    stride = max(1, -(-rows // _ROWS))
    columns = [observable[along], observable.estimate, observable.error]
    columns += [] if observable.theory is None else [observable.theory]
    heads = [str(along), name, "error", *(["theory"] if observable.theory is not None else [])]
    wide = [max(14, len(head) + 2) for head in heads]
    print_line("".join(f"{head:>{width}}" for head, width in zip(heads, wide, strict=True)))
    for row in range(0, rows, stride):
        cells = [column.values[row] for column in columns]
        texts = [cell if isinstance(cell, str) else f"{cell:.5g}" for cell in cells]
        print_line("".join(f"{text:>{width}}" for text, width in zip(texts, wide, strict=True)))
    if stride > 1:
        shown = -(-rows // stride)
        print_line(f"({shown} of {rows} rows; -o {name}.csv writes all, -o {name}.png draws them)")


def _writer(given: argparse.Namespace) -> Callable[[Observable], None]:
    """What writes the result, after the arguments were checked."""
    if given.output is None:
        return lambda observable: None
    path = output_path(given.output)
    if len(given.observables) > 1:
        raise UsageError("-o takes one observable; give one, or leave -o out")
    if path.suffix == ".csv":
        return partial(_write_table, path, given.force)
    if path.suffix == ".png":
        return partial(_write_plot, path, given.force)
    raise SceneError("output", given.output, "must end in .csv or .png")


def _write_table(path: Any, overwrite: bool, observable: Observable) -> None:
    with writing(path, _TABLE, overwrite) as scratch:
        units = {name: variable.attrs.get("units", "1") for name, variable in observable.variables.items()}
        title = f"{_TITLE}: units " + ", ".join(f"{name}: {unit}" for name, unit in units.items())
        scratch.write_text(f"{title}\n{observable.to_dataframe().to_csv()}", encoding="utf-8")
    print_line(path)


def _write_plot(path: Any, overwrite: bool, observable: Observable) -> None:
    from gaspart.rendering import style
    from gaspart.rendering.pictures import PICTURE

    with writing(path, PICTURE, overwrite) as scratch, style.applied("journal"):
        figure, (axis,) = style.new((2.6,))
        observable.plot(theory=observable.theory is not None, axis=axis)
        picture = io.BytesIO()
        figure.savefig(picture, format="png", metadata={"Software": None})
        scratch.write_bytes(picture.getvalue())
    print_line(path)
