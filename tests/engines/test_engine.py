"""What an engine owes its callers: a new one registers itself, and is known wherever engines are."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import gaspart as gp
from gaspart.engines import ENGINES
from gaspart.scene.features import FEATURES

TOOLS = str(Path(__file__).parents[2] / "tools")
SKELETON = """
from dataclasses import dataclass, field
from typing import ClassVar

from gaspart.engines import Engine, register
from gaspart.keys import declare, positive


@register
@dataclass(frozen=True)
class Skeleton(Engine):
    stride: float = field(metadata=declare(positive("how far the skeleton walks")))

    name: ClassVar[str] = "skeleton"
    title: ClassVar[str] = "skeleton"

    def start(self, scene, state, seed=0, tallies=()):
        self.check_features(scene)
        return None
"""
KNOWN = """
from contextlib import suppress
import reference
import gaspart as gp
from gaspart.cli import main
from gaspart.reproduction.config import schema
config = schema()["properties"]["experiments"]["additionalProperties"]["properties"]
assert "skeleton" in config["point"]["properties"]["engine"]["enum"]
assert config["point"]["properties"]["stride"]["description"] == "how far the skeleton walks; required"
assert any("Point: engine `skeleton`" in page for page in reference.pages().values())
with suppress(SystemExit):
    main(["run", "--help"])
scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(1, 0.5, temperature=1.0)])
assert gp.Simulation(scene, Skeleton(stride=1.0), 1).engine.name == "skeleton"
"""

CONTAINER = gp.Container((20.0, 20.0))
AROUND = gp.Container((20.0, 20.0), "periodic")
DISCS = gp.Species(3, 0.5, temperature=1.0)
WITH = {
    "gravity": {"gravity": (0.0, -1.0)},
    "restitution": {"restitution": gp.Restitution(normal=0.9)},
    "roughness": {"restitution": gp.Restitution(tangential=0.5)},
    "viscoelasticity": {"restitution": gp.Restitution(normal=0.9, reference_speed=1.0)},
    "contact_duration": {"restitution": gp.Restitution(normal=0.9, contact_duration=0.1)},
    "thermostat": {"thermostat": gp.Thermostat(power=1.0, interval=0.1)},
    "walls": {"walls": [gp.Wall((5.0, 5.0), (9.0, 9.0))]},
    "fixed": {"particles": [gp.Particle((5.0, 5.0), (0.0, 0.0), radius=0.5, fixed=True)]},
    "vibrations": {"particles": [gp.Particle((5.0, 5.0), (0.0, 0.0), radius=0.5, fixed=True, vibration=1.0)]},
    "polydispersity": {"species": [gp.Species(3, 0.5, temperature=1.0, polydispersity=0.1)]},
    "centres_to_walls": {"centres_to_walls": True},
    "thermal_walls": {"walls": [gp.Wall((5.0, 5.0), (9.0, 9.0), temperature=1.0)]},
    "moving_wall": {"walls": [gp.Wall((5.0, 0.0), (5.0, 20.0), mass=5.0)]},
    "thermal": {"faces": {"x_low": gp.Thermal(1.0)}},
    "accommodation": {"faces": {"x_low": gp.Thermal(1.0, accommodation=0.5)}},
    "ramp": {"faces": {"x_low": gp.Thermal({"y_low": 1.0, "y_high": 2.0})}},
    "sliding": {"faces": {"x_low": gp.Thermal(1.0, velocity=(0.0, 1.0))}},
    "well": {"faces": {"x_low": gp.Well(1.0, 0.5)}},
    "sticky": {"faces": {"x_low": gp.Sticky(1.0)}},
    "vibrating": {"faces": {"x_low": gp.Vibrating(0.1, 1.0)}},
    "lees_edwards": {"container": AROUND, "faces": {"y_high": gp.LeesEdwards(1.0)}},
    "piston": {"faces": {"x_low": gp.Piston(1.0, 0.1)}},
    "open": {"faces": {"x_low": gp.Open()}, "centres_to_walls": True},
}


def scene_with(parts):
    return gp.Scene(**({"container": CONTAINER, "species": [DISCS]} | parts))


def test_a_new_engine_appears_in_the_command_line_the_schema_and_the_reference():
    path = os.pathsep.join(filter(None, [TOOLS, os.environ.get("PYTHONPATH")]))
    command, environment = [sys.executable, "-c", SKELETON + KNOWN], os.environ | {"PYTHONPATH": path}
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    assert "or skeleton" in done.stdout and "--stride" in done.stdout


def test_every_feature_has_a_scene():
    assert set(WITH) == set(FEATURES)
    for name, parts in WITH.items():
        assert name in scene_with(parts).features, name
    assert not gp.Scene(CONTAINER, [DISCS]).features


@pytest.mark.parametrize("name", FEATURES)
@pytest.mark.parametrize("engine", ENGINES.values(), ids=ENGINES)
def test_an_engine_refuses_what_it_does_not_model_and_names_one_that_does(engine, name):
    scene = scene_with(WITH[name])
    settings = engine(time_step=0.01) if "time_step" in engine.__dataclass_fields__ else engine()
    missing = scene.features - engine.models
    if missing:
        with pytest.raises(gp.SceneError, match='needs the "event"') as refused:
            settings.check_features(scene)
        face = f".{next(iter(scene.faces), '')}"
        assert refused.value.key.removesuffix(face) in {FEATURES[one].key for one in missing}
    else:
        settings.check_features(scene)
