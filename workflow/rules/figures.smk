# From numbers and curves to pictures, and from everything to one page.


rule draw:
    input:
        dataset="<results>/measurements/{figure}.nc",
    output:
        png=flagged("<results>/figures/{figure}.png", "png"),
        svg=flagged("<results>/figures/{figure}.svg", "svg"),
        # The same for a column of a journal, which the report shows on narrow screens.
        journal_png="<results>/figures/journal/{figure}.png",
    log:
        "<results>/logs/draw/{figure}.log",
    benchmark:
        "<results>/benchmarks/draw/{figure}.tsv"
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=10,
    params:
        modules=modules_of("draw"),
        module=module_of("draw"),
        function=function_of,
        caption=caption_of,
    script:
        "../scripts/draw.py"


use rule draw as draw_for_journal with:
    output:
        journal_pdf="<results>/figures/journal/{figure}.pdf",
    log:
        "<results>/logs/draw_for_journal/{figure}.log",
    benchmark:
        "<results>/benchmarks/draw_for_journal/{figure}.tsv"


rule report:
    input:
        pictures=expand("<results>/figures/{figure}.png", figure=FIGURES),
        vectors=expand("<results>/figures/{figure}.svg", figure=FIGURES),
        columns=expand("<results>/figures/journal/{figure}.png", figure=FIGURES),
        datasets=expand("<results>/measurements/{figure}.nc", figure=FIGURES),
        captions=[
            of_project(f"workflow/report/{figure}.rst") for figure in FIGURES if figure not in OWN_CAPTIONS
        ],
        claims="<results>/tables/claims.csv",
        films=expand("<results>/animations/{animation}.mp4", animation=ANIMATIONS),
        posters=expand("<results>/animations/{animation}.jpg", animation=ANIMATIONS),
        template=of_project("workflow/report/report.html.j2"),
        style=of_project("workflow/report/page.css"),
        behaviour=[of_project(f"workflow/report/{name}") for name in ("page.js", "engines.js", "states.js")],
        findings=of_project("workflow/report/findings.yaml"),
        references=of_project("workflow/report/references.yaml"),
    output:
        "<results>/report.html",
    log:
        "<results>/logs/report.log",
    benchmark:
        "<results>/benchmarks/report.tsv"
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        modules=digest(*sources("report"), *FAMILIES),
        figures=FIGURES,
        own_captions=OWN_CAPTIONS,
        films=FILMS,
        title=lambda wildcards: config["title"],
        one_file=False,
    script:
        "../scripts/report.py"


# The same page with its pictures and films in it, to be sent or kept as one file.
use rule report as report_in_one_file with:
    output:
        "<results>/report-in-one-file.html",
    log:
        "<results>/logs/report_in_one_file.log",
    benchmark:
        "<results>/benchmarks/report_in_one_file.tsv"
    params:
        modules=digest(*sources("report"), *FAMILIES),
        figures=FIGURES,
        own_captions=OWN_CAPTIONS,
        films=FILMS,
        title=lambda wildcards: config["title"],
        one_file=True,
