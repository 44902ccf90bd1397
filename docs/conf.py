"""Sphinx configuration of the documentation; ``make docs`` builds it, with no network."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from symrender.version import VERSION

project = "symrender"
author = "the symrender authors"
copyright = author
release = version = VERSION

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton", "sphinx_design"]
exclude_patterns = ["_build", "_extra", "laboratory/README.md"]
root_doc = "index"
nitpicky = False

html_theme = "furo"
html_title = f"symrender {VERSION}"
html_static_path = ["_static"]
html_css_files = ["style.css"]
html_extra_path = ["_extra"]
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {"sidebar_hide_name": False}

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3
suppress_warnings = ["myst.strikethrough"]

# pages with code run when the site is built, so that every figure on them is of that day; the laboratory's
# notebooks come with the outputs their own run left
nb_execution_mode = "force"
nb_execution_excludepatterns = ["laboratory/*"]
nb_execution_raise_on_error = True
nb_execution_timeout = 1800
nb_merge_streams = True
nb_render_image_options = {"align": "center"}

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
napoleon_google_docstring = False
napoleon_use_rtype = False


def _plain(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Docstrings are prose with literals: what stands outside of them is no markup."""
    for k, line in enumerate(lines):
        line = re.sub(r":(?:func|class|meth):`~?(.*?)`", r"``\1``", line)
        if line.lstrip().startswith(">>>") or (set(line.strip()) == {"-"}):
            continue
        pieces = re.split(r"(``.*?``)", line)
        lines[k] = "".join(p if p.startswith("``") else re.sub(r"([*|_`])", r"\\\1", p) for p in pieces)


def _no_signature_of_a_scene(app: Any, what: str, name: str, *rest: Any) -> tuple[str, None] | None:
    """A scene is read or loaded, not called; its fields are in the schema."""
    return ("", None) if name == "symrender.Scene" else None


_SAID_TO_SCREEN_READERS = (
    (r'(<p class="caption") (role="heading")', r'\1 aria-level="2" \2'),
    (r"<pre(?![^>]*tabindex)", '<pre tabindex="0"'),
    (r'<aside class="(sidebar|toc)-drawer">', r'<aside class="\1-drawer" aria-label="\1">'),
    (r'<div class="table-wrapper', '<div tabindex="0" class="table-wrapper'),
)
"""What the theme and Sphinx leave out: levels of captions, names, keys for what scrolls."""


def _accessible(app: Any, exception: Exception | None) -> None:
    for page in app.env.found_docs if exception is None else ():
        path = Path(app.outdir) / f"{page}.html"
        text = path.read_text("utf-8")
        for found, written in _SAID_TO_SCREEN_READERS:
            text = re.sub(found, written, text)
        path.write_text(text, "utf-8")


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.connect("autodoc-process-signature", _no_signature_of_a_scene)
    # before napoleon reads the sections
    app.connect("autodoc-process-docstring", _plain, priority=400)
    app.connect("build-finished", _accessible)
