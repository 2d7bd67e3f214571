# Compile the kernels that the grids use, once each, so that no simulation waits for a compiler.
#
# The stamp's path holds a digest of the compiled modules and one of the features of the scene, and the rule has
# neither inputs nor a `script:`, so that nothing but a missing stamp can make it run. It must be so: while a job that
# is to be rerun has `ancient` output, Snakemake (9.27) leaves everything downstream of it unexamined, whatever else
# may have changed. Who edits the command below gives the stamps another suffix. Parameters that are made with
# `threads` count as derived, and make nothing run.


# Paths are no parameters, which would enter the hashes of what is shared by `--cache`. On a cluster the job reads this
# file again.
os.environ |= {"GASPART_PYTHON": shlex.split(sys.executable)[0], "GASPART_WARM": str(SCRIPTS / "warm.py")}


envvars:
    "GASPART_PYTHON",
    "GASPART_WARM",


rule warm:
    output:
        touch("results/kernels/{digest}/{variant}.compiled"),
    log:
        "<results>/logs/warm/{digest}/{variant}.log",
    priority: 2
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=10,
    params:
        task=lambda wildcards, threads: task_of(wildcards),
    shell:
        '"$GASPART_PYTHON" "$GASPART_WARM" {params.task:q} > {log} 2>&1'
