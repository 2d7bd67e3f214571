"""The claims of all figures in one table."""

from _job import job

with job(snakemake):
    from gaspart.files import whole_file
    from gaspart.reproduction import claims

    with whole_file(snakemake.output[0]) as partial:
        claims.collect(snakemake.input.tables).to_csv(partial, index=False)
    print(claims.summary(snakemake.output[0]))
