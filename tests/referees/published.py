"""Numbers that others have published: our deviation from them, in our and in their uncertainty."""

import json
import math

from finding import SIGMA, Finding


def rows(folder):
    return json.loads((folder / "published.json").read_text())


def compared(folder, which):
    """The distance in the standard uncertainty of the difference."""
    row = rows(folder)[which]
    digits = 1 - math.floor(math.log10(row["error"]))
    ours = f"{row['ours']:.{digits}f} ± {row['error']:.{digits}f}"
    theirs = f"{row['theirs']:.7g} ± {row['their_error']:.2g}"
    distance = abs(row["ours"] - row["theirs"]) / math.hypot(row["error"], row["their_error"])
    return Finding(ours, theirs, distance, 3.0, SIGMA)


def deviations(folder):
    """Ours minus theirs in our and in their standard uncertainty, by what is compared."""
    found = {}
    for row in rows(folder):
        difference = row["ours"] - row["theirs"]
        found[row["what"]] = tuple(f"{difference / row[by]:+.1f}" for by in ("error", "their_error"))
    return found
