"""One figure in both layouts; the log states what cannot be read in it."""

from _job import function, job

with job(snakemake):
    import xarray as xr

    from gaspart.rendering import style
    from gaspart.rendering.legibility import flaws

    figure, output = snakemake.wildcards.figure, snakemake.output
    draw = function(snakemake.params.module, snakemake.params.function)
    dataset = xr.load_dataset(snakemake.input.dataset)
    pictures = {"page": (output.png, output.svg), "journal": (output.journal_png, output.journal_pdf)}
    for layout, paths in pictures.items():
        with style.applied(layout):
            picture = draw(dataset)
            for path in paths:
                style.save(picture, path)
        for flaw in flaws(picture):
            print(f"not legible: {figure}, {layout}: {flaw}")
