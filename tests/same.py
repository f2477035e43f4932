"""Results of two computations: keys and words are equal, and numbers agree to rounding.

Two ways to one number add its parts in another order, and so do another processor and another number of threads: the
last digits differ. A number that is stored, sent, printed or read back is one number, and is compared by `==`.
"""

import io
import re
import zipfile
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest
import xarray as xr

ROUNDING = 1e-12


def approx(expected: Any, **within: Any) -> Any:
    """Expectation that pytest compares to rounding, of any type: a tuple may hold it beside words."""
    return pytest.approx(expected, **within)


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
        return {field.name: getattr(content, field.name) for field in fields(content)}
    if isinstance(content, Mapping):
        return dict(content)
    if isinstance(content, np.generic) or (isinstance(content, np.ndarray) and content.ndim == 0):
        return content.item()
    if isinstance(content, np.ndarray):
        return content if np.issubdtype(content.dtype, np.inexact) else content.tolist()
    return list(content) if isinstance(content, tuple | list) else content


_PICTURES = (".pdf", ".png", ".svg")
_NUMBER = re.compile(r"(?<![\w.])([-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)(?![\w.])")


def same_text(one: str, other: str, *, relative: float = ROUNDING, place: str = "") -> None:
    """Hold two texts to each other, each number within `relative`, which is that of the digits that are written."""
    words, others = _NUMBER.split(one), _NUMBER.split(other)
    assert words[0::2] == others[0::2], place
    for mine, theirs in zip(words[1::2], others[1::2], strict=True):
        assert mine == theirs or float(mine) == approx(float(theirs), rel=relative, abs=0.0), (
            f"{place}: {mine}, {theirs}"
        )


def same_files(
    one: Mapping[str, Any], other: Mapping[str, Any], *, relative: float = ROUNDING, place: str = ""
) -> None:
    """Hold texts, datasets and archives of them to each other by name; pictures are looked for by name alone."""
    assert sorted(one) == sorted(other), place
    for name in one:
        mine, theirs, here = _bytes(one[name]), _bytes(other[name]), f"{place}{name}"
        if zipfile.is_zipfile(io.BytesIO(mine)):
            same_files(_unpacked(mine), _unpacked(theirs), relative=relative, place=f"{here}/")
        elif name.endswith(".nc"):
            same(*(xr.load_dataset(io.BytesIO(each), engine="h5netcdf") for each in (mine, theirs)), place=here)
        elif not name.endswith(_PICTURES):
            same_text(mine.decode(), theirs.decode(), relative=relative, place=here)


def _bytes(content: Any) -> bytes:
    """Content of a file, also where it is given as text."""
    return content.encode() if isinstance(content, str) else bytes(content)


def _unpacked(archive: bytes) -> dict[str, bytes]:
    """Files of an archive by name."""
    with zipfile.ZipFile(io.BytesIO(archive)) as files:
        return {name: files.read(name) for name in files.namelist()}
