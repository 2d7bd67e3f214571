"""One point of a grid whose result is one data set: costs, comparisons, echoes, insertions, packings."""

import shutil
from pathlib import Path

from _job import function, job

with job(snakemake):
    from gaspart.kernels.compile.cache import load_numba

    load_numba(ours=True)
    from gaspart.files import whole_file
    from gaspart.reproduction.jobs.data import MADE_BY, digest_of, kept_path, made_by

    # By its name: a job depends on what its arguments are, not on how they are written down.
    from_plain = function("gaspart.reproduction.jobs.arguments", "from_plain")
    compute = function(f"gaspart.reproduction.jobs.{snakemake.params.job}", snakemake.params.job)
    parameters = snakemake.params.parameters
    kept = kept_path(Path(snakemake.output[0]))
    with whole_file(snakemake.output[0]) as partial:
        if kept.exists() and made_by(kept) == digest_of(parameters):  # from a deposit
            shutil.copyfile(kept, partial)
        else:
            data = compute(**from_plain(parameters))
            data = data._replace(attributes={**data.attributes, MADE_BY: digest_of(parameters)})
            data.write(partial)
