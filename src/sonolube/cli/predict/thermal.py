"""Command `thermal`: heat of friction and vibration in a rig's contact, and its temperature over a test."""

from typing import Annotated

import typer

from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import OUT, Amplitude, Changes, Json, Out, RigPath, loaded_rig
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.predict.rig_record import RigRecord
from sonolube.compilation import few_points
from sonolube.errors import InvalidInput
from sonolube.models.thermal.flash_models import FLASH_MODELS
from sonolube.report import Drawing
from sonolube.rig import temperature_point, thermal_solid
from sonolube.rig.figures import temperature_figure
from sonolube.rig.file.plausible import plausible_si


@few_points()
def thermal(
    rig: RigPath,
    pin: Annotated[
        str | None,
        typer.Option(metavar="MATERIAL", help="Material of the pin, which the contact stays on; by default the rig's."),
    ] = None,
    disc: Annotated[
        str | None,
        typer.Option(
            metavar="MATERIAL", help="Material of the disc, which the contact moves over; by default the rig's."
        ),
    ] = None,
    test_time: Annotated[str, typer.Option("--duration", metavar="TIME", help="Duration of the test.")] = "50s",
    capacity: Annotated[
        str, typer.Option("--heat-capacity", metavar="CAPACITY", help="Heat capacity of the pin.")
    ] = "1.5J/K",
    conductance: Annotated[
        str, typer.Option(metavar="CONDUCTANCE", help="Thermal conductance from the pin to its surroundings.")
    ] = "0.05W/K",
    dry_time: Annotated[
        str, typer.Option("--dry", metavar="TIME", help="Time at the start of the test without vibration.")
    ] = "0s",
    vibration_heat: Annotated[
        str,
        typer.Option(
            metavar="POWER",
            help="Heat of the vibration in the contact; several, such as 1mW,5mW, one after another, each for as long.",
        ),
    ] = "0W",
    ratio: Annotated[
        float | None,
        typer.Option(
            "--friction-ratio",
            metavar="RATIO",
            help="Friction with vibration over that without, such as a measured one, instead of the friction model's.",
        ),
    ] = None,
    flash_model: Annotated[
        str, typer.Option(metavar="MODEL", help=f"Model of the flash temperature: {', '.join(FLASH_MODELS)}.")
    ] = "quadrature",
    amplitude: Amplitude = None,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("{rig}-thermal.*")] = OUT,
    json: Json = False,
) -> None:
    """Heat of friction and vibration: flash, bulk and their share in each body.

    Example: sonolube thermal examples/rigs/tribometer.toml --pin stainless_steel_316 --disc aluminium_2024
    """
    known = loaded_rig(rig, changes=changes, amplitude=amplitude)
    result = temperature_point(
        known,
        pin=thermal_solid(_material(pin or known.pin_material, "pin")),
        disc=thermal_solid(_material(disc or known.disc_material, "disc")),
        heat_capacity=plausible_si(capacity, unit="J/K", name="--heat-capacity"),
        thermal_conductance=plausible_si(conductance, unit="W/K", name="--conductance"),
        duration=plausible_si(test_time, unit="s", name="--duration"),
        dry_duration=plausible_si(dry_time, unit="s", name="--dry"),
        vibration_heat_rate=[
            plausible_si(level, unit="W", name="--vibration-heat") for level in vibration_heat.split(",")
        ],
        friction_ratio=ratio,
        flash_model=flash_model,
    )
    drawing = Drawing(draw=lambda: temperature_figure(known, result))
    answer = RigRecord(rig=known, result=result, drawings={f"{rig.stem}-thermal": drawing})
    deliver(answer, folder=out, as_json=json)


def _material(name: str | None, role: str) -> str:
    """Material of a body, given or of the rig."""
    if name is None:
        raise InvalidInput(f'--{role}: missing; give it, or contact.softer.role = "pin" or "disc" in the rig file')
    return name
