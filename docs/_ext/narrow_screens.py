"""Sphinx extension for narrow screens: long names in code may break, and wide tables can be stacked cell by cell."""

import re
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

_NAME = re.compile(r'(?<=<span class="pre">)[^<]+(?=</span>)')
_SEPARATOR = re.compile(r"(?<=\w[_./=])(?=\w)")
_MAX_COLUMNS = 4  # that fit a phone side by side


def allow_breaks(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: object) -> None:
    """Mark the places where inline code may break."""
    if "body" in context:
        context["body"] = _NAME.sub(lambda name: _SEPARATOR.sub("<wbr>", name[0]), context["body"])


def label_cells(app: Sphinx, doctree: nodes.document, page: str) -> None:
    """Give the cells of wide tables the heads of their columns, which are shown where cells are stacked."""
    for table in doctree.findall(nodes.table):
        heads = [entry.astext() for head in table.findall(nodes.thead) for entry in head.findall(nodes.entry)]
        if len(heads) > _MAX_COLUMNS:
            table["classes"].append("stacked")
            for row in (row for body in table.findall(nodes.tbody) for row in body.findall(nodes.row)):
                for head, entry in zip(heads, row.children, strict=False):
                    if head and entry.children:
                        entry.insert(0, nodes.inline(text=head, classes=["head-of-column"]))


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("html-page-context", allow_breaks)
    app.connect("doctree-resolved", label_cells)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
