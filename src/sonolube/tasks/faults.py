"""What a task raises: refusals in one bounded line, and faults of the program with a file that reproduces them."""

import json
import os
import platform
import sys
import tempfile
import traceback
from base64 import b64encode
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

from sonolube.errors import SeveralFaults, SonolubeError, SystemRefusal, UnexpectedFault, fault_line
from sonolube.storage.files import write_atomically
from sonolube.tasks.files import NamedBytes, with_names_only
from sonolube.text.plain_text import printable

_LONGEST: Final = 4000  # characters of a refusal
_LONGEST_VALUE: Final = 2000  # characters of an argument, or of one of its values
_MAX_VALUES: Final = 200  # of an argument
_LARGEST_FILE: Final = 256 * 1024  # bytes of a file whose content is recorded
_LONGEST_TRACE: Final = 50_000
_PACKAGES: Final = ("numpy", "scipy", "xarray", "pandas", "pint", "numba")


def tidy(failure: SonolubeError) -> None:
    """Bound the texts of an error to one line, without private folders, in which no character acts."""
    failure.args = tuple(_tidied(each) if isinstance(each, str) else each for each in failure.args)
    if isinstance(failure, SeveralFaults):
        failure.faults, failure.where = tuple(map(_tidied, failure.faults)), _tidied(failure.where)


def _tidied(text: str) -> str:
    """Text in one line."""
    plain = printable(with_names_only(text)).replace("\n", "\\n")
    half = _LONGEST // 2
    return plain if len(plain) <= _LONGEST else f"{plain[:half]} ... {plain[-half:]}"


def refused_by_system(failure: OSError) -> SystemRefusal:
    """Error of the operating system as one line that names the file."""
    reason = failure.strerror or str(failure) or type(failure).__name__
    file = with_names_only(os.fsdecode(failure.filename)) if isinstance(failure.filename, str | bytes) else ""
    return SystemRefusal(_tidied(f"{file}: {reason}" if file else reason))


def unexpected(failure: BaseException, task: str, arguments: Mapping[str, Any]) -> UnexpectedFault:
    """Error on an exception that no refusal foresees, with a file that reproduces it.

    Parameters
    ----------
    failure : BaseException
    task : str
        Name of what was asked for.
    arguments : mapping of str to object
        Of the task, as they were given.

    Returns
    -------
    UnexpectedFault
        In one line, which names the file where it could be written.
    """
    file = _written(lambda: _record(failure, task, arguments))
    text = _tidied(fault_line(failure))
    return UnexpectedFault(f"{text}, and attach {file}, which reproduces it" if file else text)


def _written(record: Callable[[], dict[str, Any]]) -> str:
    """Path of a record that was written; empty where that failed, which is no second fault."""
    try:
        content = json.dumps(record(), indent=1, default=_shown)
        folder = tempfile.mkdtemp(prefix="sonolube-fault-")  # which nobody else may read
        return str(write_atomically(Path(folder, "fault.json"), content))
    except Exception:
        return ""


def _record(failure: BaseException, task: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """What reproduces a fault: task, arguments with small files, versions, traceback."""
    from sonolube import __version__

    lines = "".join(traceback.format_exception(failure))
    loaded = {name: str(getattr(sys.modules[name], "__version__", "")) for name in _PACKAGES if name in sys.modules}
    return {
        "task": task,
        "arguments": {name: _value(value) for name, value in arguments.items() if value is not None},
        "versions": {"sonolube": __version__, "python": sys.version, "platform": platform.platform(), **loaded},
        "traceback": lines if len(lines) <= _LONGEST_TRACE else lines[-_LONGEST_TRACE:],
    }


def _value(value: Any) -> Any:
    """Argument as JSON has it."""
    if value is None or isinstance(value, bool | int | float):
        return value
    if isinstance(value, NamedBytes):
        return {"name": value.name, **_content(value.content)}
    if isinstance(value, Path | str):
        return _path_or_text(value)
    if isinstance(value, Mapping):
        return {str(key)[:_LONGEST_VALUE]: _value(value[key]) for key in list(value)[:_MAX_VALUES]}
    if isinstance(value, list | tuple):
        return [_value(each) for each in value[:_MAX_VALUES]]
    return _shown(value)


def _path_or_text(value: Path | str) -> Any:
    """Text, or a path with the content of its file where that is small."""
    text = str(value)[:_LONGEST_VALUE]
    try:
        path = Path(value)
        if len(str(value)) < _LONGEST_VALUE and path.is_file():
            return {"path": text, **(_content(path.read_bytes()) if path.stat().st_size <= _LARGEST_FILE else {})}
    except (OSError, ValueError):
        pass
    return text


def _content(content: bytes) -> dict[str, Any]:
    """Bytes of a file, where they are few."""
    return {"base64": b64encode(content).decode()} if len(content) <= _LARGEST_FILE else {"bytes": len(content)}


def _shown(value: object) -> str:
    """Value of any other type."""
    kind = type(value).__name__
    try:
        return f"{kind} {getattr(value, 'file', None) or repr(value)}"[:_LONGEST_VALUE]  # of a rig its file
    except Exception:  # of an object that cannot be shown
        return kind
