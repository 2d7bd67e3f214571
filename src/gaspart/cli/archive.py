"""`gaspart archive`: the archive of a finished run of the workflow."""

from __future__ import annotations

import argparse
from pathlib import Path

from gaspart.cli.arguments import (
    CheckFailed,
    Parser,
    add_output,
    config_command,
    integer,
    print_line,
    print_lines,
    set_command,
)
from gaspart.cli.progress import waiting
from gaspart.errors import SceneError
from gaspart.yaml_text import read_yaml

_EXAMPLES = """examples:
  gaspart archive results -o archive.zip       # the full reproduction
  gaspart archive results/smoke -o smoke.zip   # of a config with `run: smoke`
  gaspart archive results -o all.zip --trajectories"""


def add_archive(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "A finished run of the workflow as one file to deposit, a Workflow Run RO-Crate: sources, config, "
        "locked environment, figures, captions, claims with the digests of their data, the digests of all "
        "trajectories, machine, and the time of each job. Title, creators and licence are those of "
        "CITATION.cff."
    )
    set_command(parser, _archive, text, _EXAMPLES)
    parser.add_argument("results", metavar="FOLDER", help="results, or results/<run>")
    add_output(parser, "ends in .zip", "an older archive")
    text = "the config of the run; default: the one in config, or above, that states its name"
    parser.add_argument("--config", metavar="FILE", help=text)
    text = "include the trajectories, not only their digests"
    parser.add_argument("--trajectories", action="store_true", help=text)


def _archive(options: argparse.Namespace) -> None:
    write = config_command("archive")
    with waiting("reading the results"):
        line = write(options.results, options.output, options.config, options.trajectories, options.force)
    print_line(line)


# `gaspart verify`: checks that an archive is unchanged, and that simulations reproduce its bits.


_EXAMPLES_OF_VERIFY = """examples:
  gaspart verify archive.zip
  gaspart verify archive.zip --rerun 3   # and three points simulated again
  gaspart verify unpacked/               # a folder into which it was unpacked

exit code: 0 if all checks pass, 1 if one fails, 2 if the file is no archive"""


def add_verify(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "Recompute the digests of an archive of `gaspart archive`: of its files, and of the data that its "
        "claims are made of. With --rerun points drawn at random are simulated again, and compared bit for "
        "bit. Nothing is written but to a temporary folder and the cache of kernels."
    )
    set_command(parser, _verify, text, _EXAMPLES_OF_VERIFY)
    parser.add_argument(
        "archive", metavar="ARCHIVE", help="an archive (.zip), or the folder of an unpacked one"
    )
    text = "number of points to simulate again; default: 0"
    parser.add_argument("--rerun", type=integer(least=0), default=0, metavar="N", help=text)


def _verify(options: argparse.Namespace) -> None:
    checks = iter(config_command("verify")(options.archive, options.rerun))
    failed = False
    while True:
        with waiting("reading the archive, or simulating a point; the first time, compiling kernels"):
            check = next(checks, None)
        if check is None:
            break
        print_line(check)
        failed |= not check.passed
    if failed:
        raise CheckFailed


# `gaspart budget`: time used by a finished run of the workflow, and sufficient run lengths.


_EXAMPLES_OF_BUDGET = """examples:
  gaspart budget config/config.yaml
  gaspart budget config/precise.yaml -o budget.csv    # a line for each claim
  gaspart budget config/config.yaml --status          # what is made and left
  gaspart budget config/config.yaml --next            # what runs next"""


def add_budget(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "For each figure of a config of which the workflow has made all: the processor time of its points "
        "(shared: of those that other figures show as well), how many of its claims that runs decide are "
        "decided, and the multiple of its runs that would just suffice for these; then each claim that is "
        "not, with the multiple that would decide it."
    )
    set_command(parser, _budget, text, _EXAMPLES_OF_BUDGET)
    parser.add_argument("config", metavar="FILE", help="config of the workflow (YAML)")
    parser.add_argument("-o", "--output", metavar="FILE", help="write a line for each claim (CSV) instead")
    text = "print the points of each figure that are made and left instead, while the workflow runs too"
    parser.add_argument("--status", action="store_true", help=text)
    parser.add_argument(
        "--next",
        action="store_true",
        help="double the effort of the experiments whose claims are open, up to 4, for the next run of the "
        "workflow, which must have ended before; exit code 1 if no effort decides more",
    )


def _budget(options: argparse.Namespace) -> None:
    if Path(options.config).suffix not in (".yaml", ".yml"):
        rule = "must be a config of the workflow (.yaml); gaspart info reports on a run"
        raise SceneError("config", options.config, rule)
    content = read_yaml(options.config)
    if isinstance(content, dict) and "container" in content:
        rule = "is a scene, and must be a config of the workflow; gaspart advise predicts the cost of a scene"
        raise SceneError("config", options.config, rule)
    if options.next:
        lines = config_command("decide")(options.config)
        print_lines(lines or ["no effort of at most 4 decides another claim"])
        if not lines:
            raise CheckFailed
        return
    print_lines(config_command("budget")(options.config, options.output, options.status))
