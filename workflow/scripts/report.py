"""The report: figures, captions, claims, their provenance and run times."""

import base64
import csv
import json
import os
import platform
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from _job import job

TOOLS = ["numpy", "numba", "scipy", "xarray", "matplotlib", "snakemake"]


def rows(path):
    """A CSV or TSV file as a list of mappings."""
    path = Path(path)
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file, delimiter="\t" if path.suffix == ".tsv" else ","))


def html_of(rst):
    """reStructuredText as a fragment of HTML."""
    from docutils.core import publish_parts

    settings = {"file_insertion_enabled": False, "raw_enabled": False, "math_output": "MathML"}
    return publish_parts(rst, writer="html5", settings_overrides=settings)["body"]


def caption_of(path, claims):
    """The caption of a figure with its measured numbers; copies of them are named in the log."""
    from gaspart.claims.captions import filled, literal_copies

    text = path.read_text(encoding="utf-8")
    for copy in literal_copies(text, claims):
        print(f"{path.stem}: a measured number in the caption, {copy}")
    return filled(text, claims)


def run_times(folder):
    """Seconds of every rule: number of jobs, their sum, the longest."""
    spent = {}
    for path in sorted(Path(folder).rglob("*.tsv")):
        rule = path.relative_to(folder).parts[0].removesuffix(".tsv")
        spent.setdefault(rule, []).extend(float(row["s"]) for row in rows(path))
    return [
        {"rule": rule, "jobs": len(times), "total": sum(times), "longest": max(times)}
        for rule, times in spent.items()
    ]


def number(text):
    """A number with five significant digits; other text unchanged."""
    try:
        return f"{float(text):.5g}"
    except ValueError:
        return text


def attributes(path):
    """The attributes of a netCDF file, without loading it."""
    from netCDF4 import Dataset

    with Dataset(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


with job(snakemake):
    import jinja2

    from gaspart import __version__
    from gaspart.claims import counts
    from gaspart.experiments.registry import families, titles
    from gaspart.files import whole_file
    from gaspart.trajectory import provenance

    claims = rows(snakemake.input.claims)
    sections = {}
    for figure, image, dataset, caption in zip(
        snakemake.params.figures,
        snakemake.input.figures,
        snakemake.input.datasets,
        snakemake.input.captions,
        strict=True,
    ):
        made, own = attributes(dataset), [row for row in claims if row["figure"] == figure]
        sections.setdefault(titles()[families()[figure]], []).append(
            {
                "name": figure,
                "image": base64.b64encode(Path(image).read_bytes()).decode(),
                "caption": html_of(caption_of(Path(caption), own)),
                "claims": own,
                "settings": json.dumps(json.loads(made["settings"]), indent=1),
                "points": made["points"].splitlines(),
            }
        )
    films = {
        Path(film).stem: base64.b64encode(Path(film).read_bytes()).decode() for film in snakemake.input.films
    }
    verdicts = {}
    for row in claims:
        verdicts[row["verdict"]] = verdicts.get(row["verdict"], 0) + 1
    template = Path(snakemake.input.template).read_text(encoding="utf-8")
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined)
    environment.filters["number"] = number
    text = environment.from_string(template).render(
        title=snakemake.params.title,
        sections=sections,
        films=films,
        claims=claims,
        verdicts=verdicts,
        kinds=counts(claims),
        times=run_times("results/benchmarks"),
        versions={"gaspart": __version__, "python": platform.python_version()}
        | {name: version(name) for name in TOOLS},
        machine=f"{platform.machine()}, {os.cpu_count()} processors, {platform.system()}",
        revision=provenance.git_revision(),
        made=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
    )
    with whole_file(snakemake.output[0]) as partial:
        partial.write_text(text, encoding="utf-8")
