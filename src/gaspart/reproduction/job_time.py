"""Processor time of a job of the workflow, as the last line of its log.

Snakemake samples the processor time of a job now and then, and not at its end: of 736 s it recorded 607 s. So
each job asks the operating system itself when its work is done.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

_LINE = re.compile(r"^processor time: (\d+\.\d+) s$", re.MULTILINE)


def stated() -> str:
    """Return the line for a log: the time of this process since its start and of its children that ended."""
    return f"processor time: {sum(os.times()[:4]):.2f} s"


def seconds(results: Path, rule: str, *names: str) -> float | None:
    """Return the processor time that the log of a job states; None if there is none.

    results: the folder of the logs' folder; names: the wildcards of the rule, as folders and file of the log.
    """
    log = (results / "logs").joinpath(rule, *names)
    try:
        found = _LINE.findall(log.with_name(f"{log.name}.log").read_text(encoding="utf-8", errors="replace"))
    except FileNotFoundError:
        return None
    return float(found[-1]) if found else None
