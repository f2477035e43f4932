"""References of docstrings as plain lists with links: numbered footnotes of many functions collide on one page."""

import re

from sphinx.application import Sphinx

_ENTRY = re.compile(r"^(\s*)\.\. \[\d+\] (.)")
_MENTION = re.compile(r"\s*\[\d+\]_")
_DOI = re.compile(r"\bdoi:(10\.\S+[\w)])")


def listed(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Turn each reference into an item of a list, and each DOI into a link."""
    for place, line in enumerate(lines):
        entry = _ENTRY.sub(r"\1*  \\\2", line)  # the backslash keeps initials from reading as numbers of a list
        lines[place] = _DOI.sub(r"`doi:\1 <https://doi.org/\1>`__", _MENTION.sub("", entry))


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect before the reader of numpy docstrings."""
    app.connect("autodoc-process-docstring", listed, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
