# gaspart, at a glance: simulate every point of every grid, measure, judge, draw, report.
#
#   snakemake --cores all                                      everything
#   snakemake --cores all results/figures/virial_discs.png     one figure (.png or .svg)
#   snakemake --cores all claims                               results/tables/claims.csv
#   snakemake --cores all report                               results/report.html
#   snakemake --cores all animations                           results/animations/*.mp4
#   snakemake --cores all --configfile config/smoke.yaml       all of it, small

from snakemake.utils import min_version

min_version("9.0")


configfile: "config/config.yaml"


report: "workflow/report/workflow.rst"


include: "workflow/rules/common.smk"
include: "workflow/rules/warm.smk"
include: "workflow/rules/simulate.smk"
include: "workflow/rules/measure.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/animate.smk"


localrules:
    all,
    animations,


rule animations:
    input:
        expand("results/animations/{animation}.mp4", animation=ANIMATIONS),


rule all:
    default_target: True
    input:
        expand("results/figures/{figure}.{kind}", figure=FIGURES, kind=["png", "svg"]),
        "results/tables/claims.csv",
        "results/report.html",
        rules.animations.input,
