"""Temperature of the contact of a rig over time, with and without vibration."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.materials import material
from sonolube.rig.linear_response import rest_separation
from sonolube.rig.record import Rig
from sonolube.rig.simulation import vibrated_friction
from sonolube.thermal import EllipticSource, HeatedContact, ThermalNetwork, ThermalSolid, contact_rise, peclet_number
from sonolube.thermal.contact_history import (
    ContactTemperatureHistory,
    contact_temperature_history,
    frictional_heat_rate,
)
from sonolube.thermal.flash_models import FLASH_MODELS

_STEPS = 200


@dataclass(frozen=True, kw_only=True, slots=True)
class TemperaturePoint:
    """Heat and temperature of a rig's contact under its vibration.

    Parameters
    ----------
    frictional_heat_rate : float
        Heat of friction. [W]
    vibration_heat_rate : float
        Heat of the vibration in the contact. [W]
    heat_partition : float
        Share of both that flows into the pin. []
    peclet_number : float
        Peclet number of the contact on the disc. []
    peak_temperature_rise : float
        Highest rise of the contact over the bulk of the pin. [K]
    mean_temperature_rise : float
        Mean rise of the contact over the bulk of the pin. [K]
    temperature_rise : float
        Mean rise of the contact over its surroundings at the end of the test. [K]
    temperature_rise_ratio : float
        That rise over the one of the same test without vibration. []
    friction_ratio : float
        Friction with vibration over friction without. []
    friction_model : str
        Name of the friction model.
    vibration_amplitude : float
        Vibration normal to the contact, zero to peak. [m]
    amplitude_source : {"measured", "computed", "waveguide", "per-volt"}
        Where the amplitude comes from.
    amplitude_origin : str
        The same in words, with the numbers behind it.
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
    temperature_rise: float
    temperature_rise_ratio: float
    friction_ratio: float
    friction_model: str
    vibration_amplitude: float
    amplitude_source: str
    amplitude_origin: str
    caveats: tuple[str, ...]
    with_vibration: ContactTemperatureHistory
    without_vibration: ContactTemperatureHistory


def thermal_solid(name: str) -> ThermalSolid:
    """Return the thermal properties of a material of the catalogue.

    Raises
    ------
    MissingProperty
        If no source for one of its thermal properties is known.
    UnknownName
        If there is no such material.
    """
    found = material(name)
    return ThermalSolid(
        thermal_conductivity=found.value("thermal_conductivity"),
        density=found.value("density"),
        specific_heat_capacity=found.value("specific_heat_capacity"),
    )


def temperature_point(
    rig: Rig,
    *,
    pin: ThermalSolid,
    disc: ThermalSolid,
    heat_capacity: float,
    thermal_conductance: float,
    duration: float,
    vibration_heat_rate: float = 0.0,
    flash_model: str = "quadrature",
) -> TemperaturePoint:
    """Return the temperature of the rig's contact, taken as circular, over a test from ambient temperature.

    Parameters
    ----------
    rig : Rig
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
    vibration_heat_rate : float
        Heat of the vibration in the contact. [W]
    flash_model : str
        Of `sonolube.thermal.flash_models.FLASH_MODELS`.

    Returns
    -------
    TemperaturePoint

    Raises
    ------
    InvalidInput
        If the rig does not slide, has no frequency, or a value is not positive.
    OutsideRange
        If the load leaves no separation, or the vibration is outside the range of the friction model.
    """
    if rig.sliding_speed <= 0:
        raise InvalidInput("sliding.sliding_speed must be positive for heat of friction")
    rest_separation(rig)
    require_positive(heat_capacity=heat_capacity, thermal_conductance=thermal_conductance, duration=duration)
    require_non_negative(vibration_heat_rate=vibration_heat_rate)
    radius = float(np.sqrt(rig.contact.nominal_area / np.pi))
    source = EllipticSource(half_length=radius, half_width=radius)
    moving_rise = FLASH_MODELS.named(flash_model)
    network = ThermalNetwork(heat_capacity=(heat_capacity,), links=(), losses=(thermal_conductance,))
    contact = HeatedContact(pin=pin, disc=disc, source=source, network=network, moving_rise=moving_rise)
    vibrated = vibrated_friction(rig, sliding_speed=rig.sliding_speed)
    found = vibrated.ratio
    intrinsic, ratio = rig.friction_coefficient * rig.normal_load, float(found.require_within_range())
    if ratio < 0:
        raise OutsideRange(
            f"friction ratio {ratio:.3g}: the vibration drives the sliding, and heat of friction has no meaning for it;"
            " lower the vibration or friction.in_plane_fraction"
        )
    times = np.linspace(0.0, duration, _STEPS + 1)
    history = partial(contact_temperature_history, contact, time=times, sliding_speed=rig.sliding_speed)
    without = history(friction_force=intrinsic, vibration_heat_rate=0.0)
    warmed = history(friction_force=ratio * intrinsic, vibration_heat_rate=vibration_heat_rate)
    of_friction = float(frictional_heat_rate(friction_force=ratio * intrinsic, sliding_speed=rig.sliding_speed))
    heat = of_friction + vibration_heat_rate
    shared = contact_rise(pin, disc, source, heat_rate=heat, sliding_speed=rig.sliding_speed, moving_rise=moving_rise)
    return TemperaturePoint(
        frictional_heat_rate=of_friction,
        vibration_heat_rate=vibration_heat_rate,
        heat_partition=float(shared.heat_partition),
        peclet_number=float(peclet_number(disc, source, sliding_speed=rig.sliding_speed)),
        peak_temperature_rise=float(shared.peak_temperature_rise),
        mean_temperature_rise=float(shared.mean_temperature_rise),
        temperature_rise=float(warmed.temperature_rise[-1]),
        temperature_rise_ratio=float(warmed.temperature_rise[-1] / without.temperature_rise[-1]),
        friction_ratio=ratio,
        friction_model=rig.friction_model.name,
        vibration_amplitude=vibrated.vibration.amplitude,
        amplitude_source=vibrated.vibration.source,
        amplitude_origin=vibrated.vibration.text,
        caveats=(*vibrated.caveats, *_caveats(network, vibration_heat_rate)),
        with_vibration=warmed,
        without_vibration=without,
    )


def _caveats(network: ThermalNetwork, vibration_heat_rate: float) -> tuple[str, ...]:
    (capacity,), (conductance,) = network.heat_capacity, network.losses
    known = (
        "heat enters over the nominal area; flash temperatures of asperities are higher, for microseconds",
        f"bulk of a pin of {capacity:g} J/K that loses {conductance:g} W/K, which the rig file does not hold",
    )
    if vibration_heat_rate > 0:
        return known
    return (*known, "no heat of vibration was given: heat that the actuator dissipates in the contact adds to it")
