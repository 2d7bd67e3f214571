"""Pages of the reference, from the declarations of all keys; `make docs` makes them."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from gaspart.analysis.declaration import DIMENSIONS
from gaspart.analysis.observables import ALIASES, OBSERVABLES
from gaspart.engines import ENGINES
from gaspart.keys import Kind
from gaspart.reproduction import registry
from gaspart.reproduction.config import scene_schema, schema
from gaspart.reproduction.points import point_keys
from gaspart.reproduction.points import points as config_keys
from gaspart.scene.features import EXCLUDED, FEATURES

_ENDS = {"exclusiveMinimum": "> ", "minimum": "≥ ", "exclusiveMaximum": "< ", "maximum": "≤ "}
_TYPES = {"array": "list", "boolean": "`true` or `false`", "integer": "whole number", "object": "mapping"}
_TYPES |= {"string": "text"}
_INTRODUCTION = """# Reference

Keys, features and observables, from their declarations in the code. For editors, the same rules
as JSON schemas: {download}`scene files <scene.schema.json>`, {download}`configs <config.schema.json>`.

"""
_KEYS = "A key without a default is required. A default of *none* means that the key is absent.\n"


def pages() -> dict[str, str]:
    """Return the text of each page and schema of the reference, by its path in `docs/generated`."""
    texts, index = {}, _INTRODUCTION
    for name, page in _PAGES.items():
        start = f"# {page.title}\n\n{page.about} {page.more}\n"
        texts[f"reference/{name}.md"] = "\n".join([start, *page.content()])
        index += f"- [{page.title}]({name}.md): {page.about}\n"
    for name, content in (("config", schema()), ("scene", scene_schema())):
        texts[f"reference/{name}.schema.json"] = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    names = "".join(f"{name}\n" for name in _PAGES)
    return {**texts, "reference/index.md": f"{index}\n```{{toctree}}\n:hidden:\n\n{names}```\n"}


def _scene_keys() -> list[str]:
    """Describe the keys of a scene file, then the keys of each mapping in it."""
    scene = scene_schema()
    parts = [_KEYS, "## Scene file\n", _table(scene["properties"])]
    for name, part in _parts(scene):
        parts += [f"## {name}\n\n{part['description']}\n", _table(part["properties"])]
    return parts


def _experiment_keys() -> list[str]:
    """Describe the keys of a config, except the keys for figures."""
    parts = [_KEYS, "## Config\n", _table(_outline(schema()["properties"]))]
    for title, table in {
        "Experiment": _outline(config_keys.EXPERIMENT),
        "Point: one species in a container (exactly three of the first four)": point_keys.EXTENTS
        | point_keys.GAS,
        "Point: a scene file": point_keys.SCENE_FILE,
        "Point: engine": point_keys.ENGINE,
        **{f"Point: engine `{name}`": table for name, table in point_keys.ENGINE_KEYS.items()},
        "Point: length (exactly one of them)": point_keys.LENGTHS,
        "Point: run": config_keys.RUN,
        "Animation": config_keys.ANIMATION,
    }.items():
        parts += [f"## {title}\n", _table(table)]
    return parts


def _figure_keys() -> list[str]:
    """Describe the settings of figures: first figures of other names, then gaspart's figures."""
    parts = [_KEYS]
    for kind, settings in registry.kinds().items():
        claims = settings["claims"]["items"]["properties"]
        parts += [f"## A figure of one's own, `kind: {kind}`\n", _table(_outline(settings))]
        parts += ["### Its claims\n", _table(claims)]
    for figure, settings in registry.settings().items():
        if settings:
            parts += [f"## `{figure}`\n", _table(settings)]
    return parts


def _features() -> list[str]:
    return [_models(), "## What excludes what\n", _describe_exclusions()]


def _models() -> str:
    """Describe the features of a scene that each engine models."""
    rows = [f"| feature | {' | '.join(ENGINES)} |", f"| --- |{' --- |' * len(ENGINES)}"]
    for name, feature in FEATURES.items():
        marks = ("yes" if name in engine.models else "" for engine in ENGINES.values())
        rows.append(f"| {feature.meaning} | {' | '.join(marks)} |")
    for engine in ENGINES.values():
        for pair in engine.excludes:
            first, second = (FEATURES[name].meaning for name in pair)
            rows += ["", f"Not together with engine `{engine.name}`: {first} and {second}."]
    return "\n".join([*rows, ""])


def _observables() -> list[str]:
    """Return each named observable, with its declaration."""
    heads = (
        "name",
        "also",
        "meaning",
        "units",
        "result",
        "selections",
        "needs of a run",
        "conditions",
        "not by",
    )
    heads += ("theory", "`--until`")
    rows = [f"| {' | '.join(heads)} |", f"|{' --- |' * len(heads)}"]
    for name, observable in OBSERVABLES.items():
        along = ", ".join(DIMENSIONS[dim].meaning for dim in observable.along)
        where = " ".join((condition.__doc__ or "").split("\n")[0] for condition in observable.conditions)
        cells = (
            f"`{name}`{f' ({observable.symbol})' if observable.symbol else ''}",
            ", ".join(f"`{alias}`" for alias, other in ALIASES.items() if other == name),
            observable.definition,
            f"`{observable.units}`",
            f"by {along}" if along else "number",
            ", ".join(f"`{key}`" for key in observable.selections),
            observable.needs,
            where,
            ", ".join(f"`{equation}`" for equation in observable.nothing),
            "yes" if observable.theory else "",
            "yes" if observable.ends_runs else "",
        )
        rows.append(f"| {' | '.join(cells)} |")
    return ["\n".join([*rows, ""])]


def _describe_exclusions() -> str:
    """Describe the features that exclude each other in every scene."""
    rows = ["| feature | excludes | why |", "| --- | --- | --- |"]
    for (first, second), reason in EXCLUDED.items():
        rows.append(f"| {FEATURES[first].meaning} | {FEATURES[second].meaning} | {reason} |")
    return "\n".join([*rows, ""])


def _parts(scene: Kind) -> list[tuple[str, Kind]]:
    """Return the mappings inside a scene file, with their titles."""
    titled: dict[str, Kind] = {}
    queue = list(scene["properties"].values())
    while queue:
        kind = queue.pop(0)
        if "title" in kind:
            titled[kind["title"]] = kind
        inner = [kind[name] for name in ("items", "additionalProperties") if isinstance(kind.get(name), dict)]
        queue += [*kind.get("properties", {}).values(), *kind.get("anyOf", ()), *inner]
    return list(titled.items())


def _outline(table: dict[str, Kind]) -> dict[str, Kind]:
    """Return a table of keys without the keys inside mappings, which have separate tables."""
    return {name: kind.stating(properties={}) for name, kind in table.items()}


def _table(kinds: dict[str, Kind]) -> str:
    rows = ["| key | value | default | meaning |", "| --- | --- | --- | --- |"]
    for name, kind in kinds.items():
        default = _default(kind["default"]) if "default" in kind else ""
        rows.append(f"| `{name}` | {in_words(kind)} | {default} | {kind.get('description', '')} |")
    return "\n".join([*rows, ""])


def _default(value: Any) -> str:
    return "*none*" if value is None else f"`{json.dumps(value)}`"


def in_words(kind: Kind) -> str:
    """Describe the allowed values of a key in words.

    An example is `number > 0 and ≤ 0.1, or list of 2 to 3`.
    """
    if "title" in kind:
        return kind["title"]
    if "const" in kind:
        return f"`{kind['const']}`"
    if "enum" in kind:
        return ", ".join(f"`{value}`" for value in kind["enum"] if value is not None)
    if "anyOf" in kind:
        return " or ".join(dict.fromkeys(map(in_words, kind["anyOf"])))
    declared = kind.get("type", "anything")
    types = [name for name in ([declared] if isinstance(declared, str) else declared) if name != "null"]
    return " or ".join(_describe_type(kind, name) for name in types)


def _describe_type(kind: Kind, name: str) -> str:
    """Describe one of the types of a kind, with its rules."""
    noun = _TYPES.get(name, name)
    if name in ("number", "integer"):
        rules = [f"{sign}{kind[end]:.10g}" for end, sign in _ENDS.items() if end in kind]
        return f"{noun} {' and '.join(rules)}".rstrip()
    if name == "object" and kind.get("properties"):
        return "mapping of " + ", ".join(
            f"`{key}` ({in_words(item)})" for key, item in kind["properties"].items()
        )
    if name != "array":
        return noun
    minimum, maximum = kind.get("minItems", 0), kind.get("maxItems")
    if maximum == 0:
        return "empty list"
    size = "" if maximum is None else f" {maximum}" if minimum == maximum else f" {minimum} to {maximum}"
    item = f" ({in_words(kind['items'])})" if "items" in kind else ""
    return f"{noun} of{size} values{item}" if size else f"{noun}{item}"


@dataclass(frozen=True)
class _Page:
    """Page of the reference.

    A page has a title, a subject that the index repeats, a longer description, and a function that returns
    the parts of the page.
    """

    title: str
    about: str
    more: str
    content: Callable[[], list[str]]


_PAGES = {
    "scene": _Page(
        "Keys of a scene file",
        "What `gaspart run` and `gp.Scene.from_file` read.",
        "[Scene files](../../scenes.md) has an example of each.",
        _scene_keys,
    ),
    "engines": _Page(
        "Features and engines",
        "Which engine models what, and which features exclude each other.",
        "All engines model any number of species, whose radii and masses may differ.",
        _features,
    ),
    "observables": _Page(
        "Observables",
        "What `gaspart measure`, `gp.sweep`, `gaspart advise` and figures of one's own know by name.",
        """Units are of
length, mass, time and energy with k_B = 1, d the dimension. A scene that breaks a condition is refused
before a run. Theory is that of the equation that the engine of a run solves: of particles that touch, or of
the Boltzmann or the Enskog equation.""",
        _observables,
    ),
    "config": _Page(
        "Keys of a config",
        "Experiments, points, engines, runs and films of the workflow.",
        "[The workflow](../../workflow.md) explains them.",
        _experiment_keys,
    ),
    "figures": _Page(
        "Keys of figures",
        "Settings of figures in a config.",
        "Each figure also has `experiments`, whose points it measures.",
        _figure_keys,
    ),
}
