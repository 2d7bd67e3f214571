# Films of the scenes that are worth seeing move: all frames of the first replica of an experiment's first point.


rule animate:
    input:
        trajectories=lambda wildcards: animated(wildcards).path,
    output:
        film="<results>/animations/{animation}.mp4",
        poster="<results>/animations/{animation}.jpg",
    log:
        "<results>/logs/animate/{animation}.log",
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        modules=digest(*sources("animate")),
        settings=lambda wildcards: settings_of_animation(wildcards),
    script:
        "../scripts/animate.py"
