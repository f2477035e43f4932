"""Temperature of the contact of a rig over time, with and without vibration."""

from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.models import thermal
from sonolube.models.friction.models.coulomb import sliding_power_ratio
from sonolube.models.thermal import contact_history
from sonolube.models.thermal.flash import FLASH_MODELS
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig
from sonolube.rig.simulation import vibrated_friction
from sonolube.rig.vibration import steady_vibration
from sonolube.text.units import format_si

MAX_FACE_RISE: Final = 50.0
"""Mean rise of the nominal face from which a test changes: films on metals, lubricants and clearances do. [K]"""

MAX_SPOT_RISE: Final = 500.0
"""Flash temperature rise of a real spot from which the metal itself changes. [K]

Steel at about 800 K oxidises and has lost half of its strength, aluminium is near its melting point; mild wear of
steel turns oxidational at flash temperatures of some 1000 K (S. C. Lim, M. F. Ashby, Acta Metall. 35, 1 (1987),
doi:10.1016/0001-6160(87)90209-4)."""

_STEPS = 200


@dataclass(frozen=True, kw_only=True, slots=True)
class TemperaturePoint:
    """Heat and temperature of a rig's contact under its vibration.

    Parameters
    ----------
    frictional_heat_rate : float
        Heat of friction. [W]
    vibration_heat_rate : float
        Heat of the vibration in the contact, at the end of the test. [W]
    heat_partition : float
        Share of both that flows into the pin. []
    peclet_number : float
        Peclet number of the contact on the disc. []
    peak_temperature_rise : float
        Highest rise of the contact over the bulk of the pin. [K]
    mean_temperature_rise : float
        Mean rise of the contact over the bulk of the pin. [K]
    spot_temperature_rise : float or None
        Mean flash rise of one real spot that carries the load by the hardness; None where that is not known. [K]
    temperature_rise : float
        Mean rise of the contact over its surroundings at the end of the test. [K]
    temperature_rise_ratio : float
        That rise over the one of the same test without vibration. []
    friction_ratio : float
        Friction with vibration over friction without. []
    friction_model : str
        Name of the friction model; "stated" for a stated ratio.
    vibration_amplitude : float
        Vibration normal to the contact, zero to peak. [m]
    amplitude_source : {"measured", "computed", "waveguide", "per-volt"}
        Where the amplitude comes from.
    amplitude_origin : str
        The same in words, with the numbers behind it.
    heat : str
        Whether heat of friction limits the test, with the rises of the nominal face and of a real spot.
    caveats : tuple of str
        What speaks against trusting the numbers, each in one line.
    with_vibration, without_vibration : ContactTemperatureHistory
        Both tests in time.
    """

    frictional_heat_rate: float
    vibration_heat_rate: float
    heat_partition: float
    peclet_number: float
    peak_temperature_rise: float
    mean_temperature_rise: float
    spot_temperature_rise: float | None
    temperature_rise: float
    temperature_rise_ratio: float
    friction_ratio: float
    friction_model: str
    vibration_amplitude: float
    amplitude_source: str
    amplitude_origin: str
    heat: str
    caveats: tuple[str, ...]
    with_vibration: contact_history.ContactTemperatureHistory
    without_vibration: contact_history.ContactTemperatureHistory


def thermal_solid(name: str) -> thermal.ThermalSolid:
    """Thermal properties of a material of the catalogue.

    Raises
    ------
    MissingProperty
        If no source for one of its thermal properties is known.
    UnknownName
        If there is no such material.
    """
    found = material(name)
    return thermal.ThermalSolid(
        thermal_conductivity=found.value("thermal_conductivity"),
        density=found.value("density"),
        specific_heat_capacity=found.value("specific_heat_capacity"),
    )


def spot_rise(
    pin: thermal.ThermalSolid,
    disc: thermal.ThermalSolid,
    rig: Rig,
    *,
    hardness: float,
    heat_rate: ArrayLike,
    moving_rise: thermal.MovingRise = thermal.flash_rise,
) -> Floats:
    """Mean flash temperature rise of one real spot that carries the load of a rig. [K]

    Parameters
    ----------
    pin, disc : ThermalSolid
        Body that the spot is fixed to, and that which it moves over.
    rig : Rig
    hardness : float
        Indentation hardness of the softer body. [Pa]
    heat_rate : array_like, any shape
        Heat generated in the contact. [W]
    moving_rise : MovingRise
        Model of the rise of the moving body.

    Returns
    -------
    ndarray, shape of `heat_rate`

    Raises
    ------
    InvalidInput
        If the hardness is not positive, or a heat is negative or not finite.

    See Also
    --------
    sonolube.models.thermal.real_contact_spot : the spot.
    """
    spot = thermal.real_contact_spot(normal_load=rig.normal_load, hardness=hardness)
    return thermal.contact_rise(
        pin, disc, spot, heat_rate=heat_rate, sliding_speed=rig.sliding_speed, moving_rise=moving_rise
    ).mean_temperature_rise


def heat_sentence(
    rig: Rig, *, mean_temperature_rise: float, spot_temperature_rise: float | None, hardness: float | str, of: str = ""
) -> str:
    """Whether heat of friction limits a contact, by the rises of its nominal face and of a real spot, in words.

    Parameters
    ----------
    rig : Rig
    mean_temperature_rise, spot_temperature_rise : float
        Mean rises; None of a spot that is not known. [K]
    hardness : float or str
        Indentation hardness of the softer body, or why it is not known. [Pa]
    of : str
        What the rises are, such as "at most ".

    Returns
    -------
    str
    """
    face, spot = mean_temperature_rise, spot_temperature_rise
    limits = face > MAX_FACE_RISE or (spot is not None and spot > MAX_SPOT_RISE)
    verb = "limits" if limits else "does not limit" if spot is not None else "does not limit the nominal face"
    text = f"Heat of friction {verb}: {of}{format_si(face, 'K', digits=2)} in the mean over the nominal face"
    if spot is None or isinstance(hardness, str):
        return f"{text}; the flash temperature of real spots is not known: {hardness}"
    radius = thermal.real_contact_spot(normal_load=rig.normal_load, hardness=hardness).half_length
    return (
        f"{text}, {format_si(spot, 'K', digits=2)} of flash temperature where one real spot of"
        f" {format_si(radius, 'm', digits=2)} radius carries the load"
    )


def temperature_point(
    rig: Rig | ResolvedRig,
    *,
    pin: thermal.ThermalSolid,
    disc: thermal.ThermalSolid,
    heat_capacity: float,
    thermal_conductance: float,
    duration: float,
    dry_duration: float = 0.0,
    vibration_heat_rate: ArrayLike = 0.0,
    friction_ratio: float | None = None,
    flash_model: str = "quadrature",
    hardness: float | str = "it takes the hardness of the softer body",
) -> TemperaturePoint:
    """Temperature of the rig's contact, taken as circular, over a test from ambient temperature.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    pin : ThermalSolid
        Body that the contact is fixed to.
    disc : ThermalSolid
        Body that the contact moves over.
    heat_capacity : float
        Heat that warms the pin by a kelvin. [J/K]
    thermal_conductance : float
        Heat that leaves the pin per kelvin, into its holder and the air. [W/K]
    duration : float
        Length of the test. [s]
    dry_duration : float
        Time at its start without vibration. [s]
    vibration_heat_rate : array_like, shape () or (n,)
        Heat of the vibration in the contact; several are applied one after another, each for as long. [W]
    friction_ratio : float, optional
        Friction with vibration over that without, instead of that of the friction model. []
    flash_model : str
        Of `sonolube.models.thermal.flash.FLASH_MODELS`.
    hardness : float or str
        Indentation hardness of the softer body, by which a real spot carries the load; or why it is not known. [Pa]

    Returns
    -------
    TemperaturePoint

    Raises
    ------
    InvalidInput
        If the rig does not slide, has no frequency, a value is not positive, or the dry part is as long as the test.
    OutsideRange
        If the load leaves no separation, or the vibration is outside the range of the friction model or drives the
        sliding.
    """
    resolved = resolved_rig(rig)
    rig = resolved.rig
    if rig.sliding_speed <= 0:
        raise InvalidInput("sliding.sliding_speed must be positive for heat of friction")
    resolved.require_separation()
    require_positive(heat_capacity=heat_capacity, thermal_conductance=thermal_conductance, duration=duration)
    levels = np.atleast_1d(require_non_negative(vibration_heat_rate=vibration_heat_rate))
    is_stated = bool(levels.any())
    if not 0 <= dry_duration < duration:
        raise InvalidInput(
            f"dry_duration must lie from 0 to below the {duration:g} s of the test, got {dry_duration!r} s"
        )
    radius = float(np.sqrt(rig.contact.nominal_area / np.pi))
    source = thermal.EllipticSource(half_length=radius, half_width=radius)
    moving_rise = FLASH_MODELS.named(flash_model)
    network = thermal.ThermalNetwork(heat_capacity=(heat_capacity,), links=(), losses=(thermal_conductance,))
    contact = thermal.HeatedContact(pin=pin, disc=disc, source=source, network=network, moving_rise=moving_rise)
    vibrated = vibrated_friction(resolved, sliding_speed=rig.sliding_speed)
    intrinsic = rig.friction_coefficient * rig.normal_load
    ratio = float(
        vibrated.ratio.require_braking()
        if friction_ratio is None
        else require_non_negative(friction_ratio=friction_ratio)
    )
    levels = levels if rig.direction.is_normal or is_stated else levels + _heat_within_plane(resolved, ratio)
    times, heat_rates, shaken = _steps(duration, dry_duration, levels)
    history = partial(contact_history.contact_temperature_history, contact, time=times, sliding_speed=rig.sliding_speed)
    without = history(friction_force=intrinsic, vibration_heat_rate=0.0)
    warmed = history(friction_force=np.where(shaken, ratio, 1.0) * intrinsic, vibration_heat_rate=heat_rates)
    of_friction = float(
        contact_history.frictional_heat_rate(friction_force=ratio * intrinsic, sliding_speed=rig.sliding_speed)
    )
    heat = of_friction + float(levels[-1])
    shared = thermal.contact_rise(
        pin, disc, source, heat_rate=heat, sliding_speed=rig.sliding_speed, moving_rise=moving_rise
    )
    on_spot = (
        None
        if isinstance(hardness, str)
        else float(spot_rise(pin, disc, rig, hardness=hardness, heat_rate=heat, moving_rise=moving_rise))
    )
    judged = heat_sentence(
        rig, mean_temperature_rise=float(shared.mean_temperature_rise), spot_temperature_rise=on_spot, hardness=hardness
    )
    return TemperaturePoint(
        frictional_heat_rate=of_friction,
        vibration_heat_rate=float(levels[-1]),
        heat_partition=float(shared.heat_partition),
        peclet_number=float(thermal.peclet_number(disc, source, sliding_speed=rig.sliding_speed)),
        peak_temperature_rise=float(shared.peak_temperature_rise),
        mean_temperature_rise=float(shared.mean_temperature_rise),
        spot_temperature_rise=on_spot,
        temperature_rise=float(warmed.temperature_rise[-1]),
        temperature_rise_ratio=float(warmed.temperature_rise[-1] / without.temperature_rise[-1]),
        friction_ratio=ratio,
        friction_model=rig.friction_model.name if friction_ratio is None else "stated",
        **vibrated.origin,
        heat=judged,
        caveats=(*vibrated.caveats, *_caveats(network, float(levels.max()))),
        with_vibration=warmed,
        without_vibration=without,
    )


def _heat_within_plane(resolved: ResolvedRig, ratio: float) -> float:
    """Heat that a vibration within the plane adds to that of the mean friction force, by Coulomb's law. [W]"""
    rig = resolved.rig
    if rig.friction_model.name != "coulomb":
        raise InvalidInput(
            f"{rig.title}: the vibration is {rig.direction.text}, so that it heats the contact by more than the mean"
            " friction force; give that heat as vibration_heat, or take friction.model coulomb"
        )
    motions = steady_vibration(resolved).motions
    places = [place for motion in motions for place in rig.direction.over_contact(rig.direction.over_gap(motion))]
    power = sum(share * sliding_power_ratio(motion, sliding_speed=rig.sliding_speed) for share, motion in places)
    return rig.friction_coefficient * rig.normal_load * rig.sliding_speed * (power / len(motions) - ratio)


def _steps(duration: float, dry_duration: float, levels: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Times, heat of the vibration in each interval [W], and whether it vibrates in it; levels last as long."""
    edges = np.linspace(dry_duration, duration, levels.size + 1)
    times = np.unique(np.concatenate([np.linspace(0.0, duration, _STEPS + 1), edges]))
    middle = (times[1:] + times[:-1]) / 2
    shaken = middle > dry_duration
    return times, np.where(shaken, levels[np.searchsorted(edges[1:-1], middle)], 0.0), shaken


def _caveats(network: thermal.ThermalNetwork, vibration_heat_rate: float) -> tuple[str, ...]:
    (capacity,), (conductance,) = network.heat_capacity, network.losses
    known = (
        "the figure is of heat over the nominal area",
        f"bulk of a pin of {capacity:.4g} J/K that loses {conductance:.4g} W/K, which the rig file does not hold",
    )
    if vibration_heat_rate > 0:
        return known
    return (*known, "no heat of vibration was given: heat that the actuator dissipates in the contact adds to it")
