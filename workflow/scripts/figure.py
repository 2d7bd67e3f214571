"""One figure: numbers with uncertainties, claims with verdicts, and pictures.

The numbers are not measured again if a data set of the same points, settings and code exists: only claims and
drawing have changed. The log states what cannot be read in the pictures.
"""

import json
import os
from contextlib import suppress

from _job import job

with job(snakemake):
    import xarray as xr

    from gaspart.files import whole_file
    from gaspart.rendering import style
    from gaspart.rendering.legibility import flaws, save_key_picture
    from gaspart.reproduction import claims
    from gaspart.reproduction.figure import content_key, find_parts
    from gaspart.reproduction.points.point import Point
    from gaspart.reproduction.points.trust import require_own
    from gaspart.trajectory import provenance

    figure, params = snakemake.wildcards.figure, snakemake.params
    given, output = dict(snakemake.input.items()), dict(snakemake.output.items())
    parts = find_parts(params.module, params.function)

    def load(path):
        """The data set of a file; None if the file does not exist, or cannot be read."""
        with suppress(OSError):
            return xr.load_dataset(path)

    def measure():
        """All points of the figure, or the claims of other figures, as numbers with uncertainties."""
        points = tables or [
            Point.from_dict(values, path) for values, path in zip(params.points, paths, strict=True)
        ]
        for point in () if tables else points:
            require_own(point)
        settings = {name: value for name, value in params.settings.items() if name != "experiments"}
        dataset = parts.measure(points, settings)
        dataset.attrs.update(
            figure=figure,
            key=key,
            config=params.title,
            settings=json.dumps(params.settings),
            points="\n".join([*tables, *paths]),
            git_revision=provenance.git_revision(),
            **provenance.versions(),
        )
        with whole_file(output["dataset"]) as partial:
            dataset.to_netcdf(partial)
        return xr.load_dataset(output["dataset"])

    if "dataset" in given:
        dataset = load(given["dataset"])
    else:
        tables, paths = list(snakemake.input.tables), list(snakemake.input.points)
        key = content_key([*tables, *paths], params.measuring, params.title, params.settings, params.points)
        dataset = load(output["dataset"])
        if dataset is None or dataset.attrs.get("key") != key:
            dataset = measure()
        else:
            os.utime(output["dataset"])
            print("the same points, settings and code: the numbers are not measured again")
        with whole_file(output["claims"]) as partial:
            claims.write(partial, figure, list(parts.claims(dataset, *params.stated)))
    layouts = {"page": ("png", "svg"), "journal": ("journal_png", "journal_pdf")}
    for layout, names in layouts.items():
        pictures = [output[name] for name in names if name in output]
        if not pictures:
            continue
        with style.use_style(layout):
            picture = parts.draw(dataset)
            for path in pictures:
                style.save(picture, path)
        for flaw in flaws(picture):
            print(f"not legible: {figure}, {layout}: {flaw}")
        if layout == "page":
            with style.use_style(layout):
                save_key_picture(picture, parts.key, output["key"])
