"""Parsing of numbers in text with either decimal sign."""

import math
import re
from collections.abc import Iterable

import numpy as np

from sonolube.checks import Floats

_DECIMAL_NUMBER = re.compile(r"(?=[-+]?[.,]?\d)[-+]?\d*([.,])\d*(?:[eE][-+]?\d+)?", re.ASCII)
_EVIDENCE = 50  # decimal numbers by which the sign is told


def detected_decimal_sign(cells: Iterable[str]) -> str:
    """Decimal sign, "." or ",", that the first decimal numbers among cells of text have more often.

    "." where no cell has a decimal sign.
    """
    commas = points = 0
    for cell in cells:
        if ("," in cell or "." in cell) and (match := _DECIMAL_NUMBER.fullmatch(cell.strip())):
            commas, points = commas + (match[1] == ","), points + (match[1] == ".")
            if commas + points >= _EVIDENCE:
                break
    return "," if commas > points else "."


def parse_number(cell: str, *, decimal_sign: str) -> float | None:
    """Number in a cell of text, or None where it holds none."""
    text = cell.strip()
    if decimal_sign == ",":
        if "." in text:
            return None
        text = text.replace(",", ".")
    if "_" in text:  # float() accepts 1_000, which no instrument writes
        return None
    try:
        value = float(text)
    except ValueError:
        return None
    return value if text.isascii() else None


def parse_numbers(cells: list[str], *, decimal_sign: str, missing: frozenset[str]) -> tuple[Floats, int | None]:
    """Numbers of a column of text, and the first row that holds neither a number nor a missing-value text.

    `values`: NaN for missing values; only the rows before `invalid_row` where there is one.
    """
    values = np.empty(len(cells))
    for row, cell in enumerate(cells):
        value = parse_number(cell, decimal_sign=decimal_sign)
        if value is None:
            stripped = cell.strip()
            if stripped and stripped not in missing:
                return values[:row], row
            value = math.nan
        values[row] = value
    return values, None
