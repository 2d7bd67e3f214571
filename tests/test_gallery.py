"""The pictures of the README: figures of a complete reproduction, which name it, and scenes."""

import importlib.util
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).parents[1]


def script(name):
    """A script of docs/ as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / f"docs/{name}.py")
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


@pytest.fixture(scope="module")
def module():
    return script("gallery")


@pytest.fixture
def results(tmp_path, module):
    """Figures of one colour, as a complete reproduction leaves them."""
    for folder in ("figures", "measurements"):
        (tmp_path / folder).mkdir()
    for n, name in enumerate(name for names in module.COLUMNS for name in names):
        Image.new("RGB", (700, 500), (40 * n, 0, 0)).save(tmp_path / f"figures/{name}.png")
        with netCDF4.Dataset(tmp_path / f"measurements/{name}.nc", "w") as data:
            data.config, data.git_revision = "full reproduction", "abc"
    return tmp_path


def test_it_is_made_of_the_figures_and_names_their_results(module, results):
    module.gallery(results, results / "a.png")
    module.gallery(results, results / "b.png")
    assert (results / "a.png").read_bytes() == (results / "b.png").read_bytes()
    with Image.open(results / "a.png") as picture:
        assert picture.text == {"config": "full reproduction", "revision": "abc"}
        first, second = module.COLUMNS.values()
        assert picture.width == first + module.GAP + second
        assert [picture.getpixel((x + 9, 9))[0] for x in (0, first + module.GAP)] == [0, 80]


def test_results_of_another_config_do_not_replace_it(module, results):
    with netCDF4.Dataset(results / "measurements/virial_spheres.nc", "a") as data:
        data.config = "smoke"
    with pytest.raises(ValueError, match="is of 'smoke', not of 'full reproduction'"):
        module.gallery(results, results / "a.png")
    (results / "figures/virial_spheres.png").unlink()
    with pytest.raises(ValueError, match="missing"):
        module.gallery(results, results / "a.png")
    assert not (results / "a.png").exists()


def test_the_picture_that_is_kept_names_its_results():
    with Image.open(ROOT / "docs/gallery.png") as picture:
        assert picture.text["config"] == "full reproduction" and picture.text["revision"]


def test_the_gallery_and_its_picture_follow_from_the_scenes():
    """If not: python docs/contact_sheet.py."""
    contact_sheet = script("contact_sheet")
    assert (ROOT / "docs/gallery.md").read_text(encoding="utf-8") == contact_sheet.page()
    with Image.open(ROOT / "docs/scenes.png") as kept:
        difference = np.abs(np.asarray(kept.convert("RGB"), float) - np.asarray(contact_sheet.sheet(), float))
    assert difference.mean() < 2.0  # of 255: a palette of 256 colours
