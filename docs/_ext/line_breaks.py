"""Sphinx extension that lets long names in code break behind a separator, so that tables fit a narrow screen."""

import re
from typing import Any

from sphinx.application import Sphinx

_NAME = re.compile(r'(?<=<span class="pre">)[^<]+(?=</span>)')
_SEPARATOR = re.compile(r"(?<=\w[_./=])(?=\w)")


def allow_breaks(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: object) -> None:
    """Mark the places where inline code may break."""
    if "body" in context:
        context["body"] = _NAME.sub(lambda name: _SEPARATOR.sub("<wbr>", name[0]), context["body"])


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("html-page-context", allow_breaks)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
