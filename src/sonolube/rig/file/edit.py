"""Replacement of tables in the text of a rig file, which keeps its comments."""

import re
import tomllib

from sonolube.rig.file.reader import rig_from

_HEADING = re.compile(r"^\[\[?([\w.]+)\]", re.MULTILINE)


def with_tables(text: str, tables: str) -> str:
    """Text of a rig file with some of its tables replaced.

    Parameters
    ----------
    text : str
        The file.
    tables : str
        The tables that take the place of those of the same name, or come last before `assumptions`.

    Returns
    -------
    str

    Raises
    ------
    InvalidInput
        If what comes out is no rig.
    """
    replaced = set(_HEADING.findall(tables))
    if "structure" in replaced:  # a table of one kind leaves nothing of another kind behind
        replaced |= {name for name, _ in _parts(text) if name.startswith("structure.")}
    kept = [(name, part) for name, part in _parts(text) if name not in replaced]
    last = [part for name, part in kept if name == "assumptions"]
    rest = [part for name, part in kept if name != "assumptions"]
    result = "".join([*(part.rstrip() + "\n\n" for part in rest), tables.rstrip() + "\n\n", *last]).rstrip() + "\n"
    rig_from(tomllib.loads(result))
    return result


def _parts(text: str) -> list[tuple[str, str]]:
    headings = list(_HEADING.finditer(text))
    ends = [heading.start() for heading in headings[1:]] + [len(text)]
    tables = [(heading[1], text[heading.start() : end]) for heading, end in zip(headings, ends, strict=True)]
    return [("", text[: headings[0].start()] if headings else text), *tables]
