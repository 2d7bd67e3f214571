"""How the tests are run: which random scenes hypothesis draws, and how several processes share the work."""

from pathlib import Path

import pytest
from hypothesis import settings

# The same scenes every time, or new ones with `--hypothesis-profile=search`.
settings.register_profile("fixed", max_examples=50, derandomize=True, deadline=None)
settings.register_profile("search", max_examples=1000, deadline=None)
settings.load_profile("fixed")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Keep a file's tests together, since they share compiled kernels, and the workflow's, since they share
    a run of it; begin with the workflow, which takes longest."""
    here = Path(__file__).parent
    for item in items:
        part = item.path.relative_to(here).parts
        item.add_marker(pytest.mark.xdist_group("workflow" if part[0] == "workflow" else "/".join(part)))
    items.sort(key=lambda item: item.path.relative_to(here).parts[0] != "workflow")
