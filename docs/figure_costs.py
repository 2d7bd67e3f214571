"""What each figure costs: a section of docs/at-scale.md, of a complete run of the workflow.

python docs/figure_costs.py [CONFIG]
"""

import platform
import sys
from pathlib import Path

from gaspart.reproduction.cost import budgets

PAGE = Path(__file__).parent / "at-scale.md"
HEADING, NEXT = "## The cost of each figure\n", "## In another workflow\n"
ABOUT = """\
Processor time of the points of each figure in `{config}`, its numbers and its picture: {seconds:.0f} s,
points of several figures once for each (*shared* is the time of these). *Decided* are so many of its claims
that runs decide, and the multiple of its runs is that which would just suffice for them. Python {python},
{machine}; `python docs/figure_costs.py` renews the table.
"""


def section(config):
    """The section, the most expensive figure first."""
    found = budgets(config)
    lines = ["| figure | s | shared | decided | length that suffices |", "| --- | --- | --- | --- | --- |"]
    for one in found:
        decided = f"{len(one.conclusive)} of {len(one.needs)}" if one.needs else "–"
        length = f"{one.sufficient:.2g}" if one.conclusive else "–"
        lines.append(f"| `{one.figure}` | {one.seconds:.0f} | {one.shared:.0f} | {decided} | {length} |")
    about = ABOUT.format(
        config=config,
        seconds=sum(one.seconds for one in found),
        python=platform.python_version(),
        machine=platform.machine(),
    )
    return "\n".join([HEADING, about, *lines, "\n"])


def main(config="config/config.yaml"):
    """Write the section before the one that follows, in place of an older one."""
    text = PAGE.read_text(encoding="utf-8")
    before, after = text.split(NEXT)
    PAGE.write_text(before.split(HEADING)[0] + section(config) + NEXT + after, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
