"""Base class of optional tallies, which are declared in `state.tally`.

A run requests a tally with an instance of its class, which contains the settings of the tally. On the command
line and in configs, the settings are text. `Engine.tallies` contains the names of the tallies that an engine
supports. Such an engine has a part (`engines.features.part.TallyPart`) with the name of the tally.
"""

from __future__ import annotations

from dataclasses import MISSING, asdict, dataclass, fields
from typing import TYPE_CHECKING, ClassVar, Self

from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


@dataclass(frozen=True)
class OptionalTally:
    """Base class of tallies that only some runs have.

    Attributes
    ----------
    name : str
        Name of the tally in messages and files, and value of `only` in the metadata of its fields in `Tally`
    meaning, form : str
        Description of the option that requests the tally, and form of the text of this option: the settings
        in their order, separated by colons. Both are "" for a tally that has no option.
    fact : str
        Name of a property of scenes: if the property is true, all runs of the scene have the tally. The name
        is "" for a tally that must be requested.
    """

    name: ClassVar[str]
    meaning: ClassVar[str] = ""
    form: ClassVar[str] = ""
    fact: ClassVar[str] = ""

    @classmethod
    def from_text(cls, text: str) -> Self:
        """Return the tally that the text of its option describes. Raises SceneError if the text is
        invalid.
        """
        readers = {"str": str, "int": int, "float": float}
        parts, keys = str(text).split(":"), fields(cls)
        least = sum(item.default is MISSING for item in keys)
        try:
            settings = [readers[str(item.type)](part) for item, part in zip(keys, parts, strict=False)]
        except ValueError:
            settings = []
        if len(settings) < max(least, len(parts)):
            raise SceneError(cls.name, text, f"must be of the form {cls.form}")
        return cls(*settings)

    def to_text(self) -> str:
        """Return the text of the tally's option, the inverse of `from_text`."""
        return ":".join(map(str, asdict(self).values()))

    @property
    def option(self) -> str:
        """Option of `gaspart run` that requests the tally, with its text."""
        return f"--{self.name.replace('_', '-')} {self.to_text()}"

    def check(self, scene: Scene) -> None:
        """Raise SceneError if the tally is not defined for a scene."""
        self._require(scene)

    def _require(self, scene: Scene) -> None:
        """Raise SceneError under the conditions of `check`, by the rule of this class."""
