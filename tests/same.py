"""Results of two computations: keys and words are equal, and numbers agree to rounding.

Two ways to one number add its parts in another order, and so do another processor and another number of threads: the
last digits differ. A number that is stored, sent, printed or read back is one number, and is compared by `==`.
"""

from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from typing import Any

import numpy as np
import xarray as xr
from pytest import approx

ROUNDING = 1e-12


def same(one: Any, other: Any, *, relative: float = ROUNDING, absolute: float = 0.0, place: str = "") -> None:
    """Hold two results to each other, number by number and word by word.

    They are mappings, sequences, records, arrays, data arrays and datasets. Floats agree within `relative` of the other
    or within `absolute`, and NaN is NaN; keys with their order, lengths, shapes, whole numbers and words are equal.
    """
    one, other = _plain(one), _plain(other)
    within: dict[str, Any] = {"relative": relative, "absolute": absolute}
    message = f"{place}: {one!r} is not {other!r}"
    if isinstance(one, dict) and isinstance(other, dict):
        assert list(one) == list(other), f"{place}: {list(one)} is not {list(other)}"
        for key, value in one.items():
            same(value, other[key], **within, place=f"{place}.{key}")
    elif isinstance(one, list) and isinstance(other, list):
        assert len(one) == len(other), message
        for at, (mine, theirs) in enumerate(zip(one, other, strict=True)):
            same(mine, theirs, **within, place=f"{place}[{at}]")
    elif isinstance(one, np.ndarray):
        np.testing.assert_allclose(one, other, rtol=relative, atol=absolute, err_msg=place, strict=True)
    elif _is_float(one, other):
        assert one == approx(other, rel=relative, abs=absolute, nan_ok=True), message
    else:
        assert (type(one), one) == (type(other), other), message


def _is_float(*numbers: Any) -> bool:
    """Whether all are numbers and one of them is not whole."""
    kinds = {type(number) for number in numbers}
    return kinds <= {int, float, complex} and kinds != {int}


def _plain(content: Any) -> Any:
    """Content as a dictionary, a list, an array of numbers, a number or a word."""
    if isinstance(content, xr.Dataset | xr.DataArray):
        return _plain(content.to_dict(data="array"))
    if is_dataclass(content) and not isinstance(content, type):
        return asdict(content)
    if isinstance(content, Mapping):
        return dict(content)
    if isinstance(content, np.generic):
        return content.item()
    if isinstance(content, np.ndarray):
        return content if np.issubdtype(content.dtype, np.inexact) else content.tolist()
    return list(content) if isinstance(content, tuple | list) else content
