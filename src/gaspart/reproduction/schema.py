"""The JSON schemas of a config and of a scene file, from the declarations of their keys."""

from __future__ import annotations

from functools import cache

from gaspart.keys import Kind, choice, names, record
from gaspart.reproduction.families import registry
from gaspart.reproduction.points import config_keys

_DRAFT = "https://json-schema.org/draft/2020-12/schema"
_EXPERIMENTS = names("the experiments whose points the figure is made of, in this order")


@cache
def schema(installed: tuple[tuple[str, str], ...] = ()) -> Kind:
    """The JSON schema of a config. Scenes and engines are validated by themselves when a point makes them.

    installed: figures of the config whose kind another installed package brings, each with its kind.
    """
    figures = {
        figure: record({"experiments": _EXPERIMENTS, **settings})
        for figure, settings in registry.settings().items()
    }
    figures |= {figure: _of_kind(kind) for figure, kind in installed}
    (own,) = map(_of_kind, registry.kinds())
    return Kind({"$schema": _DRAFT, **record(config_keys.config(figures, own))})


def _of_kind(kind: str) -> Kind:
    """The entry of a figure with a name of one's own."""
    stated = choice("the kind of a figure with a name of one's own", kind)
    return record({"kind": stated, "experiments": _EXPERIMENTS, **registry.settings_of_kind(kind)})


def scene_schema() -> Kind:
    """The JSON schema of a scene file; rules that concern several keys are not part of it."""
    from gaspart.keys import schema_of
    from gaspart.scene.scene import Scene

    return Kind({"$schema": _DRAFT, **schema_of(Scene)})
