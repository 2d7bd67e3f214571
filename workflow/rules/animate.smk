# Films of the scenes that are worth seeing move: all frames of the first replica of an experiment's first point. And the
# gas that runs on the first screen of the report.


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


rule play:
    input:
        [
            of_project(f"src/gaspart/rendering/{name}")
            for name in ("gas.js", "page.html", "play.html", "style.css")
        ],
    output:
        "<results>/play.html",
    log:
        "<results>/logs/play.log",
    conda:
        "../envs/gaspart.yaml"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=10,
    params:
        modules=digest(*sources("play")),
        opening=config.get("opening"),
    script:
        "../scripts/play.py"
