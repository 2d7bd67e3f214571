"""The two ways in which gaspart says no."""


class SceneError(ValueError):
    """What was asked for cannot be: one line that names the key, the value and the rule it breaks."""

    def __init__(self, key: str, value: object, rule: str, file: str | None = None) -> None:
        self.key, self.value, self.rule, self.file = key, value, rule, file
        where = f"{file}: " if file else ""
        super().__init__(f"{where}{key} = {value!r}: {rule}")

    def __reduce__(self) -> tuple:
        return (type(self), (self.key, self.value, self.rule, self.file))

    def inside(self, prefix: str, file: str | None = None) -> "SceneError":
        """The same complaint seen from the enclosing mapping (`species[1].radius`) or file."""
        key = f"{prefix}.{self.key}" if prefix else self.key
        return SceneError(key, self.value, self.rule, file or self.file)


class SimulationError(RuntimeError):
    """A run broke one of its invariants, or cannot go on; the last good state is kept by the caller."""
