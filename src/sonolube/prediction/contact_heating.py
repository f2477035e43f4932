"""Mean temperature rise of a contact for each watt of friction."""

import numpy as np

from sonolube.errors import InvalidInput, MissingProperty
from sonolube.models.thermal import EllipticSource, contact_rise
from sonolube.rig import Rig, thermal_solid


def contact_heating(rig: Rig, pin: str | None, disc: str | None) -> float | str:
    """Mean temperature rise of the contact, taken as circular, for a watt of friction, in K/W; or why it is unknown."""
    named = pin is not None or disc is not None
    pin, disc = pin or rig.pin_material, disc or rig.disc_material
    if pin is None or disc is None:
        if named:
            raise InvalidInput("the temperature rise needs both materials; give pin and disc, or neither")
        return "name the materials of pin and disc"
    try:
        solids = thermal_solid(pin), thermal_solid(disc)
    except MissingProperty as missing:
        if named:
            raise
        return str(missing)
    radius = float(np.sqrt(rig.contact.nominal_area / np.pi))
    source = EllipticSource(half_length=radius, half_width=radius)
    rise = contact_rise(*solids, source, heat_rate=1.0, sliding_speed=rig.sliding_speed)
    return float(rise.mean_temperature_rise)
