"""Time left of a run of the workflow, which `snakemake_logger_plugin_gaspart` adds to the lines of Snakemake.

Steps differ: one compiles for a minute, one writes a page. So the steps that are left count with the mean
time of those of their rule that have ended, and before one has ended, with a usual time.
"""

from __future__ import annotations

from collections import Counter, defaultdict

USUAL = {"warm": 8.0, "simulate": 3.0, "compute": 30.0, "figure": 8.0, "animate": 20.0, "play": 30.0}
"""Seconds of a step of a rule, before one has ended; 1 s for others."""


class TimeLeft:
    """Time left, from the numbers of steps by rule, and the begin and end of each."""

    def __init__(self) -> None:
        self._left: Counter[str] = Counter()
        self._running: dict[int, tuple[str, float]] = {}
        self._spent: defaultdict[str, float] = defaultdict(float)
        self._ended: Counter[str] = Counter()
        self._first = 0.0

    def plan(self, steps: dict[str, int]) -> None:
        """Note how many steps each rule has."""
        self._left = Counter(steps)

    def start(self, step: int, rule: str, now: float) -> None:
        """Note that a step begins, at a time in s."""
        if not self._ended and not self._running:
            self._first = now
        self._running[step] = rule, now

    def end(self, step: int, now: float) -> None:
        """Note that a step has ended."""
        if step in self._running:
            rule, since = self._running.pop(step)
            self._left[rule] -= 1
            self._spent[rule] += now - since
            self._ended[rule] += 1

    def seconds(self, now: float) -> tuple[float, float]:
        """Return the part of the work that is done, and the time left in s."""
        done = sum(self._spent.values())
        work = sum(max(count, 0) * self._mean(rule) for rule, count in self._left.items())
        begun = sum(min(now - since, self._mean(rule)) for rule, since in self._running.values())
        at_once = max(1.0, (done + begun) / max(now - self._first, 1e-9))
        return (done + begun) / max(done + work, 1e-9), (work - begun) / at_once

    def _mean(self, rule: str) -> float:
        """Return the mean time of a step of a rule; the usual time counts as one step."""
        return (USUAL.get(rule, 1.0) + self._spent[rule]) / (1 + self._ended[rule])


def describe(part: float, seconds: float) -> str:
    """Return the line."""
    minutes = seconds / 60.0
    left = f"{minutes:.0f} min" if minutes >= 1.5 else f"{max(seconds, 1.0):.0f} s"
    return f"{100.0 * part:.0f} % of the work done, some {left} left"
