"""The small pictures of the figures on the site are those of a complete reproduction, and name it."""

import sys
from pathlib import Path

import netCDF4
import pytest
from PIL import Image

from gaspart.reproduction.families.registry import families

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def module():
    sys.path.insert(0, str(ROOT / "docs"))
    import thumbnails

    yield thumbnails
    sys.path.remove(str(ROOT / "docs"))


@pytest.fixture
def results(tmp_path):
    """Figures of one colour, as a complete reproduction leaves them."""
    for folder in ("figures", "measurements"):
        (tmp_path / folder).mkdir()
    for n, name in enumerate(families()):
        Image.new("RGB", (900, 300 + 20 * n), (4 * n, 0, 0)).save(tmp_path / f"figures/{name}.png")
        with netCDF4.Dataset(tmp_path / f"measurements/{name}.nc", "w") as data:
            data.config, data.git_revision = "full reproduction", "abc"
    return tmp_path


def test_every_figure_has_one_that_names_its_results(module, results):
    module.renew(results, results / "small")
    assert {path.stem for path in (results / "small").iterdir()} == set(families())
    for name in families():
        with Image.open(results / f"small/{name}.webp") as picture:
            assert picture.width == module.WIDTH or picture.height == module.HEIGHT
            assert dict(picture.getexif()).popitem()[1] == "full reproduction, abc"


def test_nothing_is_written_where_a_figure_is_missing(module, results):
    (results / "figures/structure.png").unlink()
    with pytest.raises(ValueError, match="missing"):
        module.renew(results, results / "small")
    assert not (results / "small").exists()


def test_those_that_are_kept_are_of_a_complete_reproduction(module):
    for path in module.FOLDER.glob("*"):
        assert path.stem in families()
        with Image.open(path) as picture:
            assert dict(picture.getexif()).popitem()[1].startswith("full reproduction, ")
