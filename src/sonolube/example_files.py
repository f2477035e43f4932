"""Example files that come with sonolube: rigs, tables of runs, scripts, maps of devices, facts, mappings, protocols."""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import Final

from sonolube.errors import UnknownName
from sonolube.facts.protocol import protocol_names, protocol_path

_ROOM: Final = Path(__file__).parent
_ENDINGS: Final = (".toml", ".csv", ".py")
_RIGS: Final = "examples/rigs/"
_LEFT_OUT: Final = ("notebooks",)  # settings of a linter
_SCHEMA: Final = "#:schema"  # begins a line whose relative path holds only where the original lies
_UNIT: Final = re.compile(r"\s*\[[^\]]*\]")


def without_schema(text: str) -> str:
    """Text of a TOML file without the line that names its schema to editors."""
    return "".join(line for line in text.splitlines(keepends=True) if not line.startswith(_SCHEMA))


@dataclass(frozen=True, slots=True, kw_only=True)
class ExampleFile:
    """One example file.

    Parameters
    ----------
    path : str
        As help texts name it, such as examples/rigs/tribometer.toml.
    source : Path
        The file itself.
    """

    path: str
    source: Path

    @property
    def name(self) -> str:
        """Short name: of a rig that of its file, of others the path without `examples` and ending."""
        return PurePosixPath(self.path).with_suffix("").as_posix().removeprefix(_RIGS).removeprefix("examples/")

    @property
    def is_rig(self) -> bool:
        """Whether it is a rig."""
        return self.path.startswith(_RIGS)

    @property
    def is_script(self) -> bool:
        """Whether it is a script of Python."""
        return self.source.suffix == ".py"

    @property
    def text(self) -> str:
        """Content."""
        return without_schema(self.source.read_text(encoding="utf-8"))

    @property
    def title(self) -> str:
        """Title in the file, else its first comment, the columns of the table or the first line of the script."""
        text = self.text
        if self.is_script:
            return text.partition("\n")[0].strip('"').rstrip(".")
        if self.source.suffix == ".csv":
            columns = _UNIT.sub("", text.splitlines()[0]).replace("_", " ").split(",")
            return f"Table of {', '.join(columns)}"
        title = tomllib.loads(text).get("title")
        return title if isinstance(title, str) else text.partition("\n")[0].lstrip("# ").partition(". ")[0]

    def companions(self) -> list["ExampleFile"]:
        """Further example files that it names by their paths beside it, such as the modes of a rig, with theirs."""
        text, folder = self.text, PurePosixPath(self.path).parent
        between = '" / "' if self.is_script else "/"
        below = (other for other in _every() if PurePosixPath(other.path).is_relative_to(folder))
        named = [
            other for other in below if f'"{between.join(PurePosixPath(other.path).relative_to(folder).parts)}"' in text
        ]
        return [each for other in named for each in (other, *other.companions())]


@cache
def example_files() -> Mapping[str, ExampleFile]:
    """Example files by name, rigs first, without those that only belong to another."""
    belonging = {other.path for each in _every() if not each.is_script for other in each.companions()}
    own = (each for each in _every() if each.path not in belonging)
    return MappingProxyType({each.name: each for each in sorted(own, key=lambda each: (not each.is_rig, each.path))})


def example_file(name: str) -> ExampleFile:
    """Example file by its name, or by the path in a help text."""
    known = example_files()
    by_path = {each.path: each for each in known.values()}
    found = known.get(name) or by_path.get(name)
    if found is None:
        raise UnknownName.among(known, kind="example", name=name)
    return found


@cache
def _every() -> tuple[ExampleFile, ...]:
    """Every example file: those beside the package in its sources or inside it where it is installed, and protocols.

    Of the scripts those of the folder itself and the drivers beside maps of devices, without gallery and notebooks.
    """
    inside = _ROOM / "examples"
    folder = inside if inside.is_dir() else _ROOM.parents[1] / "examples"
    sources = {path.relative_to(folder): path for path in sorted(folder.rglob("*")) if path.suffix in _ENDINGS}
    own = {
        f"examples/{path.as_posix()}": each
        for path, each in sources.items()
        if path.parts[0] not in _LEFT_OUT and (path.suffix != ".py" or len(path.parts) == 1 or path.parts[0] == "lab")
    }
    protocols = {f"examples/protocols/{name}.toml": protocol_path(name) for name in protocol_names()}
    return tuple(ExampleFile(path=path, source=each) for path, each in (own | protocols).items())
