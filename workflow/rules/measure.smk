# From simulations to numbers with uncertainties, and from numbers to verdicts: re-judging reruns no analysis.


rule measure:
    input:
        points=lambda wildcards: [point.path for point in figure_points(wildcards)],
        tables=other_claims,
    output:
        "<results>/measurements/{figure}.nc",
    log:
        "<results>/logs/measure/{figure}.log",
    benchmark:
        "<results>/benchmarks/measure/{figure}.tsv"
    priority: 1  # as points have: the longest takes half a minute, beside which timings would have to wait
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=4000,
        runtime=30,
    params:
        modules=modules_of("measure"),
        module=module_of("measure"),
        function=function_of,
        points=lambda wildcards: [point.to_dict() for point in figure_points(wildcards)],
        settings=settings_of,
        package=package_of,
        title=lambda wildcards: config["title"],
    script:
        "../scripts/measure.py"


rule judge:
    input:
        dataset="<results>/measurements/{figure}.nc",
    output:
        "<results>/claims/{figure}.csv",
    log:
        "<results>/logs/judge/{figure}.log",
    benchmark:
        "<results>/benchmarks/judge/{figure}.tsv"
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        modules=modules_of("judge"),
        module=module_of("judge"),
        function=function_of,
        stated=stated_of,
    script:
        "../scripts/judge.py"


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
    benchmark:
        "<results>/benchmarks/claims.tsv"
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
    benchmark:
        "<results>/benchmarks/claims_of_first.tsv"
