"""Arguments of tasks as anyone gives them: coerced to what the functions of tasks take, or refused by name.

The kind of an argument follows from its annotation and its mark; there is one function for each kind. No other package
is imported to recognise its objects: tables are what pandas calls DataFrame, datasets what xarray calls Dataset, and
quantities with units whatever has a magnitude and converts itself, as those of pint.
"""

import io
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Set as AnySet
from contextlib import suppress
from itertools import islice
from math import isfinite
from numbers import Real
from pathlib import Path, PurePath
from reprlib import Repr
from types import NoneType
from typing import Any, Final, ForwardRef, Literal, get_args, get_origin

from sonolube.errors import InvalidInput, UnknownName
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.parameters import (
    DoorParameter,
    File,
    KeyValues,
    Mark,
    OwnRuns,
    Parameter,
    RigEntry,
    RunsSource,
    item_of,
    members_of,
)
from sonolube.text.plain_text import printable
from sonolube.vocabulary import quantities

Coercion = Callable[[str, Any], Any]
"""Returns the value that a task takes for one that was given, or raises; called with the name as it is shown."""

_MAX_ITEMS: Final = 100_000  # of an argument that takes several values
_SHOWN: Final = Repr()
_SHOWN.maxstring = _SHOWN.maxother = 60
_SHOWN.maxlist = _SHOWN.maxtuple = _SHOWN.maxset = _SHOWN.maxfrozenset = _SHOWN.maxdict = 3
_SHOWN.maxlevel = 2
_PLAIN: Final = (str, bytes, bool, int, float, complex, list, tuple, set, frozenset, dict)
_ARTICLES: Final = {True: "an", False: "a"}
_TABLE_SUFFIXES: Final = ("FILE", "FILES...", ".csv", "FREE", "PRESSED", "[FREE2]")  # of what stands for measured files
_LABORATORY: Final = "RIG.toml=RUNS.csv"


def coercion(kind: Any, mark: Mark) -> Coercion:
    """Function that coerces the values of an argument, by its type and its mark.

    Parameters
    ----------
    kind : type
        Of the annotation; a reference by name where the types are not imported.
    mark : Mark

    Returns
    -------
    callable
    """
    by_kind = _coercion(kind, mark)
    if not _may_be_none(kind, mark):
        return by_kind
    return lambda name, value: None if value is None else by_kind(name, value)


def _may_be_none(kind: Any, mark: Mark) -> bool:
    """Whether an argument may be None."""
    if isinstance(kind, ForwardRef):
        return kind.__forward_arg__.endswith("| None")
    return NoneType in get_args(kind) or isinstance(mark, DoorParameter)


def _coercion(kind: Any, mark: Mark) -> Coercion:
    """Function that coerces values other than None."""
    if isinstance(mark, DoorParameter) and not isinstance(mark, RigEntry):
        return _of_door(kind)
    if isinstance(kind, ForwardRef):
        if kind.__forward_arg__ in (OwnRuns, RunsSource):
            return runs_argument
        return _laboratory_argument if getattr(mark, "kind", "") == _LABORATORY else rig_argument
    if isinstance(mark, KeyValues):
        is_text = any(get_args(each)[1] is str for each in members_of(kind))
        return lambda name, value: _mapping_argument(name, value, _text if is_text else _value_of_key)
    if (item := item_of(kind)) is not None:
        each, keeps_one = _coercion(item, mark), Path in members_of(kind)
        return lambda name, value: _several(name, value, each, keeps_one=keeps_one)
    if words := choices_of(kind):
        return lambda name, value: _word(name, value, words)
    members = members_of(kind)
    if Path in members:
        assert isinstance(mark, Parameter)
        return _file_coercion(mark, members)
    return _text if members == (str,) else _number_coercion(members, getattr(mark, "unit", None))


def _number_coercion(members: tuple[Any, ...], unit: str | None) -> Coercion:
    """Function that coerces truths, plain numbers, and quantities."""
    if members == (bool,):
        return _truth
    if str in members:
        return lambda name, value: _quantity(name, value, unit)
    is_whole = float not in members
    return lambda name, value: _number(name, value, is_whole=is_whole)


def choices_of(kind: Any) -> tuple[Any, ...]:
    """Words of which an argument of a type is one, or has several; empty where it may be anything else."""
    if get_origin(kind) is Literal:
        return get_args(kind)
    members = [choices_of(each) for each in get_args(kind) if each not in (NoneType, ...)]
    return tuple(word for words in members for word in words) if all(members) else ()


def refusal(name: str, value: Any, remedy: str) -> InvalidInput:
    """Refusal of a value, with what is wanted in its place."""
    return InvalidInput(f"{name} must be {remedy}, got {described(value)}")


def described(value: Any) -> str:
    """Value in a refusal: its type and the beginning of what it holds, in one short line."""
    if value is None:
        return "None"
    kind = type(value).__name__[:60]
    if not isinstance(value, _PLAIN):
        shape = getattr(value, "shape", None)
        shape = f" of shape {shape}" if isinstance(shape, tuple) and len(shape) < 6 else ""
        return f"{_ARTICLES[kind[0].lower() in 'aeiou']} {kind}{shape}"
    try:
        text = _SHOWN.repr(value)
    except Exception:  # of what a container holds, or an integer of too many digits
        return f"{_ARTICLES[kind[0].lower() in 'aeiou']} {kind}"
    return printable(text[:200])


# ---- numbers and words


def _truth(name: str, value: Any) -> bool:
    """True or False, also of numpy."""
    if isinstance(value, bool) or (type(value).__name__ in ("bool", "bool_") and hasattr(value, "dtype")):
        return bool(value)
    raise refusal(name, value, "True or False")


def _alone(name: str, value: Any) -> Any:
    """Value of an array of no dimensions; an array of one dimension or more is refused."""
    if (dimensions := getattr(value, "ndim", None)) is None or not hasattr(value, "item"):
        return value
    if dimensions:
        raise refusal(name, value, "one number")
    return value.item()


def _plain_float(name: str, value: Any) -> float:
    """Number as a float."""
    try:
        return float(value)
    except (OverflowError, ValueError, ArithmeticError):
        raise refusal(name, value, "a number that a float holds") from None


def _is_number(value: Any) -> bool:
    """Whether a value is a real number and no truth."""
    return isinstance(value, Real) and not isinstance(value, bool)


def _number(name: str, value: Any, *, is_whole: bool) -> float:
    """Plain number."""
    what = "a whole number" if is_whole else "a number"
    if _has_units(value):
        value = _magnitude(name, value, "")
    value = _alone(name, value)
    if not _is_number(value):
        raise refusal(name, value, what)
    number = _plain_float(name, value)
    if not is_whole:
        return number
    if not isfinite(number) or value != int(value):
        raise refusal(name, value, what)
    return int(value)


def _has_units(value: Any) -> bool:
    """Whether a value is a quantity with its unit, as those of pint."""
    return hasattr(value, "magnitude") and hasattr(value, "to") and hasattr(value, "units")


def _magnitude(name: str, value: Any, unit: str) -> float:
    """Number of a quantity with units, in a unit."""
    try:
        magnitude = value.to(unit or "dimensionless").magnitude
    except Exception:  # errors of the library of the quantity are of many kinds
        raise InvalidInput(
            f"{name} {printable(str(value))[:60]!r} has no unit of the kind {unit or 'number'}"
        ) from None
    return _plain_float(name, _alone(name, magnitude))


def _quantity(name: str, value: Any, unit: str | None) -> float | str:
    """Number in SI, or a text with its unit."""
    if isinstance(value, str):
        return str(value)
    if _has_units(value):
        if unit and unit != "K":
            return _magnitude(name, value, unit)
        return _with_unit(name, value)
    value = _alone(name, value)
    if isinstance(value, str):
        return str(value)
    if not _is_number(value):
        raise refusal(name, value, "a number in SI or a text with its unit")
    number = _plain_float(name, value)
    return value if type(value) is int else number


def _with_unit(name: str, value: Any) -> str:
    """Quantity with units as a text."""
    number = _plain_float(name, _alone(name, value.magnitude))
    units = str(value.units).replace("delta_degree_Celsius", "kelvin")
    return f"{number!r}" if units == "dimensionless" else f"{number!r} {units}"


def _text(name: str, value: Any) -> str:
    """Text, or a quantity with its unit as a text."""
    if isinstance(value, str):
        return str(value)
    if _has_units(value):
        return _with_unit(name, value)
    raise refusal(name, value, "a text")


def _word(name: str, value: Any, words: tuple[Any, ...]) -> Any:
    """One of some words."""
    if not isinstance(value, str):
        raise refusal(name, value, f"one of {', '.join(map(str, words))}")
    if value not in words:
        raise UnknownName.among(words, kind=name, name=value)
    return value


# ---- several values, and values by key


def _several(name: str, value: Any, each: Coercion, *, keeps_one: bool) -> Any:
    """Several values; one alone stands for a list of it, or for itself where the task tells these apart."""
    if _is_one(value):
        found = each(name, value)
        return found if keeps_one else (found,)
    items = [each(name, item) for item in islice(_items(name, value), _MAX_ITEMS + 1)]
    if len(items) > _MAX_ITEMS:
        raise InvalidInput(f"{name} has more than {_MAX_ITEMS} values")
    return tuple(items) if isinstance(value, tuple) else items


def _is_one(value: Any) -> bool:
    """Whether a value is one, no collection of several."""
    is_text = isinstance(value, str | bytes | bytearray | os.PathLike | NamedBytes)
    return is_text or _is_table(value) or _is_dataset(value) or not isinstance(value, Iterable) or _is_scalar(value)


def _is_scalar(value: Any) -> bool:
    """Whether a value is an array of no dimensions, or one number with its unit."""
    return getattr(value.magnitude, "ndim", 0) == 0 if _has_units(value) else getattr(value, "ndim", None) == 0


def _items(name: str, value: Any) -> Iterator[Any]:
    """Items of a collection."""
    if isinstance(value, Mapping):
        raise refusal(name, value, "a list")
    if isinstance(value, AnySet):
        return iter(sorted(value, key=described))
    try:
        return iter(value)
    except TypeError:
        raise refusal(name, value, "a list") from None


def _mapping_argument(name: str, value: Any, each_value: Coercion) -> dict[str, Any]:
    """Values by their keys."""
    if not isinstance(value, Mapping):
        raise refusal(name, value, "a mapping, such as {'key': value}")
    if len(value) > _MAX_ITEMS:
        raise InvalidInput(f"{name} has more than {_MAX_ITEMS} keys")
    found = {}
    for key, each in value.items():
        if not isinstance(key, str):
            raise refusal(f"each key of {name}", key, "a text")
        found[str(key)] = each_value(f"{name} {printable(key[:60])}", each)
    return found


def _value_of_key(name: str, value: Any) -> Any:
    """Value of a key: a text, a number, or several."""
    if _is_one(value):
        return _quantity(name, value, None)
    items = [_quantity(name, each, None) for each in islice(_items(name, value), _MAX_ITEMS + 1)]
    if len(items) > _MAX_ITEMS:
        raise InvalidInput(f"{name} has more than {_MAX_ITEMS} values")
    has_units = any(map(_has_units, islice(_items(name, value), 1)))
    return ",".join(map(str, items)) if has_units else items


# ---- files


def _file_coercion(mark: Parameter, members: tuple[Any, ...]) -> Coercion:
    """Function that coerces a path, a name with its bytes, and a record or table where one can stand for the file."""
    takes_bytes = NamedBytes in members
    records = tuple(each for each in members if isinstance(each, type) and each not in (str, Path, NamedBytes))
    takes_tables = takes_bytes and isinstance(mark, File) and mark.kind.endswith(_TABLE_SUFFIXES)

    def coerce(name: str, value: Any) -> Any:
        if records and isinstance(value, records):
            return value
        if takes_tables and (_is_table(value) or _is_dataset(value)):
            return _recording_of(name, value)
        return file_argument(name, value, takes_bytes=takes_bytes, suffix=_suffix(mark.kind))

    return coerce


def _suffix(kind: str) -> str:
    """Ending of the name of a file by what stands for it in a help text; empty for one of several formats."""
    found = PurePath(kind.strip("[]")).suffix
    return found if found.isascii() and found[1:].isalpha() else ""


def file_argument(name: str, value: Any, *, takes_bytes: bool = True, suffix: str = "") -> str | Path | NamedBytes:
    """Path of a file, or its name with its bytes; bytes alone are named after the argument."""
    if isinstance(value, NamedBytes) and takes_bytes:
        if not isinstance(value.name, str) or not isinstance(value.content, bytes):
            raise refusal(name, value.content, "NamedBytes of a text and bytes")
        _path(name, value.name)
        return value
    if isinstance(value, bytes | bytearray) and takes_bytes:
        return NamedBytes(f"{name.strip('-').lower().removesuffix(suffix)}{suffix}", bytes(value))
    if isinstance(value, str | os.PathLike):
        return _path(name, value)
    either = "the path of a file, its bytes, or NamedBytes" if takes_bytes else "a path"
    raise refusal(name, value, either)


def _path(name: str, value: "str | os.PathLike[Any]") -> str | Path:
    """Path that the operating system takes."""
    text = value if isinstance(value, str) else os.fspath(value)
    if not isinstance(text, str):
        raise refusal(name, text, "a path as text")
    try:
        has_zero = b"\0" in os.fsencode(text)
    except UnicodeEncodeError:
        has_zero = True
    if has_zero:
        raise InvalidInput(f"{name} {described(text)} is no path: it has a character that no name of a file has")
    return value if isinstance(value, str | Path) else Path(text)


# ---- rigs


def rig_argument(name: str, value: Any) -> Any:
    """Rig, an answer that has one, or the path of its file or its bytes."""
    if isinstance(value, str | os.PathLike | NamedBytes | bytes | bytearray):
        return file_argument(name, value, suffix=".toml")
    from sonolube.rig.record import Rig

    if isinstance(value, Rig):
        return value
    try:
        rig = value.rig
    except Exception:  # of an attribute of any object
        rig = None
    if isinstance(rig, Rig):
        return rig
    raise refusal(name, value, "a rig, the path of its file, its bytes, or an answer with a rig")


def _laboratory_argument(name: str, value: Any) -> list[tuple[Any, Any]]:
    """Pairs of a rig and its runs."""
    pairs = value.items() if isinstance(value, Mapping) else () if _is_one(value) else _items(name, value)
    if not isinstance(value, Mapping) and _is_one(value):
        raise refusal(name, value, "a mapping of rigs to runs")
    found = []
    for pair in islice(pairs, _MAX_ITEMS):
        if not isinstance(pair, tuple | list) or len(pair) != 2:
            raise refusal(f"each of {name}", pair, "a rig and its runs")
        rig, runs = pair
        found.append((rig_argument(name, rig), None if runs is None else runs_argument(name, runs)))
    return found


# ---- tables and datasets


def _is_table(value: Any) -> bool:
    """Whether a value is a table as pandas has it."""
    return hasattr(value, "columns") and hasattr(value, "to_csv") and hasattr(value, "index")


def _is_dataset(value: Any) -> bool:
    """Whether a value is a dataset of xarray."""
    xarray = sys.modules.get("xarray")
    return xarray is not None and isinstance(value, xarray.Dataset)


def runs_argument(name: str, value: Any) -> Any:
    """Measured runs: a path or query, a name with bytes, a table, or a dataset, which is completed."""
    if _is_table(value):
        return NamedBytes("runs", _csv(name, value))
    if _is_dataset(value):
        from sonolube.measurement.measured_runs import runs_of_dataset

        return runs_of_dataset(value, name=name)
    if isinstance(value, str | os.PathLike | NamedBytes | bytes | bytearray):
        return file_argument(name, value, suffix=".csv")
    if (sheet := _sheet_of(value)) is not None:
        if not sheet.rows:
            raise InvalidInput(f"{name}: this table has no run yet")
        return NamedBytes("runs", sheet.csv().encode())
    raise refusal(name, value, "the path of a table, its bytes, a DataFrame, a table of runs, or that of read_runs")


def _sheet_of(value: Any) -> Any:
    """Table of own runs of an answer that has one; None for anything else."""
    from sonolube.measurement.run_sheet import RunSheet

    try:
        sheet = value.sheet
    except Exception:  # of an attribute of any object
        return None
    return sheet if isinstance(sheet, RunSheet) else None


def _recording_of(name: str, value: Any) -> NamedBytes:
    """Measured signals as a file: a table as text, a dataset as netCDF, which has every digit and attribute."""
    if _is_table(value):
        return NamedBytes("table.csv", _csv(name, value))
    try:
        content = bytes(value.to_netcdf(engine="h5netcdf"))
    except Exception as failure:  # of xarray and its libraries, for what netCDF has no place
        reason = printable(" ".join(str(failure).split())[:200])
        raise InvalidInput(f"{name}: this dataset has content that netCDF cannot hold ({reason})") from None
    title = value.attrs.get("title")
    return NamedBytes(f"{_plain_name(title) if isinstance(title, str) else 'dataset'}.nc", content)


def _plain_name(title: str) -> str:
    """Title as the name of a file."""
    return "".join(each if each.isalnum() or each in "-_" else "-" for each in title[:60]) or "dataset"


def _csv(name: str, table: Any) -> bytes:
    """Table as comma-separated text with every digit; a column named by a quantity alone is in SI."""
    stream = io.StringIO()
    try:
        whole = table.reset_index() if any(each is not None for each in table.index.names) else table
        header = [_in_si(str(label)) for label in whole.columns]
        whole.to_csv(stream, index=False, header=header, lineterminator="\n")
    except Exception as failure:  # of pandas, or of the objects in the cells
        reason = printable(" ".join(str(failure).split())[:200])
        raise InvalidInput(f"{name}: this DataFrame cannot be written as text ({reason})") from None
    return stream.getvalue().encode("utf-8", "backslashreplace")


def _in_si(label: str) -> str:
    """Heading of a column, with the unit of SI where it is the name of a quantity alone."""
    known = quantities().get(label.strip())
    return label if known is None or not known.unit else f"{label.strip()} [{known.unit}]"


# ---- what a door sets


def _of_door(kind: Any) -> Coercion:
    """Function that refuses what is neither a function where one is called, nor of the class that a task needs."""
    members = members_of(kind)
    classes = tuple(each for each in members if isinstance(each, type))
    if any(getattr(each, "_is_protocol", False) for each in classes):
        return lambda name, value: value
    is_called = any(get_origin(each) is not None for each in members)

    def coerce(name: str, value: Any) -> Any:
        if isinstance(value, classes):
            return value
        if is_called and callable(value):
            return _marking(value)
        if Path in classes and isinstance(value, os.PathLike):
            return _path(name, value)
        raise refusal(name, value, "a function" if is_called else f"a {classes[0].__name__}" if classes else "None")

    return coerce


_ORIGIN: Final = "_raised_by_a_function_that_was_given"


def is_of_caller(failure: BaseException) -> bool:
    """Whether an exception comes from a function that the caller gave, and is no fault of the task."""
    return bool(getattr(failure, _ORIGIN, False))


def _marking(function: Callable[..., Any]) -> Callable[..., Any]:
    """Function whose exceptions are known as its own."""

    def called(*positional: Any) -> Any:
        try:
            return function(*positional)
        except Exception as failure:
            with suppress(AttributeError, TypeError):
                setattr(failure, _ORIGIN, True)
            raise

    return called
