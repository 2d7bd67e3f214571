"""CPU time and memory of a job, as the last line of its log.

Snakemake samples the CPU time of a job now and then, and not at its end: of 736 s it recorded 607 s. A job
that a server runs it does not see at all. So each job asks the operating system when its work is done.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import NamedTuple

from gaspart.system import largest_memory

_LINE = re.compile(r"^processor time: (\d+\.\d+) s, memory: (\d+\.\d+|nan) MB$", re.MULTILINE)


class Used(NamedTuple):
    """CPU time of a job with its children, in s, and its largest memory, in MB.

    An unknown number is nan.
    """

    seconds: float
    memory: float


def describe() -> str:
    """Return the line for the log of this process."""
    return f"processor time: {sum(os.times()[:4]):.2f} s, memory: {largest_memory() / 1e6:.1f} MB"


def read_used(results: Path, rule: str, *names: str) -> Used | None:
    """Return what the log of a job states; None if it states nothing.

    `results` is the folder of the logs' folder; `names` are the wildcards of the rule, as folders and file of
    the log.
    """
    log = (results / "logs").joinpath(rule, *names)
    try:
        matches = _LINE.findall(
            log.with_name(f"{log.name}.log").read_text(encoding="utf-8", errors="replace")
        )
    except FileNotFoundError:
        return None
    return Used(*map(float, matches[-1])) if matches else None
