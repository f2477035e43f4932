"""Numbers written as text, with either decimal sign."""

import math

import numpy as np

from sonolube.checks import Floats


def parse_number(cell: str, *, decimal_sign: str) -> float | None:
    """Return the number a cell holds, or None where it holds none.

    Parameters
    ----------
    cell : str
        As written.
    decimal_sign : str
        "." or ","; the other one is refused, so that thousands are never taken for decimals.

    Returns
    -------
    float or None
    """
    text = cell.strip()
    if decimal_sign == ",":
        if "." in text:
            return None
        text = text.replace(",", ".")
    if "_" in text:  # Python reads 1_000; no instrument writes it
        return None
    try:
        value = float(text)
    except ValueError:
        return None
    return value if text.isascii() else None


def parse_numbers(cells: list[str], *, decimal_sign: str, missing: frozenset[str]) -> tuple[Floats, int | None]:
    """Return the numbers of a column, and the first row that holds neither a number nor a text for none.

    Parameters
    ----------
    cells : list of str
        As written.
    decimal_sign : str
        "." or ",".
    missing : frozenset of str
        Texts that stand for no value.

    Returns
    -------
    values : ndarray, shape (rows,)
        NaN for no value.
    wrong : int or None
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
