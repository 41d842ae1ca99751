# SPDX-License-Identifier: GPL-3.0-or-later
"""Sphinx configuration of the site. The script build sets EQUIDEM_DOXYGEN (folder of Doxygen's XML), EQUIDEM_VERSION
and the path of the Python module; the sources are those that stage.py has gathered."""

import os
import pathlib
import re

from pygments.lexers.special import TextLexer

project = "equidem"
author = "the authors of equidem"
version = release = os.environ["EQUIDEM_VERSION"]
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax", "sphinx_copybutton",
              "breathe"]
exclude_patterns = ["parts/**", "files/**"]
nitpicky = True
# Types of other libraries, whose pages are not part of the site.
nitpick_ignore_regex = [("py:(class|obj)", r"(?!equidem\.).*|equidem\._.*"), ("cpp:.*", r".*")]
default_role = "code"
smartquotes = False  # they would change --option

myst_enable_extensions = ["dollarmath", "deflist"]
myst_dmath_double_inline = True
myst_heading_anchors = 4
myst_update_mathjax = False
suppress_warnings = ["ref.ref"]  # headers refer to declarations that the C++ page leaves out; links of pages are "myst"

autodoc_typehints = "none"  # docstrings have shapes and units
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_param = False
napoleon_use_rtype = False
napoleon_use_ivar = True

breathe_projects = {"equidem": os.environ["EQUIDEM_DOXYGEN"]}
breathe_default_project = "equidem"
breathe_default_members = ("members", "undoc-members")

html_theme = "furo"
html_title = f"equidem {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_show_sphinx = False
html_show_search_summary = False  # it would fetch pages, which browsers refuse where there is no server
pygments_style = "xcode"  # contrasts of at least 4.5:1, as of the dark one
pygments_dark_style = "github-dark"
copybutton_selector = "div:not(.highlight-text) > div.highlight > pre"  # not output

mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_SVG"
mathjax2_config = {
    "messageStyle": "none",
    "showMathMenu": False,
    "menuSettings": {"zoom": "None"},
    "tex2jax": {"ignoreClass": ".*", "processClass": "math"},
    "SVG": {"scale": 95},
    "fast-preview": {"disabled": True},  # that of Debian 13 leaves the bars of fractions out
}


def setup(app):
    app.add_lexer("csv", TextLexer)
    app.connect("autodoc-process-docstring", hide_colons, priority=400)
    app.connect("autodoc-process-docstring", show_colons, priority=600)
    app.connect("build-finished", mend_theme)


def hide_colons(app, what, name, obj, options, lines):
    """Napoleon (priority 500) takes what precedes the first colon of a property's docstring for its type."""
    if what == "property":
        lines[:] = [line.replace(":", "\0") for line in lines]
    lines[:] = [re.sub(r"^(\s*)m\.$", r"\1In m.", line) for line in lines]  # "m." begins a numbered list


def show_colons(app, what, name, obj, options, lines):
    lines[:] = [line.replace("\0", ":") for line in lines]


def mend_theme(app, failed):
    """Debian's furo takes normalize.css from a server; in Debian 12 its script too, in two modules, and its style sheet
    lacks the dark colours of readers whose system is dark."""
    if failed:
        return
    static = pathlib.Path(app.outdir) / "_static"
    script, spy = static / "scripts/furo.js", static / "scripts/gumshoe-patched.js"
    lines = script.read_text(encoding="utf-8").split("\n")
    if lines[0].startswith("import Gumshoe from"):
        script.write_text(spy.read_text(encoding="utf-8") + "\n".join(lines[1:]), encoding="utf-8")
    sheet = static / "styles/furo.css"
    text = sheet.read_text(encoding="utf-8")
    normal = pathlib.Path("/usr/share/javascript/normalize.css/normalize.css")
    text = text.replace("@import url(/javascript/normalize.css/normalize.css);",
                        normal.read_text(encoding="utf-8") if normal.exists() else "")
    dark = re.search(r'body\[data-theme="dark"\] (\{[^}]*--color-background-primary[^}]*\})', text)
    if dark and "prefers-color-scheme" not in text:
        text += f'@media screen and (prefers-color-scheme: dark) {{ body[data-theme="auto"] {dark.group(1)} }}\n'
    sheet.write_text(text, encoding="utf-8")
