"""The documentation site: `make docs`. Its generated pages are written by pages.py."""

import sys
from pathlib import Path

import gaspart

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(Path(__file__).parent), str(ROOT / "tools")]

project = "gaspart"
version = release = gaspart.__version__
author = "The gaspart developers"
copyright = "The gaspart developers, BSD 3-Clause licence"
language = "en"

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "pages",
    "numpydoc",
    "myst_nb",
    "sphinx_copybutton",
    "mathml",
]
exclude_patterns = ["README.md"]
default_role = "py:obj"  # `name` in a docstring is a link where there is one

html_math_renderer = "mathml"
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True}
python_use_unqualified_type_names = True
numpydoc_show_class_members = False  # autodoc lists them
add_module_names = False
toc_object_entries_show_parents = "hide"

# Notebooks are executed, once for each version of their text.
nb_execution_mode = "cache"
nb_execution_cache_path = str(ROOT / "results/docs/notebooks")
nb_execution_timeout = 600
nb_execution_raise_on_error = True
nb_execution_in_temp = True

LOOK = {
    "font-stack": "system-ui, sans-serif",
    "color-background-primary": "var(--page)",
    "color-background-secondary": "var(--shade)",
    "color-background-border": "var(--line)",
    "color-foreground-primary": "var(--ink)",
    "color-foreground-secondary": "var(--soft)",
    "color-brand-primary": "var(--accent)",
    "color-brand-content": "var(--accent)",
}  # of style.css, which report, `view` and `play` share
html_theme = "furo"
html_title = f"gaspart {release}"
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "navigation_with_keys": True,
    "light_css_variables": LOOK,
    "dark_css_variables": LOOK,
}
html_static_path = ["static", "../src/gaspart/rendering/style.css"]
html_css_files = ["style.css", "site.css"]
# pages of `gaspart play`
html_extra_path = [str(extra)] if (extra := ROOT / "results/docs/extra").is_dir() else []
copybutton_prompt_text = "$ "
