"""`gaspart budget`: where the time of a finished run of the workflow went, and which length would suffice."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import Parser, config_command, print_lines, set_command

_EXAMPLES = """examples:
  gaspart budget config/config.yaml
  gaspart budget config/precise.yaml -o budget.csv    # a line for each claim"""


def add_budget(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "For each figure of a config of which the workflow has made all: the processor time of its points "
        "(shared: of those that other figures show as well), how many of its claims that runs decide are "
        "decided, and the multiple of its runs that would just suffice for these; then each claim that is "
        "not, with the multiple that would decide it."
    )
    set_command(parser, _budget, text, _EXAMPLES)
    parser.add_argument("config", metavar="FILE", help="config of the workflow (YAML)")
    parser.add_argument("-o", "--output", metavar="FILE", help="write a line for each claim (CSV) instead")


def _budget(given: argparse.Namespace) -> None:
    print_lines(config_command("budget")(given.config, given.output))
