"""Arguments of tasks: what an annotation says of one, types that several tasks share, their reading, and a call."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from pathlib import Path
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Annotated, Any, Protocol, TypeAlias, TypedDict, Union, get_args, get_origin

from sonolube.errors import InvalidInput
from sonolube.tasks.files import InputFile, NamedBytes, file_path
from sonolube.tasks.progress import Cancelled, Progress
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.measurement.run_sheet import RunSheet
    from sonolube.rig import Rig

Number = float | str
"""Quantity: a number in SI, or a text with its unit such as "20.3 mm/s"."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """Meaning of an argument of a task.

    Parameters
    ----------
    help : str
        One sentence.
    kind : str
        What stands for the value in a help text, such as MATERIAL.
    unit : str or None
        SI unit of a `Number`, in K a temperature difference; empty for a pure number.
    quantity : str
        Its name in the vocabulary, where it has one.
    option : str
        As typed on a terminal, where that is not the name with hyphens; further names of it behind spaces.
    lowest, highest : float or None
        Range of a number.
    """

    help: str
    kind: str = ""
    _: KW_ONLY
    unit: str | None = None
    quantity: str = ""
    option: str = ""
    lowest: float | None = None
    highest: float | None = None


class Quantity(Parameter):
    """Meaning of a `Number`, by its SI unit or by the name in the vocabulary that has one."""

    def __init__(self, text: str, of: str, *, kind: str = "", option: str = "") -> None:
        known = quantities().get(of)
        unit, name = (of, "") if known is None else (known.unit, of)
        super().__init__(text, kind, unit=unit, quantity=name, option=option)


class File(Parameter):
    """Meaning of an argument that names files that are read."""


class DeviceParameter(Parameter):
    """Meaning of an argument that names devices of a rig, which the task opens."""


class DeviceFile(File, DeviceParameter):
    """Meaning of an argument that names a file of devices, which the task opens."""


class KeyValues(Parameter):
    """Meaning of a mapping, of which a terminal takes KEY=VALUE once for each key."""


class OwnFolder(Parameter):
    """Meaning of an argument that names a folder in which the task itself writes, such as the folder of all runs."""


class OwnFile(File, OwnFolder):
    """Meaning of an argument that names a file that is read, and written where it was changed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RigParameter:
    """Marks the rig of a task: on a terminal its file, with entries replaced, load and source of the amplitude.

    Parameters
    ----------
    is_optional : bool
    without : tuple of str
        Of "load" and "amplitude" those that change nothing of the answer.
    """

    is_optional: bool = False
    without: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class DoorParameter:
    """Marks arguments that a door sets and no user types: progress, cancellation, folder of kept parts, operator.

    Parameters
    ----------
    files : str
        Names of the files that a task keeps only where it is asked to: a terminal then has the option --keep.
    """

    files: str = ""


@dataclass(frozen=True, slots=True)
class RigEntry(DoorParameter):
    """Marks arguments by which Python replaces entries of the rig, as a terminal does by its options.

    Parameters
    ----------
    unit : str or None
        SI unit of a quantity.
    """

    unit: str | None = None


RigSource: TypeAlias = "Rig | HasRig | InputFile"
"""A rig, an answer that has one, or the path of a file."""

OptionalRigSource: TypeAlias = "Rig | HasRig | InputFile | None"
OwnRuns: TypeAlias = "InputFile | xr.Dataset | HasRunSheet"
"""Measured runs: a table, a query such as "catalogue:material=brass", or that of `sl.runs` or `sl.read_runs`."""

RunsSource: TypeAlias = "InputFile | xr.Dataset | HasRunSheet | None"


class HasRunSheet(Protocol):
    """Answer that has a table of own runs, such as that of `runs`."""

    @property
    def sheet(self) -> "RunSheet":
        """Table of the answer."""


class HasRig(Protocol):
    """Answer that has a rig, such as that of `new`."""

    @property
    def rig(self) -> "Rig":
        """Rig of the answer."""


Kept = str | Path | Callable[[str], Path]
"""Folder for what a task keeps while it runs, or a function that returns it by a name that the task proposes."""

RigFile = Annotated[RigSource, RigParameter()]
RestingRig = Annotated[RigSource, RigParameter(without=("amplitude",))]
OptionalRig = Annotated[OptionalRigSource, RigParameter(is_optional=True)]


class Watched(TypedDict, total=False):
    """Arguments `progress` and `cancelled` of tasks that can take over a second."""

    progress: Annotated[Progress | None, DoorParameter()]
    cancelled: Annotated[Cancelled | None, DoorParameter()]


class RigChanges(TypedDict, total=False):
    """Argument `changes` of tasks of a rig, which a terminal has as --set."""

    changes: Annotated[Sequence[str], RigEntry()]


class DrivenRigEntries(RigChanges, total=False):
    """Arguments of tasks of a rig that have loads of their own."""

    amplitude: Annotated[str | None, RigEntry()]


class RestingRigEntries(RigChanges, total=False):
    """Arguments of tasks of a rig whose amplitude changes nothing."""

    load: Annotated[Number | None, RigEntry(unit="N")]


class RigEntries(DrivenRigEntries, total=False):
    """Arguments of tasks of a rig by which its entries are replaced."""

    load: Annotated[Number | None, RigEntry(unit="N")]


class WatchedRigChanges(RigChanges, Watched, total=False):
    """Arguments of `RigChanges` and `Watched`."""


class WatchedRestingRig(RestingRigEntries, Watched, total=False):
    """Arguments of `RestingRigEntries` and `Watched`."""


class WatchedRig(RigEntries, Watched, total=False):
    """Arguments of `RigEntries` and `Watched`."""


Keep = Annotated[Kept | None, DoorParameter()]
Pin = Annotated[str | None, Parameter("Material of the pin, for the heat; by default the rig's.", "MATERIAL")]
Disc = Annotated[str | None, Parameter("Material of the disc, for the heat; by default the rig's.", "MATERIAL")]
Interval = Annotated[bool, Parameter("State the error of the friction model, and the interval with it.")]
Sizes = Annotated[
    Mapping[str, str | float] | None,
    KeyValues("A size of the part, such as length=127mm.", "SIZE=VALUE", option="--set"),
]


def rig_of(source: RigSource) -> "Rig":
    """Rig of a task: itself, that of an answer such as of `new`, or read where its file is given."""
    from sonolube.rig import Rig, read_rig

    if isinstance(source, Rig):
        return source
    return read_rig(file_path(source)) if isinstance(source, InputFile) else source.rig


def with_entries(
    source: RigSource, *, load: Number | None = None, amplitude: str | None = None, changes: Sequence[str] = ()
) -> "Rig":
    """Rig of a task with entries replaced.

    Parameters
    ----------
    source : Rig, answer with one, or file
    load : float, str or None
        Normal load, in N or as a text with its unit.
    amplitude : str or None
        Source of the amplitude: measured, computed, waveguide or per-volt.
    changes : sequence of str
        Further entries, such as "sliding.sliding_speed=87mm/s".

    Raises
    ------
    InvalidInput
        If an entry cannot be replaced, or the rig was changed in Python since it was read.
    """
    from sonolube.rig import Rig, read_rig

    replaced = list(changes)
    if amplitude is not None:
        replaced.append(f"vibration.amplitude_source={amplitude}")
    if load is not None:
        replaced.append(f"contact.normal_load={load if isinstance(load, str) else f'{load!r} N'}")
    if isinstance(source, InputFile):
        return read_rig(file_path(source), changes=replaced)
    rig = source if isinstance(source, Rig) else source.rig
    for key, equals, value in (change.partition("=") for change in replaced):
        if not equals:
            raise InvalidInput(f"{key!r} must look like KEY=VALUE, such as sliding.sliding_speed=87mm/s")
        rig = rig.replace(key.strip(), value.strip())
    return rig


def optional_rig(source: OptionalRigSource) -> "Rig | None":
    """Rig of a task that does without one."""
    return None if source is None else rig_of(source)


def kept(keep: Kept | None, name: str) -> Path | None:
    """Folder for what a task keeps, under a name where the way in asks for one; None where nothing is kept."""
    return keep(name) if callable(keep) else keep if keep is None else Path(keep)


def file_stem(source: "RunsSource | RigSource | Sequence[InputFile]") -> str:
    """Name of a file without folder and ending, for the names of the files of an answer."""
    if isinstance(source, NamedBytes):
        source = source.name
    return Path(source).stem if isinstance(source, str | Path) else "own"


Mark = Parameter | RigParameter | DoorParameter
"""Annotation of an argument of a task."""


@dataclass(frozen=True, slots=True)
class Call:
    """Call of a task: its name, and its arguments as they were given, those left to their defaults among them.

    Parameters
    ----------
    task : str
        Name of its function.
    arguments : mapping of str to object
    given : frozenset of str
        Names of arguments that were not left to their defaults.
    marks : mapping of str to Parameter or RigParameter
        Annotations of the arguments.
    names : callable
        Returns the name of an argument as it is shown.
    """

    task: str
    arguments: Mapping[str, Any]
    given: frozenset[str] = field(default_factory=frozenset)
    marks: Mapping[str, Mark] = field(default_factory=dict)
    names: Callable[[str], str] = str

    def settings(self) -> list[tuple[str, str]]:
        """Arguments with their values as they were given, those left to their defaults marked so; without the rig."""
        rows = []
        for name, value in self.arguments.items():
            if isinstance(self.marks.get(name), Parameter) and value is not None and value != () and value != {}:
                text = _as_typed(value)
                rows.append((self.names(name), text if name in self.given else f"{text} (default)"))
        return rows


def members_of(kind: Any) -> tuple[Any, ...]:
    """Types of a union but None; a type alone."""
    members = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    return tuple(each for each in members if each is not NoneType)


def item_of(kind: Any) -> Any:
    """Type of each of several values that an argument of a type takes; None where it takes one."""
    several = (each for each in members_of(kind) if get_origin(each) in (Sequence, list, tuple))
    return next((get_args(each)[0] for each in several), None)


def _as_typed(value: Any) -> str:
    """Value of an argument as a user types it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Mapping):
        return "; ".join(f"{key}={each}" for key, each in value.items())
    if isinstance(value, list | tuple):
        return "; ".join(map(str, value))
    return str(getattr(value, "name", value)) if not isinstance(value, str) else value
