"""Logger plugin of Snakemake that adds the time left, under the name by which Snakemake finds it."""

from __future__ import annotations

from logging import LogRecord, getLogger
from math import inf

from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from gaspart.reproduction.progress import TimeLeft, describe

_BETWEEN = 10.0  # seconds between two lines
_LOGGER = getLogger("snakemake.logging")


class LogHandler(LogHandlerBase):
    """Writes the time left after Snakemake's own lines, at most every ten seconds."""

    writes_to_stream = False  # Snakemake goes on to write its own lines
    writes_to_file = False
    has_filter = True  # the begin of a step counts also where Snakemake does not print it
    has_formatter = True
    needs_rulegraph = False

    def __post_init__(self) -> None:
        self._time_left = TimeLeft()
        self._latest = -inf

    def emit(self, record: LogRecord) -> None:
        fields, now = record.__dict__, record.created
        event = fields.get("event")
        if event == LogEvent.RUN_INFO:
            self._time_left.plan({rule: n for rule, n in fields["stats"].items() if rule != "total"})
        elif event == LogEvent.JOB_INFO:
            self._time_left.start(fields["jobid"], fields["rule_name"], now)
        elif event == LogEvent.JOB_FINISHED:
            self._time_left.end(fields["job_id"], now)
        elif event == LogEvent.PROGRESS and fields["done"] < fields["total"]:
            if now > self._latest + _BETWEEN:
                self._latest = now
                # by Snakemake's own handlers, which write whole lines
                _LOGGER.info(describe(*self._time_left.seconds(now)))
