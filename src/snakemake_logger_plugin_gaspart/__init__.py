"""Logger plugin of Snakemake under the name that Snakemake searches for: `snakemake --logger gaspart`."""

from gaspart.reproduction.progress import LogHandler

__all__ = ["LogHandler"]
