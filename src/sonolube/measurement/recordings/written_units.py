"""Units as instruments write them, and their conversion to SI."""

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.text.units import convert

_FAULT_VALUE = "value 0.0 "

# Spellings that differ from those of pint, as (factor, unit): pint reads rpm as an angular speed.
_SPELLINGS = {
    "newtons": (1.0, "N"),
    "volts": (1.0, "V"),
    "amps": (1.0, "A"),
    "amperes": (1.0, "A"),
    "seconds": (1.0, "s"),
    "sec": (1.0, "s"),
    "deg c": (1.0, "degC"),
    "°c": (1.0, "degC"),
    "celsius": (1.0, "degC"),
    "rpm": (1 / 60, "1/s"),
    "u/min": (1 / 60, "1/s"),
    "1/min": (1 / 60, "1/s"),
    "1": (1.0, ""),
    "-": (1.0, ""),
}

# Second meanings, by the dimension of the channel: grams of a force are gram-force, those of an acceleration g.
_OTHER_MEANINGS: dict[str, tuple[tuple[float, str], ...]] = {
    "g": ((1e-4, "T"), (1.0, "gf"), (1.0, "g_0")),
    "G": ((1e-4, "T"), (1.0, "g_0")),
    "gauss": ((1e-4, "T"),),
    "kg": ((1.0, "kgf"),),
    "mg": ((1e-3, "gf"),),
    "lb": ((1.0, "lbf"),),
    "C": ((1.0, "degC"),),
    "F": ((1.0, "degF"),),
}


def convert_to_si(values: Floats, *, written_unit: str, unit: str, name: str) -> Floats:
    """Values in an SI unit, converted from the unit in which an instrument wrote them."""
    gain, offset, _ = si_conversion(written_unit, unit=unit, name=name)
    return values if (gain, offset) == (1.0, 0.0) else values * gain + offset


def si_conversion(written_unit: str, *, unit: str, name: str) -> tuple[float, float, str]:
    """Gain and offset that convert values to an SI unit, and the unit as which the written one was understood.

    `gain, offset`: SI value = gain * written value + offset. `understood`: The unit; differs from the written one where
    its second meaning was taken, such as "gf" for "g".
    """
    written = " ".join(written_unit.split())
    first = _SPELLINGS.get(written.lower(), (1.0, written))
    if first == (1.0, unit):
        return 1.0, 0.0, written
    refusal = None
    for factor, spelled in (first, *_OTHER_MEANINGS.get(written, _OTHER_MEANINGS.get(written.lower(), ()))):
        try:
            offset = convert(0.0, from_unit=spelled, to_unit=unit)
            gain = (convert(1.0, from_unit=spelled, to_unit=unit) - offset) * factor
        except InvalidInput as failure:
            refusal = refusal or str(failure).removeprefix(_FAULT_VALUE)
            continue
        return gain, offset, written if (factor, spelled) == first else spelled
    raise InvalidInput(f"{name}: {refusal}")
