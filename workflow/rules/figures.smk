# From points to the numbers, claims and pictures of a figure, and from all figures to one table and one page.


# One job makes a figure. What it was measured from is stated in the data set, which stays until the job replaces it:
# if only claims or drawing have changed, nothing is measured again.
rule figure:
    input:
        points=lambda wildcards: [point.path for point in figure_points(wildcards)],
        tables=other_claims,
    output:
        dataset=update("<results>/measurements/{figure}.nc"),
        claims="<results>/claims/{figure}.csv",
        png=flagged("<results>/figures/{figure}.png", "png"),
        svg=flagged("<results>/figures/{figure}.svg", "svg"),
        # The same for a column of a journal, which the report shows on narrow screens.
        journal_png="<results>/figures/journal/{figure}.png",
        # One panel, for the gallery.
        key="<results>/figures/key/{figure}.png",
    log:
        "<results>/logs/figure/{figure}.log",
    priority: 1  # as points have: the longest takes half a minute, beside which timings would have to wait
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=4000,
        runtime=30,
    params:
        modules=modules_of_figure,
        measuring=measuring_of,
        module=module_of,
        function=function_of,
        points=lambda wildcards: [point.to_dict() for point in figure_points(wildcards)],
        settings=settings_of,
        stated=stated_of,
        caption=caption_of,
        title=lambda wildcards: config["title"],
    script:
        "../scripts/figure.py"


use rule figure as figure_for_journal with:
    input:
        dataset="<results>/measurements/{figure}.nc",
    output:
        journal_pdf="<results>/figures/journal/{figure}.pdf",
    log:
        "<results>/logs/figure_for_journal/{figure}.log",


rule claims:
    input:
        tables=expand("<results>/claims/{figure}.csv", figure=FIGURES),
    output:
        report(
            "<results>/tables/claims.csv",
            caption="../report/claims.rst",
            category="Claims",
            labels={"figure": "all", "type": "table"},
        ),
    log:
        "<results>/logs/claims.log",
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        modules=digest(*sources("claims")),
    script:
        "../scripts/claims.py"


use rule claims as claims_of_first with:
    input:
        tables=expand("<results>/claims/{figure}.csv", figure=FIRST),
    output:
        "<results>/tables/first.csv",
    log:
        "<results>/logs/claims_of_first.log",


rule report:
    input:
        **page_of(FIGURES, "<results>/tables/claims.csv", ANIMATIONS),
    output:
        "<results>/report.html",
    log:
        "<results>/logs/report.log",
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        modules=digest(*sources("report"), *STATED),
        figures=FIGURES,
        own_captions=OWN_CAPTIONS,
        films=FILMS,
        title=lambda wildcards: config["title"],
        efforts=EFFORTS_OF_RUNS,
        one_file=False,
    script:
        "../scripts/report.py"


# The same page with its pictures and films in it, to be sent or kept as one file.
use rule report as report_in_one_file with:
    output:
        "<results>/report-in-one-file.html",
    log:
        "<results>/logs/report_in_one_file.log",
    params:
        modules=digest(*sources("report"), *STATED),
        figures=FIGURES,
        own_captions=OWN_CAPTIONS,
        films=FILMS,
        title=lambda wildcards: config["title"],
        efforts=EFFORTS_OF_RUNS,
        one_file=True,


# Three figures of the sources on a page of their own, which a newcomer has in two minutes.
use rule report as report_of_first with:
    input:
        **page_of(FIRST, "<results>/tables/first.csv", []),
    output:
        "<results>/first.html",
    log:
        "<results>/logs/report_of_first.log",
    params:
        modules=digest(*sources("report"), *STATED),
        figures={figure: FIGURES[figure] for figure in FIRST},
        own_captions={},
        films={},
        title=lambda wildcards: f"{len(FIRST)} of {len(FIGURES)} figures",
        efforts=EFFORTS_OF_RUNS,
        one_file=False,
