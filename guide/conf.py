"""The guide's settings: Sphinx with Markdown, and the docstrings of the Python package. `ci/guide` builds it."""

project = "featherbench"
copyright = "the authors of featherbench"  # Sphinx's name
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
source_suffix = {".md": "markdown"}
myst_heading_anchors = 3
html_theme = "alabaster"
html_theme_options = {"description": "dynamics of robots: a library and a benchmark", "page_width": "1240px", "sidebar_width": "240px"}
html_sidebars = {"**": ["about.html", "navigation.html", "searchbox.html"]}
html_show_sourcelink = False
html_static_path = ["_static"]
html_css_files = ["guide.css"]
napoleon_google_docstring = False
autodoc_typehints = "none"
# A link that leads nowhere, or a name that is not there, is an error (`sphinx-build -W`).
nitpicky = False
