# Compile the kernels that the grids use, once each, so that no simulation waits for a compiler.
#
# The stamp's path holds a digest of the compiled modules, and the rule has neither inputs, nor parameters, nor a
# `script:`, so that nothing but a missing stamp can make it run. It must be so: while a job that is to be rerun has
# `ancient` output, Snakemake (9.27) leaves everything downstream of it unexamined, whatever else may have changed.


rule warm:
    output:
        touch("results/kernels/{digest}/{variant}.stamp"),
    log:
        "results/logs/warm/{digest}/{variant}.log",
    benchmark:
        "results/benchmarks/warm/{digest}/{variant}.tsv"
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=10,
    params:
        python=lambda wildcards, threads: sys.executable,
    shell:
        "{params.python} workflow/scripts/warm.py {wildcards.variant} > {log} 2>&1"
