"""All points of one figure, as numbers with uncertainties."""

import json

from _job import job

with job(snakemake):
    from gaspart.files import whole_file
    from gaspart.reproduction.families.registry import function
    from gaspart.reproduction.points.point import Point
    from gaspart.trajectory import provenance

    figure = snakemake.wildcards.figure
    # The claims of other figures, or points of experiments.
    tables = list(snakemake.input.tables)
    points = tables or [
        Point.from_dict(values, path)
        for values, path in zip(snakemake.params.points, snakemake.input.points, strict=True)
    ]
    settings = {key: value for key, value in snakemake.params.settings.items() if key != "experiments"}
    dataset = function(snakemake.params.module, snakemake.params.function, "measure")(points, settings)
    dataset.attrs.update(
        figure=figure,
        config=snakemake.params.title,
        settings=json.dumps(snakemake.params.settings),
        points="\n".join(tables or (point.path for point in points)),
        git_revision=provenance.git_revision(),
        **provenance.versions(),
    )
    if snakemake.params.package:
        dataset.attrs["package"] = snakemake.params.package
    with whole_file(snakemake.output[0]) as partial:
        dataset.to_netcdf(partial)
