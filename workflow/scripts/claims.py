"""The claims of all figures in one table."""

from _job import job

with job(snakemake):
    from gaspart import claims
    from gaspart.files import whole_file

    table = claims.collect(snakemake.input.tables)
    print(claims.summary(table))
    with whole_file(snakemake.output[0]) as partial:
        table.to_csv(partial, index=False)
