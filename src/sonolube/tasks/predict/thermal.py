"""Task `thermal`: heat of friction and vibration in a rig's contact, and its temperature over a test."""

from typing import Annotated

from sonolube.errors import InvalidInput
from sonolube.models.thermal.flash_models import FLASH_MODELS
from sonolube.report import Drawing
from sonolube.rig import temperature_point, thermal_solid
from sonolube.rig.figures import temperature_chart
from sonolube.tasks.parameters import Number, Parameter, Quantity, RigFile, rig_of
from sonolube.tasks.predict.rig_record import RigRecord
from sonolube.tasks.task import in_si, plausible, shown, task

_PIN = Parameter("Material of the pin, which the contact stays on; by default the rig's.", "MATERIAL")
_DISC = Parameter("Material of the disc, which the contact moves over; by default the rig's.", "MATERIAL")
_CONDUCTANCE = Quantity("Thermal conductance from the pin to its surroundings.", "W/K", kind="CONDUCTANCE")
_VIBRATION_HEAT = Quantity(
    "Heat of the vibration in the contact; several, such as 1mW,5mW, one after another, each for as long.", "W"
)
_RATIO = Quantity(
    "Friction with vibration over that without, such as a measured one, instead of the friction model's.",
    "friction_ratio",
    kind="RATIO",
)
_FLASH_MODEL = Parameter(f"Model of the flash temperature: {', '.join(FLASH_MODELS)}.", "MODEL")


@task
def thermal(
    rig: RigFile,
    *,
    pin: Annotated[str | None, _PIN] = None,
    disc: Annotated[str | None, _DISC] = None,
    duration: Annotated[Number, Quantity("Duration of the test.", "s")] = "50s",
    heat_capacity: Annotated[Number, Quantity("Heat capacity of the pin.", "J/K", kind="CAPACITY")] = "1.5J/K",
    conductance: Annotated[Number, _CONDUCTANCE] = "0.05W/K",
    dry: Annotated[Number, Quantity("Time at the start of the test without vibration.", "s")] = "0s",
    vibration_heat: Annotated[Number, _VIBRATION_HEAT] = "0W",
    friction_ratio: Annotated[Number | None, _RATIO] = None,
    flash_model: Annotated[str, _FLASH_MODEL] = "quadrature",
) -> RigRecord:
    """Heat of friction and vibration: flash, bulk and their share in each body.

    Example: sonolube thermal examples/rigs/tribometer.toml --pin stainless_steel_316 --disc aluminium_2024

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.thermal("examples/rigs/tribometer.toml", pin="stainless_steel_316", disc="aluminium_2024")
    >>> format_si(float(answer["frictional_heat_rate"]), "W", digits=2)  # 0.36 N at 20.3 mm/s
    '7.3 mW'
    """
    known = rig_of(rig)
    levels = vibration_heat.split(",") if isinstance(vibration_heat, str) else [vibration_heat]
    result = temperature_point(
        known,
        pin=thermal_solid(_material(pin or known.pin_material, "pin")),
        disc=thermal_solid(_material(disc or known.disc_material, "disc")),
        heat_capacity=plausible("heat_capacity", heat_capacity),
        thermal_conductance=plausible("conductance", conductance),
        duration=plausible("duration", duration),
        dry_duration=plausible("dry", dry),
        vibration_heat_rate=[plausible("vibration_heat", level) for level in levels],
        friction_ratio=in_si("friction_ratio", friction_ratio),
        flash_model=flash_model,
    )
    drawing = Drawing(chart=lambda: temperature_chart(known, result))
    return RigRecord(rig=known, result=result, drawings={f"{known.name}-thermal": drawing})


def _material(name: str | None, role: str) -> str:
    """Material of a body, given or of the rig."""
    if name is None:
        raise InvalidInput(f'{shown(role)}: missing; give it, or contact.softer.role = "pin" or "disc" in the rig file')
    return name
