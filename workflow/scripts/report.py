"""The report: figures, captions, claims, their provenance and run times."""

import json
import os
import platform
from collections import Counter
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from _job import job, job_time

TOOLS = ["numpy", "numba", "scipy", "xarray", "matplotlib", "snakemake"]


def run_times(results):
    """Seconds of processor time of every rule: number of jobs, their sum, the longest."""
    spent, folder = {}, results / "logs"
    for path in sorted(folder.rglob("*.log")):
        rule, *names = path.relative_to(folder).with_suffix("").parts
        if used := job_time.read_used(results, rule, *names):
            spent.setdefault(rule, []).append(used.seconds)
    return [
        {"rule": rule, "jobs": len(times), "total": sum(times), "longest": max(times)}
        for rule, times in spent.items()
    ]


def attributes(path):
    """The attributes of a netCDF file, without loading it."""
    from netCDF4 import Dataset

    with Dataset(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


with job(snakemake):
    import jinja2

    from gaspart import __version__
    from gaspart.files import whole_file
    from gaspart.reproduction.claims import table
    from gaspart.reproduction.claims.table import literal_copies
    from gaspart.reproduction.report import explore, page
    from gaspart.reproduction.report import explore as references
    from gaspart.trajectory import provenance
    from gaspart.yaml_text import read_yaml

    params, given = snakemake.params, snakemake.input
    folder = Path(snakemake.output[0]).parent  # of this run
    claims = [row | {"id": f"claim-{n}"} for n, row in enumerate(table.read(given.claims), 1)]
    of_figure = {figure: [row for row in claims if row["figure"] == figure] for figure in params.figures}
    captions = {Path(path).stem: Path(path).read_text(encoding="utf-8") for path in given.captions}
    captions |= params.own_captions
    pictures, sections = {}, []
    for figure, picture, dataset in zip(params.figures, given.pictures, given.datasets, strict=True):
        made, rows = attributes(dataset), of_figure[figure]
        for copy in literal_copies(captions[figure], rows):
            print(f"{figure}: a measured number in the caption, {copy}")
        pictures[figure] = page.picture(Path(picture), params.one_file)
        sections.append(
            page.Section(
                name=figure,
                family_name=params.figures[figure],
                caption=page.make_caption(captions[figure], rows),
                claims=rows,
                films=[film for film, beside in params.films.items() if beside == figure],
                settings=json.dumps(json.loads(made["settings"]), indent=1),
                points=made["points"].splitlines(),
            )
        )
    of_chapter = page.by_chapter(sections)
    measured = dict(zip(params.figures, given.datasets, strict=True))
    # All films together are larger than the rest, so that a page in one file has one at most.
    shown = given.films[: 0 if given.play else 1] if params.one_file else given.films
    films = {Path(path).stem: page.address(Path(path), params.one_file) for path in shown}
    posters = {Path(path).stem: page.address(Path(path), params.one_file) for path in given.posters}
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([Path(path).parent for path in (given.template, *given.style)]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["number"] = "{:.5g}".format
    statements = page.statements(read_yaml(given.statements), claims)
    if any(one["figure"] in of_figure for one in statements):
        statements = [one for one in statements if one["figure"] in ("", *of_figure)]
    else:  # a report of other figures
        statements = []
    texts = [
        *captions.values(),
        *(text for one in statements for text in (f"[{one['source']}]", one["why"])),
        *(row[key] for row in claims for key in ("source", "allowance_source")),
    ]
    sources = references.cited_references(texts, references.read_references(given.references))
    environment.globals["pieces"] = lambda text: references.split_citations(text, sources)
    ordered = [section for own in of_chapter.values() for section in own]
    text = environment.get_template(Path(given.template).name).render(
        title=params.title,
        one_file=params.one_file,
        folder=folder,
        sections=ordered,
        chapters=of_chapter,
        pictures=pictures,
        films=films,
        posters=posters,
        play=given.play and (page.address(Path(given.play), True) if params.one_file else "play.html"),
        other_films=[film for film, beside in params.films.items() if beside not in of_figure],
        claims=claims,
        findings=page.findings(read_yaml(given.findings), ordered),
        statements=statements,
        headline=page.headline(claims),
        efforts=[f"{effort:g}" for effort in params.efforts],
        filters={key: Counter(row[key] for row in claims) for key in ("verdict", "kind")},
        states=explore.states(measured),
        engines=explore.choice_of_engine(measured),
        references=sources,
        words=table.COUNTED,
        kinds=table.PLURALS,
        times=run_times(folder),
        versions={"gaspart": __version__, "python": platform.python_version()}
        | {name: version(name) for name in TOOLS},
        machine=f"{platform.machine()}, {os.cpu_count()} processors, {platform.system()}",
        revision=provenance.git_revision(),
        made=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
    )
    with whole_file(snakemake.output[0]) as partial:
        partial.write_text(text, encoding="utf-8")
