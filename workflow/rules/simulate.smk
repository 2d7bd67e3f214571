# One point of a grid is one job with one output: its replicas run inside it.
# Points come before figures: otherwise the longest may come last, with nothing to run beside it.
# The stamps are `ancient`: kernels that are compiled anew change no result.


rule simulate:
    input:
        kernels=lambda wildcards: ancient(stamp_of(wildcards)),
    output:
        directory(f"{config['points']}/{{experiment}}/{{point}}"),
    log:
        "<results>/logs/simulate/{experiment}/{point}.log",
    wildcard_constraints:
        experiment=pattern(trajectories=True),
    cache: True
    priority: 1
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        modules=lambda wildcards: digest(*sources_of(point_of(wildcards))),
        job=lambda wildcards: point_of(wildcards).job,
        parameters=parameters_of,
    script:
        "../scripts/simulate.py"


# Points whose result is one data set. Timings claim all cores, so that nothing runs beside them.
rule compute:
    input:
        kernels=lambda wildcards: ancient(stamp_of(wildcards)),
    output:
        f"{config['points']}/{{experiment}}/{{point}}.nc",
    log:
        "<results>/logs/compute/{experiment}/{point}.log",
    wildcard_constraints:
        experiment=pattern(trajectories=False),
    cache: True
    priority: 1
    conda:
        "../envs/gaspart.yaml"
    threads: cores_of
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        modules=lambda wildcards: digest(*sources_of(point_of(wildcards))),
        job=lambda wildcards: point_of(wildcards).job,
        parameters=parameters_of,
    script:
        "../scripts/compute.py"
