"""CPU time and memory of a job, as the last line of its log.

Snakemake samples the CPU time of a job now and then, but not at its end: of 736 s it recorded 607 s. It does
not measure jobs that run in a server. Therefore each job asks the operating system when its work is done.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import NamedTuple

from gaspart.system import largest_memory

_LINE = re.compile(r"^processor time: (\d+\.\d+) s, memory: (\d+\.\d+|nan) MB$", re.MULTILINE)


class Used(NamedTuple):
    """CPU time in s and peak memory in MB of a job. The CPU time includes child processes. An unknown number
    is NaN.
    """

    seconds: float
    memory: float


def describe() -> str:
    """Return the line that describes this process in its log."""
    return f"processor time: {sum(os.times()[:4]):.2f} s, memory: {largest_memory() / 1e6:.1f} MB"


def read_used(results: Path, rule: str, *names: str) -> Used | None:
    """Return time and memory from the log of a job, or None. `results` is the parent folder of the logs.
    `names` are the wildcards of the rule, as folders and file name of the log.
    """
    log = (results / "logs").joinpath(rule, *names)
    try:
        matches = _LINE.findall(
            log.with_name(f"{log.name}.log").read_text(encoding="utf-8", errors="replace")
        )
    except FileNotFoundError:
        return None
    return Used(*map(float, matches[-1])) if matches else None
