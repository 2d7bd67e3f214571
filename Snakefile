# The workflow, for commands in this folder. Other workflows and the catalog name workflow/Snakefile.
include: "workflow/Snakefile"


localrules:
    everything,


# The default target of a file that is included does not hold.
rule everything:
    default_target: True
    input:
        rules.all.input,
