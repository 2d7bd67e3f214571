"""The page on which a gas runs: it has the bits of simulations, and works in browsers."""

import pytest
import yaml
from sessions import NODE, in_page, natively, page_data, random_steps

import gaspart as gp
from gaspart.cli import main
from gaspart.cli.new import templates
from gaspart.kernels.compile import webassembly
from gaspart.rendering import play

needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")


def scene_of(name):
    return gp.Scene.from_dict(yaml.safe_load(templates()[name].text))


def lorentz():
    """Light discs among fixed ones: its pages need a single kind of kernels."""
    species = [gp.Species(60, 0.2, temperature=1.0), gp.Species(8, 0.5, fixed=True)]
    return gp.Scene(gp.Container((12.0, 9.0), ("wall", "periodic")), species)


def compared(scene, folder, number, seed, duration):
    """Steps whose results differ between page and simulations, and the number of collisions."""
    data = page_data(scene, folder)
    controls, steps = random_steps(scene, number, seed, duration)
    ours, theirs = in_page(controls, steps, data, folder), natively(controls, steps)
    keys = "digest", "time", "collisions", "hits", "impulse"
    differ = [
        (controls.flags(step["settings"]), key)
        for step, a, b in zip(steps, ours, theirs, strict=True)
        for key in keys
        if a[key] != b[key]
    ]
    return differ, sum(b["collisions"] for b in theirs)


@needs_node
def test_a_page_has_the_bits_of_simulations(tmp_path):
    differ, collisions = compared(lorentz(), tmp_path, 4, 1, 60.0)
    assert not differ
    assert collisions > 5_000


@needs_node
@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", ["gas", "heat", "rough", "chambers"])
def test_pages_of_all_kinds_have_the_bits_of_simulations(name, seed, tmp_path):
    differ, collisions = compared(scene_of(name), tmp_path, 10, seed, 30.0)
    assert not differ
    assert collisions > 10_000


@pytest.mark.thorough
def test_two_builds_of_a_module_have_the_same_bytes():
    controls = play.Controls(lorentz())
    state = play.initial_state(lorentz(), 1)
    image = play._image(lorentz(), controls, "r", state, 1)
    assert webassembly._build([image["kernels"]]) == webassembly._build([image["kernels"]])


def test_a_scene_that_cannot_run_in_a_browser_is_refused_in_one_line(tmp_path, capsys):
    for name in ("spheres", "sheared", "adsorption", "effusion"):
        assert main(["play", "--template", name, "-o", str(tmp_path / "page.html")]) == 2
        printed = capsys.readouterr().err
        assert printed.count("\n") == 1 and "browser" in printed
    assert not list(tmp_path.iterdir())
