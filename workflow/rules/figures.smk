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
        **page_of(FIGURES, "<results>/tables/claims.csv", ANIMATIONS),
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


# Three figures of the sources on a page of their own, which a newcomer has in two minutes.
use rule report as report_of_first with:
    input:
        **page_of(FIRST, "<results>/tables/first.csv", []),
    output:
        "<results>/first.html",
    log:
        "<results>/logs/report_of_first.log",
    benchmark:
        "<results>/benchmarks/report_of_first.tsv"
    params:
        modules=digest(*sources("report"), *FAMILIES),
        figures={figure: FIGURES[figure] for figure in FIRST},
        own_captions={},
        films={},
        title=lambda wildcards: f"{len(FIRST)} of {len(FIGURES)} figures",
        one_file=False,
