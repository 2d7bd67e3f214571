"""Base class of optional tallies, which are declared in `state.tally`.

A run requests a tally by an instance of its class, with its settings. On the command line and in configs, the
settings are text. An engine that can make the tally has the tally's name in `Engine.tallies`. It has a part
(`engines.features.part.TallyPart`) of the same name.
"""

from __future__ import annotations

from dataclasses import MISSING, asdict, dataclass, fields
from typing import TYPE_CHECKING, ClassVar, Self

from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


@dataclass(frozen=True)
class OptionalTally:
    """Tally that not every run has.

    Attributes
    ----------
    name : str
        Name in messages, in files, and as `only` in the metadata of its fields of `Tally`.
    meaning, form : str
        Description of the option of a run that requests the tally, and the form of its text: the settings in
        their order, separated by colons. Both are "" without such an option.
    fact : str
        Name of a property of scenes. If it is true, all runs of the scene have the tally. It is "" if the
        tally must be requested.
    """

    name: ClassVar[str]
    meaning: ClassVar[str] = ""
    form: ClassVar[str] = ""
    fact: ClassVar[str] = ""

    @classmethod
    def from_text(cls, text: str) -> Self:
        """Make the tally from the text of its option.

        Parameters
        ----------
        text : str
            Text in the `form` of the tally.

        Returns
        -------
        OptionalTally
            Tally.

        Raises
        ------
        SceneError
            If the text is invalid.
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
        """Raise SceneError if no engine can make the tally for a scene.

        Parameters
        ----------
        scene : Scene
            Scene to check.
        """
        self._require(scene)

    def _require(self, scene: Scene) -> None:
        """Raise SceneError for such a scene; every class implements its own rule here."""
