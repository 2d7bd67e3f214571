"""Words of textbooks and other programs, and the names that gaspart has for them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import SequenceMatcher, get_close_matches

from gaspart.errors import OneLine

_LIKE = 0.72
"""Similarity (`difflib`) above which a misspelt word is recognized. Below, other words are as similar."""
_WORDS = {
    "N": ("count",),
    "number": ("count", "sample_interval"),
    "T": ("temperature",),
    "temp": ("temperature",),
    "dt": ("time_step",),
    "diameter": ("radius (half the diameter)",),
    "sigma": ("radius (half the diameter)",),
    "eta": ("packing_fraction",),
    "phi": ("packing_fraction",),
    "density": ("packing_fraction", "activity"),
    "box": ("container", "lengths", "cell_lengths", "Container"),
    "L": ("lengths",),
    "periodic": ("boundary (periodic or wall)", "container (its key boundary)"),
    "gas": ("species",),
    "obstacles": ("walls (or particles that are fixed)",),
    "friction": ("restitution (its key tangential)",),
    "left": ("x_low",),
    "right": ("x_high",),
    "bottom": ("z_low", "y_low"),
    "top": ("z_high", "y_high"),
    "time": ("duration",),
    "interval": ("sample_interval", "samples"),
    "fps": ("frames_per_second",),
    "positions": ("coordinates",),
    "velocity": ("velocities", "speed"),
    "Sphere": ("Particle", "Species"),
    "simulate": ("run",),
    "animate": ("film",),
}
"""Names by word. The first name that is known in a place is meant there; a remark is in parentheses."""


def meant(word: str, candidates: Sequence[str]) -> str:
    """Return the candidate that a word means, or ""."""
    plain = {name: name.rpartition(".")[2].lstrip("-").replace("-", "_") for name in candidates}
    renamed = word.lstrip("-").replace("-", "_").replace("bodies", "particles").replace("body", "particle")
    same = next((name for name in candidates if plain[name] == renamed), "")
    for meaning in _WORDS.get(renamed) or _WORDS.get(renamed.lower(), ()):
        for name in candidates:
            if not same and plain[name] == meaning.split(" ")[0]:
                return meaning.replace(plain[name], name, 1)
    swapped = [name for name in plain.values() if sorted(name) == sorted(renamed)]
    near = swapped or get_close_matches(renamed, list(dict.fromkeys(plain.values())), 2, _LIKE)
    if len(near) > 1 and len({SequenceMatcher(None, name, renamed).ratio() for name in near}) == 1:
        near = []  # as maxwell, of maxwell_pdf and maxwell_cdf
    longer = [name for name in plain.values() if len(renamed) > 3 and name.startswith(renamed)]
    longer = longer if len(longer) == 1 else []
    return same or next((name for name in candidates if plain[name] in (near[:1] or longer)), "")


class MissingName(OneLine, AttributeError):
    """Error for a name that an owner lacks, with the name that is meant."""

    def __init__(self, owner: str, name: str, names: Iterable[str] = ()) -> None:
        meaning = meant(name, list(names))
        remedy = f"; did you mean {meaning}?" if meaning else ""
        super().__init__(f"{owner} has no attribute {name!r}{remedy}")

    def __reduce__(self) -> tuple:
        return (AttributeError, self.args)
