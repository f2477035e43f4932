"""Inputs and outputs of a command by its arguments: outputs are checked before anything is computed."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import wraps
from glob import escape
from pathlib import Path
from typing import Any, TypeVar, get_type_hints

from sonolube.storage.files import expect_file, expect_files
from sonolube.storage.targets import command_files, record_input

_Mark = TypeVar("_Mark")


@dataclass(frozen=True, slots=True)
class OutputFile:
    """Marks, in the annotation of an argument, the path of a file that the command writes."""

    def expect(self, path: Path, stems: Mapping[str, str]) -> None:
        """Raise InvalidInput if the file cannot be written."""
        expect_file(path)


@dataclass(frozen=True, slots=True)
class OutputFolder:
    """Marks, in the annotation of an argument, the folder in which the command writes files.

    Parameters
    ----------
    names : str
        Names of the files with spaces between, * for what is not known before the computation; an argument in braces
        stands for its name without folder and ending, as in "{rig}-response.*".
    """

    names: str = ""

    def expect(self, path: Path, stems: Mapping[str, str]) -> None:
        """Raise InvalidInput if files of these names cannot be written in the folder."""
        expect_files(path, tuple(name.format_map(stems) for name in self.names.split()))


@dataclass(frozen=True, slots=True)
class ContinuedFolder:
    """Marks, in the annotation of an argument, a folder of records that the command completes where they are."""


def with_checked_files(command: Callable[..., None]) -> Callable[..., None]:
    """Command that refuses outputs which cannot be written, or are its inputs, before it computes.

    With the same arguments.
    """

    @wraps(command)
    def run(**arguments: Any) -> None:
        with command_files():
            marks, continued = output_marks(command), _marked(command, ContinuedFolder)
            for name, value in arguments.items():
                if name not in marks and name not in continued:
                    for path in _paths(value):
                        record_input(path)
            stems = {name: _stem(value) for name, value in arguments.items()}
            for name, mark in marks.items():
                if arguments[name] is not None:
                    mark.expect(arguments[name], stems)
            command(**arguments)

    return run


def output_marks(command: Callable[..., None]) -> dict[str, OutputFile | OutputFolder]:
    """Marks of the arguments of a command that are outputs."""
    return _marked(command, OutputFile) | _marked(command, OutputFolder)


def _marked(command: Callable[..., None], kind: type[_Mark]) -> dict[str, _Mark]:
    """Marks of a kind by the arguments of a command that have one."""
    hints = get_type_hints(command, include_extras=True)
    return {
        name: mark
        for name, hint in hints.items()
        for mark in getattr(hint, "__metadata__", ())
        if isinstance(mark, kind)
    }


def _paths(value: Any) -> Iterator[Path]:
    """Paths of the value of an argument; texts only where they name a file."""
    for each in value if isinstance(value, list | tuple) else [value]:
        if isinstance(each, Path):
            yield each
        elif isinstance(each, str) and Path(each).suffix:
            yield Path(each)


def _stem(value: Any) -> str:
    """Name of a file, or of a choice, in a pattern."""
    return escape(Path(str(value)).stem)
