# The entry point of the workflow: simulate every point of every grid, measure, judge, draw, report.
#
#   snakemake --cores all                                      everything
#   snakemake --cores all results/figures/virial_discs.png     one figure (.png or .svg)
#   snakemake --cores all results/figures/journal/virial_discs.pdf  the same for a column of a journal (.pdf or .png)
#   snakemake --cores all first                                results/first.html, three figures of the sources
#   snakemake --cores all journal                              results/figures/journal/*.pdf
#   snakemake --cores all claims                               results/tables/claims.csv
#   snakemake --cores all report                               results/report.html
#   snakemake --cores all animations                           results/animations/*.mp4
#   snakemake --cores all points                               every simulation, without the measurements
#   snakemake --cores all --configfile config/smoke.yaml       everything, small, in results/smoke

from snakemake.utils import min_version

min_version("9.19")


configfile: "config/config.yaml"


report: "workflow/report/workflow.rst"


include: "workflow/rules/common.smk"
include: "workflow/rules/warm.smk"
include: "workflow/rules/simulate.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/animate.smk"


# Snakemake wakes its scheduler once a second for every job that has ended (snakemake/snakemake#3744), to limit how
# many start in a second: after a few hundred jobs that takes a core. On one machine no limit is needed. There jobs are
# copies of a process that has loaded their modules; Snakemake runs scripts by the command in sys.executable.
onstart:
    # A later run with less effort would replace these points.
    made = {
        job.wildcards.experiment for job in workflow.dag.jobs if job.rule.name in ("simulate", "compute")
    }
    write_efforts(folder_of_points(), {experiment: effort_of(config, experiment) for experiment in made})
    if workflow.local_exec:
        workflow.scheduler.job_rate_limiter = None
        sys.executable = job_server.start(sys.executable, SCRIPTS / "_client.py")


# The verdicts, unless the run was of a part, such as one figure. `make` prints them itself: Snakemake has no hook for
# a run that finds nothing to do.
onsuccess:
    tables = [job.output[0] for job in workflow.dag.jobs if job.rule.name == "claims"]
    if "MAKELEVEL" not in os.environ and tables:
        print(summary(tables[0]))


localrules:
    all,
    animations,
    first,
    journal,
    points,


rule first:
    input:
        "<results>/first.html",


rule animations:
    input:
        expand("<results>/animations/{animation}.mp4", animation=ANIMATIONS),


rule journal:
    input:
        expand("<results>/figures/journal/{figure}.pdf", figure=FIGURES),


rule points:
    input:
        share([point.path for experiment in POINTS.values() for point in experiment.values()]),


rule all:
    default_target: True
    input:
        expand("<results>/figures/{figure}.{kind}", figure=FIGURES, kind=["png", "svg"]),
        "<results>/tables/claims.csv",
        "<results>/report.html",
        rules.animations.input,
