"""How the documentation is built; nothing in it reaches for the network."""

import sys
from pathlib import Path

import sonolube

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "sonolube"
author = "The sonolube developers"
release = version = sonolube.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx-mathjax-offline",
    "from_source",
    "gallery",
    "narrow_screens",
    "reference_lists",
]
myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
exclude_patterns = ["_ext"]
suppress_warnings = ["ref.python"]  # a name that stands in a room and in its module is linked to the first

autodoc_default_options = {"members": True, "no-value": True}
autodoc_typehints = "none"
autodoc_preserve_defaults = True
napoleon_google_docstring = False
napoleon_use_rtype = False

mathjax3_config = {"options": {"enableMenu": False}}  # the menu offers parts that would come from elsewhere

html_theme = "furo"
pygments_dark_style = "github-dark"
html_title = f"sonolube {release}"
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False
html_extra_path = ["rig.schema.json", "evidence.schema.json"]
html_static_path = ["_static"]
html_css_files = ["custom.css"]
html_theme_options = {"navigation_with_keys": True}
