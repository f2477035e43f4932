"""Columns by label, those of one label by their numbers."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeVar

from sonolube.errors import InvalidInput, suggestion

_MAX_LISTED = 12

ColumnT = TypeVar("ColumnT")


def numbered_labels(labels: Sequence[str]) -> list[str]:
    """Labels by which columns are chosen: where several have one label, with " #1", " #2", ... behind it.

    All different, but for empty ones, which name nothing.
    """
    times, taken, numbers = Counter(labels), set(labels), Counter[str]()
    numbered = []
    for label in labels:
        name = label
        while times[label] > 1 and label and name in taken:
            numbers[label] += 1
            name = f"{label} #{numbers[label]}"
        taken.add(name)
        numbered.append(name)
    return numbered


def column_of_label(columns: Mapping[str, ColumnT], label: str, path: Path) -> ColumnT:
    """Column of a label."""
    if label in columns:
        return columns[label]
    of_label = re.compile(re.escape(label) + r" #\d+")
    several = [known for known in columns if of_label.fullmatch(known)]
    if len(several) > 1:
        raise InvalidInput(
            f"{path}: {len(several)} columns are named {label!r}; choose one by its number, {several[0]!r}"
            f" to {several[-1]!r}"
        )
    known = [name for name in columns if name]
    hint = suggestion(label, known) or "it has " + ", ".join(known[:_MAX_LISTED])
    raise InvalidInput(f"{path}: has no column {label!r}; {hint}")
