"""Steady vibration and friction of a rig over the ranges of its inputs as tables, with their error at other points.

The friction ratio depends on the sliding speed over the velocity of the vibration. Above a multiple of it, the
threshold, stick-slip models have their ratio for fast sliding; below, the ratio is smooth over the fourth root of the
speed over the threshold.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats
from sonolube.design.fmu.chebyshev import ChebyshevTable, Ends
from sonolube.errors import InvalidInput
from sonolube.models import thermal
from sonolube.rig import CommandedQuantity, Rig, commanded_quantity, own_level
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig
from sonolube.text.units import format_si

_FREQUENCY_BAND = 0.005  # of the drive frequency, to both sides
_LOAD_SPAN, _SPEED_SPAN = 1.25, 2.0  # factors of load and speed, to both sides
KEYS = ("drive.frequency", "contact.normal_load", "sliding.sliding_speed")
"""Keys of rig files whose range an export chooses, beside that of the commanded quantity."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PlantRanges:
    """Ranges of the inputs of a plant.

    Parameters
    ----------
    level : pair of float
        From zero to the highest peak-to-peak voltage, or commanded amplitude, in V or m.
    frequency : pair of float
        Of the drive; equal where the amplitude holds at one frequency. [Hz]
    normal_load : pair of float
        Force pressing the bodies together. [N]
    sliding_speed : pair of float
        Macroscopic relative speed. [m/s]
    """

    level: Ends
    frequency: Ends
    normal_load: Ends
    sliding_speed: Ends

    @property
    def ends(self) -> tuple[Ends, Ends, Ends]:
        """Ranges of level, frequency and load, which set the vibration."""
        return self.level, self.frequency, self.normal_load


@dataclass(frozen=True, kw_only=True, slots=True)
class PinHeat:
    """Bodies of a contact and the pin's bulk, for its temperature.

    Parameters
    ----------
    pin, disc : ThermalSolid
    heat_capacity : float
        Heat that warms the pin by a kelvin. [J/K]
    thermal_conductance : float
        Heat that leaves the pin per kelvin. [W/K]
    """

    pin: thermal.ThermalSolid
    disc: thermal.ThermalSolid
    heat_capacity: float
    thermal_conductance: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PlantTables:
    """Steady states of a rig as tables, and the resonance by which its vibration follows the drive.

    Parameters
    ----------
    rig : Rig
    quantity : CommandedQuantity
    ranges : PlantRanges
    amplitude_per_level, velocity_per_level : ChebyshevTable
        Amplitude and peak velocity over voltage or amplitude, of level, frequency and load.
    threshold : ChebyshevTable
        Least sliding speed of the ratio for fast sliding over the velocity, of the load; 1 without.
    has_threshold : bool
    slow_ratio : ChebyshevTable
        Friction ratio below the threshold, of level, frequency, load and reduced speed.
    fast_ratio : ChebyshevTable
        Friction ratio above it, of level, frequency and load.
    resonance : mapping of str to ChebyshevTable
        Fields of `VibrationMode`, and its decay rate, of the load.
    heat : PinHeat or None
    heat_partition : ChebyshevTable or None
        Share of the heat that flows into the pin, of the sliding speed. []
    flash_rise_per_heat : ChebyshevTable or None
        Rise of the contact over the pin's bulk per heat, of the sliding speed, in K/W.
    relative_error : float
        Largest relative error of friction ratio and amplitude at points that the tables were not made from. []
    """

    rig: Rig
    quantity: CommandedQuantity
    ranges: PlantRanges
    amplitude_per_level: ChebyshevTable
    velocity_per_level: ChebyshevTable
    threshold: ChebyshevTable
    has_threshold: bool
    slow_ratio: ChebyshevTable
    fast_ratio: ChebyshevTable
    resonance: Mapping[str, ChebyshevTable]
    heat: PinHeat | None
    heat_partition: ChebyshevTable | None
    flash_rise_per_heat: ChebyshevTable | None
    relative_error: float = float("nan")

    @property
    def has_current(self) -> bool:
        """Whether a resonance with a known electrical branch takes a current."""
        return bool(self.resonance["motional_conductance"].coefficients.any())

    def friction_ratio(self, level: Floats, frequency: Floats, load: Floats, speed: Floats) -> Floats:
        """Steady friction ratio by the tables, as the exported C has it. []"""
        scale = level * self.velocity_per_level(level, frequency, load) * self.threshold(load)
        reduced = reduced_speed(speed / np.maximum(scale, 1e-300), self.has_threshold)
        slow = self.slow_ratio(level, frequency, load, reduced)
        return np.where(reduced < 1, slow, self.fast_ratio(level, frequency, load)) if self.has_threshold else slow

    def vibration_amplitude(self, level: Floats, frequency: Floats, load: Floats) -> Floats:
        """Steady amplitude by the tables, as the exported C has it. [m]"""
        return level * self.amplitude_per_level(level, frequency, load)


def plant_ranges(rig: Rig | ResolvedRig, *, over: Mapping[str, Ends] | None = None) -> PlantRanges:
    """Ranges of the inputs of a rig's plant.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    over : mapping of str to pair of float, optional
        Ends by key of the rig file, in SI. By default the level goes to the rig's own, the frequency 0.5 % to both
        sides of its own, the load a factor of 1.25 and the speed one of 2.

    Returns
    -------
    PlantRanges

    Raises
    ------
    InvalidInput
        If a key is none that an export has, a range does not rise from above zero, a stated amplitude is to hold at
        other frequencies, or the rig does not slide or has no voltage or amplitude.
    """
    resolved = resolved_rig(rig)
    rig, quantity = resolved.rig, commanded_quantity(resolved)
    given = dict(over or {})
    known = (quantity.key, *KEYS)
    for key, (low, high) in given.items():
        if key not in known:
            raise InvalidInput(f"{key}: no input of the plant; choose the ranges of {', '.join(known)}")
        least = 0.0 if key == quantity.key else np.finfo(float).tiny
        if not least <= low < high < np.inf:
            raise InvalidInput(f"{key}: needs a range from above 0 that rises, got {low:g} to {high:g}")
    own, speed = own_level(resolved), rig.sliding_speed
    if rig.drive is None or speed <= 0 or not own > 0:
        missing = "drive.frequency" if rig.drive is None else quantity.key if speed > 0 else "sliding.sliding_speed"
        raise InvalidInput(f"{rig.title}: {missing} must be above 0 for a plant about the rig's own point")
    f, load = rig.drive.frequency, rig.normal_load
    is_sine = resolved.vibration.driven is None
    if is_sine and "drive.frequency" in given:
        raise InvalidInput(
            f"{rig.title}: the amplitude {resolved.vibration.source} holds at {format_si(f, 'Hz', digits=4)} only;"
            " choose the amplitude computed for a range of drive.frequency"
        )
    band = 0.0 if is_sine else _FREQUENCY_BAND
    return PlantRanges(
        level=(0.0, given.get(quantity.key, (0.0, own))[1]),
        frequency=given.get("drive.frequency", (f * (1 - band), f * (1 + band))),
        normal_load=given.get("contact.normal_load", (load / _LOAD_SPAN, load * _LOAD_SPAN)),
        sliding_speed=given.get("sliding.sliding_speed", (speed / _SPEED_SPAN, speed * _SPEED_SPAN)),
    )


def reduced_speed(ratio: Floats, has_threshold: bool) -> Floats:
    """Variable of the tables from the speed over the scale, which is 1 from the threshold on, or for fast sliding."""
    return np.minimum(ratio, 1.0) ** 0.25 if has_threshold else np.sqrt(ratio / (1 + ratio))


def speed_over_scale(reduced: Floats, has_threshold: bool) -> Floats:
    """Speed over the scale by the variable of the tables."""
    return reduced**4 if has_threshold else reduced**2 / (1 - reduced**2)
