"""Options that only a terminal has: the rig of a task by its file, figures, JSON."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sonolube.errors import InvalidInput
from sonolube.text.units import to_si

if TYPE_CHECKING:
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


Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace an entry, such as sliding.sliding_speed=87mm/s."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object, all quantities in SI.")]
Brief = Annotated[bool, typer.Option("--brief", help="Leave out the assumptions of the rig file.")]
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
OUT = Path("out")


def rig_of_options(
    path: Path | None,
    *,
    load: str | None = None,
    changes: list[str] | None = None,
    amplitude: AmplitudeSource | None = None,
) -> "Rig | None":
    """Rig of a file with entries replaced, `--load` and `--amplitude` among them; None where no file is named."""
    if path is None:
        for option, value in {"--set": changes, "--amplitude": amplitude, "--load": load}.items():
            if value:
                raise InvalidInput(f"{option} needs a rig; name its file, such as examples/rigs/tribometer.toml")
        return None
    from sonolube.rig import read_rig

    replaced = list(changes or ())
    if amplitude is not None:
        replaced.append(f"vibration.amplitude_source={amplitude.value}")
    if load is not None:
        to_si(load, unit="N", name="--load")
        replaced.append(f"contact.normal_load={load}")
    return read_rig(path, changes=replaced)
