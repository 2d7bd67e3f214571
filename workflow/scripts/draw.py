"""One figure in the layouts that are requested; the log states what cannot be read in it."""

from _job import job

with job(snakemake):
    import xarray as xr

    from gaspart.rendering import style
    from gaspart.rendering.legibility import flaws
    from gaspart.reproduction.families.registry import function

    figure, output = snakemake.wildcards.figure, dict(snakemake.output.items())
    draw = function(snakemake.params.module, snakemake.params.function, "draw")
    dataset = xr.load_dataset(snakemake.input.dataset)
    layouts = {"page": ("png", "svg"), "journal": ("journal_png", "journal_pdf")}
    for layout, names in layouts.items():
        paths = [output[name] for name in names if name in output]
        if not paths:
            continue
        with style.use_style(layout):
            picture = draw(dataset)
            for path in paths:
                style.save(picture, path)
        for flaw in flaws(picture):
            print(f"not legible: {figure}, {layout}: {flaw}")
