"""Options that several commands share, and quantities given as options."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sonolube.units import to_si

if TYPE_CHECKING:
    from sonolube.rig import Rig

RigPath = Annotated[Path, typer.Argument(metavar="RIG.toml", help="The rig, as a TOML file.")]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace an entry, such as sliding.sliding_speed=87mm/s."),
]
Out = Annotated[Path, typer.Option(help="Folder for report, figures and data.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object, all quantities in SI.")]
Load = Annotated[str | None, typer.Option(metavar="FORCE", help="Normal load instead of the rig's, such as 40N.")]
Sizes = Annotated[
    list[str] | None, typer.Option("--set", metavar="SIZE=VALUE", help="A size of the part, such as length=127mm.")
]
OUT = Path("out")


def option_value(text: str | None, *, unit: str, option: str) -> float | None:
    """Value of an option in SI; None where it was not given.

    Parameters
    ----------
    text : str or None
        Number with its unit, as typed.
    unit : str
        SI unit of the quantity.
    option : str
        Name of the option, for the error message.

    Returns
    -------
    float or None

    Raises
    ------
    InvalidInput
        If the text is no number with a unit of this kind.
    """
    return None if text is None else to_si(text, unit=unit, name=option)


def loaded_rig(path: Path, *, load: str | None, changes: list[str] | None) -> "Rig":
    """Rig of a file with entries replaced, `--load` among them.

    Parameters
    ----------
    path : Path
    load : str or None
        Normal load instead of the file's, with its unit.
    changes : list of str or None
        Entries such as "drive.frequency=22kHz".

    Returns
    -------
    Rig
    """
    from sonolube.rig import read_rig

    replaced = list(changes or ())
    if load is not None:
        to_si(load, unit="N", name="--load")
        replaced.append(f"contact.normal_load={load}")
    return read_rig(path, changes=replaced)
