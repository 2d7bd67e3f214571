"""Moved to `reproduction.figure`."""

from gaspart.reproduction.figure import (
    COUNTED as COUNTED,
)
from gaspart.reproduction.figure import (
    Pressure as Pressure,
)
from gaspart.reproduction.figure import (
    Series as Series,
)
from gaspart.reproduction.figure import (
    combine as combine,
)
from gaspart.reproduction.figure import (
    kurtosis as kurtosis,
)
from gaspart.reproduction.figure import (
    pressure as pressure,
)
from gaspart.reproduction.figure import (
    reduced_curves as reduced_curves,
)
from gaspart.reproduction.figure import (
    runs as runs,
)
from gaspart.reproduction.figure import (
    series_of as series_of,
)
from gaspart.reproduction.figure import (
    totals as totals,
)
