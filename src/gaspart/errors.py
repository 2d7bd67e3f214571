"""Exceptions for users of gaspart, the format of values in messages, and the word that a user means.

There are two exceptions, `SceneError` and `SimulationError`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from importlib import import_module
from itertools import islice
from types import ModuleType

TYPE_CHECKING = False
if TYPE_CHECKING:  # this module is imported before signals are handled, so it must not import slowly
    from importlib.metadata import EntryPoint

_LONGEST = {"value": 120, "key": 200, "rule": 2000, "file": 1000}
_FIRST_BYTE, _LAST_BYTE = "\udca0", "\udcff"  # bytes 0xa0 to 0xff of a name that is not UTF-8
_ITEMS, _DEPTH, _BITS = 12, 4, 256  # limits in messages: items, nesting, bits of an integer


class OneLine(Exception):
    """Exception whose message describes the error completely, in one line."""

    def _render_traceback_(self) -> list[str]:
        """Return the lines that IPython and notebooks print instead of a traceback."""
        return [f"{type(self).__name__}: {self}"]


class SceneError(OneLine, ValueError):
    """Invalid input: one line with the key, the value and the violated rule.

    For any value, the line contains only printable characters and has a limited length.

    Parameters
    ----------
    key : str
        Key of the value, preceded by the keys of the enclosing mappings, such as "species[1].radius".
    value : object
        The value.
    rule : str
        The rule that the value violates.
    file : str, optional
        File that contains the value.

    Examples
    --------
    >>> import gaspart as gp
    >>> try:
    ...     gp.Species(10, radius=-1.0)
    ... except gp.SceneError as error:
    ...     error.key, error.value
    ('radius', -1.0)
    """

    def __init__(self, key: str, value: object, rule: str, file: str | None = None) -> None:
        self.key, self.value, self.rule, self.file = key, value, rule, file
        where = f"{visible(file, _LONGEST['file'])}: " if file else ""
        text = f"{visible(key, _LONGEST['key'])} = {short_repr(value)}: {visible(rule, _LONGEST['rule'])}"
        super().__init__(where + text)

    def __reduce__(self) -> tuple:
        return (type(self), (self.key, self.value, self.rule, self.file))

    def inside(self, prefix: str, file: str | None = None) -> SceneError:
        """Return this error with the key of the enclosing mapping in front, or with its file.

        Parameters
        ----------
        prefix : str
            Key of the enclosing mapping, such as "species[1]"; "" if there is no such mapping.
        file : str, optional
            File that contains the value. Default: the file of this error.

        Returns
        -------
        SceneError
            The error with the longer key.

        Examples
        --------
        >>> import gaspart as gp
        >>> gp.SceneError("radius", -1.0, "must be positive").inside("species[1]").key
        'species[1].radius'
        """
        key = f"{prefix}.{self.key}" if prefix else self.key
        return SceneError(key, self.value, self.rule, file or self.file)


def unknown_word(name: object, candidates: Iterable[str], kind: str = "key") -> str:
    """Return the rule for a message about an unknown word, with the word that is meant if it is clear."""
    names = list(candidates)
    meaning = meant(str(name), names)
    return f"unknown {kind}; " + (f"did you mean {meaning}?" if meaning else f"known are {', '.join(names)}")


def optional(module: str, extra: str, purpose: str) -> ModuleType:
    """Import an optional package, which belongs to an `extra` of pyproject.toml. If the package is missing,
    SceneError is raised with the `purpose` of the package and the command that installs it.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name not in (module, module.partition(".")[0]):  # one of its imports is missing
            raise
        rule = f"is needed for {purpose} and not installed: pip install 'gaspart[{extra}]'"
        raise SceneError("package", module.partition(".")[0], rule) from None


def entry_points_of(group: str) -> list[EntryPoint]:
    """Return the entry points of a group, in the order of the search path. A package whose list of entry
    points cannot be read is ignored. `importlib.metadata.entry_points` would fail for all packages in this
    case.
    """
    from importlib.metadata import distributions  # takes 0.02 s

    entry_points: list[EntryPoint] = []
    for distribution in distributions():
        try:
            entry_points += [
                entry_point for entry_point in distribution.entry_points if entry_point.group == group
            ]
        except Exception:  # a text from another package may be any object
            continue
    return entry_points


class SimulationError(OneLine, RuntimeError):
    """Violation of an invariant during a run, or a run that cannot continue.

    The caller keeps the last valid state.
    """


def short_repr(value: object) -> str:
    """Format a value as one printable line of at most 120 characters. The computing time is limited for
    values of any size.
    """
    return visible(_repr(value, _DEPTH), _LONGEST["value"])


def _repr(value: object, depth: int) -> str:
    """Format the first items of a value like repr(), but never raise an error."""
    kind = type(value)
    if kind is str or kind is bytes:
        assert isinstance(value, str | bytes)
        return repr(value) if len(value) <= _LONGEST["value"] else f"{value[: _LONGEST['value']]!r}..."
    if kind is int:
        assert isinstance(value, int)
        bits = value.bit_length()
        return repr(value) if bits <= _BITS else f"<an integer of {int(bits * 0.30103) + 1} digits>"
    if kind is dict:
        assert isinstance(value, dict)
        pairs = (f"{_repr(key, 0)}: {_repr(item, depth - 1)}" for key, item in value.items())
        return "{" + _join_items(pairs, len(value), depth) + "}"
    if kind is list or kind is tuple:
        assert isinstance(value, list | tuple)
        inner = _join_items((_repr(item, depth - 1) for item in value), len(value), depth)
        if kind is list:
            return f"[{inner}]"
        return f"({inner},)" if len(value) == 1 else f"({inner})"
    try:
        return repr(value)
    except Exception:  # repr of a user's object may raise any exception
        return f"<{kind.__name__}>"


def _join_items(items: Iterable[str], count: int, depth: int) -> str:
    if count and depth <= 0:
        return "..."
    return ", ".join(islice(items, _ITEMS)) + (", ..." if count > _ITEMS else "")


def visible(text: object, longest: int | None = None, names: bool = False) -> str:
    """Return a text as one line without characters that a terminal would interpret or hide. Line breaks,
    control characters and formatting characters are escaped, including characters that reverse the writing
    direction. All printed text passes through this function, because files may contain text from unknown
    sources. `longest`: maximum number of characters; the middle of a longer text is omitted. `names`: True to
    keep bytes of file names that are not UTF-8, except bytes that are control characters by themselves.
    """
    line = str(text)
    if longest is not None and len(line) > longest:
        tail = longest // 4
        line = f"{line[: longest - tail - 3]}...{line[-tail:]}"
    if line.isprintable():
        return line
    return "".join(
        c if c.isprintable() or (names and _FIRST_BYTE <= c <= _LAST_BYTE) else _escape(c) for c in line
    )


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode()


# Words of textbooks and other programs, and the names that gaspart has for them.


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
    from difflib import SequenceMatcher, get_close_matches  # takes 2 ms

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
