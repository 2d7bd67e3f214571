# One point of a grid is one job with one output: its replicas run inside it.
# The stamps are `ancient`: kernels that are compiled anew change no result.


rule simulate:
    input:
        kernels=lambda wildcards: ancient(stamp_of(wildcards)),
    output:
        directory(f"{config['points']}/{{experiment}}/{{point}}"),
    log:
        "results/logs/simulate/{experiment}/{point}.log",
    benchmark:
        "results/benchmarks/simulate/{experiment}/{point}.tsv"
    wildcard_constraints:
        experiment=experiments("simulate"),
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        modules=modules("simulate"),
        recipe=recipe_of,
    script:
        "../scripts/simulate.py"


# Timings claim all cores, so that nothing runs beside them.
rule measure_cost:
    input:
        kernels=lambda wildcards: ancient(stamp_of(wildcards)),
    output:
        f"{config['points']}/{{experiment}}/{{point}}.nc",
    log:
        "results/logs/measure_cost/{experiment}/{point}.log",
    benchmark:
        "results/benchmarks/measure_cost/{experiment}/{point}.tsv"
    wildcard_constraints:
        experiment=experiments("measure_cost"),
    conda:
        "../envs/gaspart.yaml"
    threads: workflow.resource_settings.cores or 1
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        modules=modules("measure_cost"),
        recipe=recipe_of,
    script:
        "../scripts/measure_cost.py"


rule compare:
    input:
        kernels=lambda wildcards: ancient(stamp_of(wildcards)),
    output:
        f"{config['points']}/{{experiment}}/{{point}}.nc",
    log:
        "results/logs/compare/{experiment}/{point}.log",
    benchmark:
        "results/benchmarks/compare/{experiment}/{point}.tsv"
    wildcard_constraints:
        experiment=experiments("compare"),
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        modules=modules("compare"),
        recipe=recipe_of,
    script:
        "../scripts/compare.py"


rule echo:
    input:
        kernels=lambda wildcards: ancient(stamp_of(wildcards)),
    output:
        f"{config['points']}/{{experiment}}/{{point}}.nc",
    log:
        "results/logs/echo/{experiment}/{point}.log",
    benchmark:
        "results/benchmarks/echo/{experiment}/{point}.tsv"
    wildcard_constraints:
        experiment=experiments("echo"),
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        modules=modules("echo"),
        recipe=recipe_of,
    script:
        "../scripts/echo.py"


rule fill:
    input:
        kernels=lambda wildcards: ancient(stamp_of(wildcards)),
    output:
        f"{config['points']}/{{experiment}}/{{point}}.nc",
    log:
        "results/logs/fill/{experiment}/{point}.log",
    benchmark:
        "results/benchmarks/fill/{experiment}/{point}.tsv"
    wildcard_constraints:
        experiment=experiments("fill"),
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        modules=modules("fill"),
        recipe=recipe_of,
    script:
        "../scripts/fill.py"


rule pack:
    input:
        kernels=lambda wildcards: ancient(stamp_of(wildcards)),
    output:
        f"{config['points']}/{{experiment}}/{{point}}.nc",
    log:
        "results/logs/pack/{experiment}/{point}.log",
    benchmark:
        "results/benchmarks/pack/{experiment}/{point}.tsv"
    wildcard_constraints:
        experiment=experiments("pack"),
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        modules=modules("pack"),
        recipe=recipe_of,
    script:
        "../scripts/pack.py"
