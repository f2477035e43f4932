"""Checks of physical arguments; the errors name the argument, the value and its unit."""

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.errors import InvalidInput
from sonolube.vocabulary import unit_of

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Integers = NDArray[np.int64]

_DOUBLE = np.dtype(np.float64)


def require_finite(**values: ArrayLike) -> Floats:
    """First value as a float array; refuse any that is not a finite number."""
    return _require(np.isfinite, "must be finite", values)


def require_finite_complex(**values: ArrayLike) -> Complexes:
    """First value as a complex array; refuse any that is not a finite number, real or complex."""
    for name, value in values.items():
        for part in _parts(value):
            require_finite(**{name: part})
    return np.asarray(next(iter(values.values())), dtype=np.complex128)


def require_positive(**values: ArrayLike) -> Floats:
    """First value as a float array; refuse any that is zero, negative or not finite."""
    return _require(lambda array: array > 0, "must be positive", values)


def require_non_negative(**values: ArrayLike) -> Floats:
    """First value as a float array; refuse any that is negative or not finite."""
    return _require(lambda array: array >= 0, "must not be negative", values)


def require_within(lower: float, upper: float, /, **values: ArrayLike) -> Floats:
    """First value as a float array; refuse any outside the closed range from `lower` to `upper`."""
    return _require(
        lambda array: (array >= lower) & (array <= upper), f"must lie between {lower:g} and {upper:g}", values
    )


def _require(accepts: Callable[[Any], Any], demand: str, values: Mapping[str, Any]) -> Floats:
    """First value as a float array; refuse any value that is not finite or not accepted."""
    for name, value in values.items():
        # the common case of one number, in a tenth of the time
        number = value.item() if type(value) is np.ndarray and not value.ndim and value.dtype is _DOUBLE else value
        if isinstance(number, float) and isfinite(number) and accepts(number):
            continue
        array = _floats(name, value)
        _refuse_unless(np.isfinite(array), array, name, "must be finite")
        _refuse_unless(accepts(array), array, name, demand)
    first = next(iter(values.values()))
    return np.asarray(first) if type(first) is float else _floats(next(iter(values)), first)


def _refuse_unless(accepted: NDArray[np.bool_], array: Floats, name: str, demand: str) -> None:
    """Raise InvalidInput for the first element that is not accepted."""
    if not accepted.all():
        offender = float(array[~accepted].flat[0]) if array.ndim else float(array)
        raise InvalidInput(f"{name} {demand}, got {offender!r} {unit_of(name)}".rstrip(), key=name)


def _floats(name: str, value: ArrayLike) -> Floats:
    """Value as a float array; refuse what is not a number or an array of numbers."""
    try:
        array = np.asarray(value)
    except ValueError:
        array = np.asarray(None)
    if array.dtype.kind not in "fiu":
        raise InvalidInput(f"{name} must be a number or an array of numbers, got {value!r}", key=name)
    return array.astype(np.float64, copy=False)


def _parts(value: ArrayLike) -> tuple[ArrayLike, ...]:
    """Real and imaginary part of a complex value, or the value itself."""
    try:
        array = np.asarray(value)
    except ValueError:
        return (value,)
    return (array.real, array.imag) if array.dtype.kind == "c" else (value,)
