"""Settings of Sphinx for the site that `make site` builds; `build.py` collects the pages."""

from coral import __version__

project = "CORAL"
author = "The CORAL authors"
release = version = __version__
root_doc = "index"
default_role = "code"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]

html_theme = "furo"  # light and dark, by the reader's setting
html_title = "CORAL"
html_show_copyright = False

myst_heading_anchors = 4
autodoc_typehints = "description"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
napoleon_google_docstring = True
suppress_warnings = ["ref.python"]  # names of attributes occur in several classes; they are no links
