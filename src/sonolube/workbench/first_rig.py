"""New rig from what is known before a test, as `sonolube new` writes it."""

from sonolube.facts.materials import material
from sonolube.rig import Rig
from sonolube.rig.new_rig.rig_text import KnownRig, rig_of_known
from sonolube.rig.new_rig.stated_text import pin_shape, reader, speed_of, surface_of, vibration_of


def new_rig(
    *,
    pin: str,
    disc: str,
    load: str,
    speed: str,
    frequency: str,
    amplitude: str,
    shape: str = "flat 3mm",
    finish: str = "ground",
    pin_finish: str | None = None,
    disc_finish: str | None = None,
    friction_coefficient: float | None = None,
    decay_length: str | None = None,
    stiffness: str | None = None,
    track_radius: str | None = None,
    track_diameter: str | None = None,
) -> Rig:
    """Return a rig from what is known before a test; what nobody measured has a distribution with its reason.

    Parameters
    ----------
    pin, disc : str
        Materials of the catalogue, such as "304" or "100Cr6", or classes of them, such as "steel" or "Messing".
    load, speed : str
        With units, such as "5 N" and "0.2 m/s"; a speed in rpm with the track.
    frequency : str
        With its unit, such as "20 kHz". [Hz]
    amplitude : str
        Zero to peak, such as "3 um"; or an actuator of the catalogue with its voltage, such as "sa050510 50V".
    shape : str
        End of the pin, such as "flat 3mm" by its diameter, "ball 5mm" by its radius or "ball diameter 10mm".
    finish : str
        Of both surfaces, such as "ground N6", "Ra 0.4um" or "Rz 3.2um", or the file of a scan.
    pin_finish, disc_finish : str, optional
        Of one surface.
    friction_coefficient : float, optional
        Coefficient of dry friction, where it was measured; else by the pair or its class. []
    decay_length : str, optional
        Length over which the force of the worn contact falls by a factor of e, such as "1.5 um"; that of published
        tests where both it and the stiffness are absent. [m]
    stiffness : str, optional
        Measured normal stiffness of the contact under the load, such as "1.5 MN/m", in place of the decay length.
    track_radius : str, optional
        Radius of the track on the disc, such as "15 mm", for a speed in rpm. [m]
    track_diameter : str, optional
        Its diameter, in place of the radius.

    Returns
    -------
    Rig
        Whose `to_toml` writes the file.

    Raises
    ------
    InvalidInput
        If a text cannot be read or a value is impossible.
    MissingProperty
        If the catalogue has no modulus of a material, or neither hardness nor strength, and none of its class.
    UnknownName
        If there is no such material, actuator or finish.
    """
    sliding = speed_of(
        speed,
        track_radius=track_radius,
        track_diameter=track_diameter,
        name="speed",
        radius_name="track_radius",
        diameter_name="track_diameter",
    )
    known = KnownRig(
        pin=material(pin).name,
        disc=material(disc).name,
        shape=pin_shape(shape, name="shape"),
        normal_load=reader("N", name="load")(load),
        sliding_speed=sliding.sliding_speed,
        speed_reason=sliding.reason,
        frequency=reader("Hz", name="frequency")(frequency),
        vibration=vibration_of(amplitude, name="amplitude"),
        pin_surface=surface_of(pin_finish or finish),
        disc_surface=surface_of(disc_finish or finish),
        friction_coefficient=friction_coefficient,
        decay_length=None if decay_length is None else reader("m", name="decay_length")(decay_length),
        normal_stiffness=None if stiffness is None else reader("N/m", name="stiffness")(stiffness),
    )
    return rig_of_known(known)
