"""Options that several commands share, and quantities given as options."""

from collections.abc import Callable, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self

import typer

from sonolube.errors import InvalidInput
from sonolube.units import temperature_difference_to_si, to_si, unit_description

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.rig import Rig


class AmplitudeSource(StrEnum):
    """Where the amplitude of a vibration comes from."""

    MEASURED = "measured"
    COMPUTED = "computed"
    WAVEGUIDE = "waveguide"
    PER_VOLT = "per-volt"


class FigureStyleName(StrEnum):
    """Sizes of figures, and of what is written in them."""

    JOURNAL = "journal"
    SLIDES = "slides"


RigPath = Annotated[Path, typer.Argument(metavar="RIG.toml", help="The rig, as a TOML file.")]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace an entry, such as sliding.sliding_speed=87mm/s."),
]
Out = Annotated[Path, typer.Option(help="Folder for report, figures and data.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object, all quantities in SI.")]
Load = Annotated[str | None, typer.Option(metavar="FORCE", help="Normal load instead of the rig's, such as 40N.")]
Amplitude = Annotated[
    AmplitudeSource | None,
    typer.Option(
        "--amplitude",
        metavar="measured|computed|waveguide|per-volt",
        help="Source of the amplitude; by default measured, else computed from stack and structure, else waveguide, "
        "else per volt.",
    ),
]
Style = Annotated[
    FigureStyleName,
    typer.Option("--style", help="Sizes of figures: for the columns of a journal (85 and 174 mm), or for slides."),
]
Sizes = Annotated[
    list[str] | None, typer.Option("--set", metavar="SIZE=VALUE", help="A size of the part, such as length=127mm.")
]
OUT = Path("out")


class TypedNumber(float):
    """Number in SI that prints as it was typed.

    Parameters
    ----------
    text : str
        Number with its unit, as typed.
    unit : str
        SI unit of the quantity; in K a temperature difference.
    option : str
        Name of the option, for the error message.

    Raises
    ------
    InvalidInput
        If the text is no number with a unit of this kind.
    """

    text: str

    def __new__(cls, text: str, unit: str, *, option: str = "") -> Self:
        """Read the text."""
        value = temperature_difference_to_si(text, name=option) if unit == "K" else to_si(text, unit=unit, name=option)
        number = super().__new__(cls, value)
        number.text = text
        return number

    def __str__(self) -> str:
        return self.text

    def __reduce__(self) -> tuple[type[float], tuple[float]]:
        """Copy as a plain number."""
        return float, (float(self),)


def si_option(unit: str, text: str, *names: str, metavar: str = "") -> Any:
    """Option that is typed as a number with its unit and taken as a `TypedNumber`.

    Parameters
    ----------
    unit : str
        SI unit of the quantity.
    text : str
        Of the help.
    *names : str
        As typed, such as "--sliding-speed"; by the argument of the command where absent.
    metavar : str
        What stands for the value in the help; the kind of quantity where absent, such as FORCE.

    Returns
    -------
    typer.models.OptionInfo
    """
    kind = unit_description(unit).partition(",")[0].partition(" ")[2].upper()
    return typer.Option(*names, parser=str, callback=_reader(unit), metavar=metavar or kind, help=text)


def refuse_unused(context: typer.Context, *names: str, because: str) -> None:
    """Refuse options that were given and that the command would not use beside the others.

    Parameters
    ----------
    context : typer.Context
        Of the running command.
    *names : str
        Arguments of its function whose options have no meaning here.
    because : str
        Where they have none, and where they apply, such as "for --of; it is for --over".

    Raises
    ------
    InvalidInput
        For the first of them that was given.
    """
    for option in context.command.params:
        given = getattr(context.get_parameter_source(option.name or ""), "name", "DEFAULT") != "DEFAULT"
        if option.name in names and given:
            raise InvalidInput(f"{option.opts[0]} has no meaning {because}")


def refuse_replaced(changes: Sequence[str] | None, over: Sequence[str] | None) -> None:
    """Refuse an entry of `--set` whose key takes the values of `--over`.

    Raises
    ------
    InvalidInput
        For the first such key.
    """
    swept = {entry.partition("=")[0].strip() for entry in over or ()}
    for key in (change.partition("=")[0].strip() for change in changes or ()):
        if key in swept:
            raise InvalidInput(f"--set {key}: takes the values of --over {key}; give it once")


def _reader(unit: str) -> Callable[..., TypedNumber | None]:
    """Function that reads the text of an option, or takes its default."""

    def read(option: typer.CallbackParam, text: str | TypedNumber | None) -> TypedNumber | None:
        if text is None or isinstance(text, TypedNumber):
            return text
        return TypedNumber(text, unit, option=option.opts[0])

    return read


def with_amplitude(changes: Sequence[str] | None, amplitude: AmplitudeSource | None) -> list[str]:
    """Entries that replace those of a rig file, with the source of the amplitude where it was chosen.

    Parameters
    ----------
    changes : sequence of str or None
        Of `--set`.
    amplitude : AmplitudeSource or None
        Of `--amplitude`.

    Returns
    -------
    list of str
    """
    chosen = [] if amplitude is None else [f"vibration.amplitude_source={amplitude.value}"]
    return [*(changes or ()), *chosen]


def loaded_rig(
    path: Path, *, load: str | None = None, changes: list[str] | None, amplitude: AmplitudeSource | None = None
) -> "Rig":
    """Rig of a file with entries replaced, `--load` and `--amplitude` among them.

    Parameters
    ----------
    path : Path
    load : str or None
        Normal load instead of the file's, with its unit.
    changes : list of str or None
        Entries such as "drive.frequency=22kHz".
    amplitude : AmplitudeSource or None
        Source of the amplitude instead of the file's.

    Returns
    -------
    Rig
    """
    from sonolube.rig import read_rig

    replaced = with_amplitude(changes, amplitude)
    if load is not None:
        to_si(load, unit="N", name="--load")
        replaced.append(f"contact.normal_load={load}")
    return read_rig(path, changes=replaced)


def friction_force(text: str, *, normal_load: float, option: str) -> float:
    """Friction force of an option that takes a coefficient or a force.

    Parameters
    ----------
    text : str
        Such as "0.1" or "0.3N".
    normal_load : float
        Force pressing the bodies together. [N]
    option : str
        Name of the option, for the error message.

    Returns
    -------
    float
        In N.

    Raises
    ------
    InvalidInput
        If the text is neither a pure number nor a force, or not positive.
    """
    is_force = text.strip()[-1:].isalpha()
    value = to_si(text, unit="N" if is_force else "", name=option) * (1.0 if is_force else normal_load)
    if not value > 0:
        raise InvalidInput(f"{option} {text} must be positive, a coefficient such as 0.2 or a force such as 0.6N")
    return value


def measured_runs(path: Path) -> "xr.Dataset":
    """Measured runs of an option that takes a table of runs, or a query of the catalogue of runs.

    Parameters
    ----------
    path : Path
        A CSV file, or a text such as ``catalogue:material=brass,load=5N``.

    Returns
    -------
    xarray.Dataset
        As `sonolube.measurement.measured_runs.read_runs` returns them.
    """
    if str(path).startswith("catalogue:"):
        from sonolube.laboratory.catalogue import catalogued_runs

        return catalogued_runs(str(path))
    from sonolube.measurement.measured_runs import read_runs

    return read_runs(path)


def optional_rig(
    path: Path | None, *, changes: list[str] | None, amplitude: AmplitudeSource | None = None
) -> "Rig | None":
    """Rig of a file with entries replaced, or None where no file is named.

    Raises
    ------
    InvalidInput
        If entries or the source of the amplitude are given without a rig, or as `read_rig`.
    """
    if path is not None:
        return loaded_rig(path, changes=changes, amplitude=amplitude)
    if changes or amplitude:
        option = "--set" if changes else "--amplitude"
        raise InvalidInput(f"{option} needs a rig; name its file, such as examples/rigs/tribometer.toml")
    return None
