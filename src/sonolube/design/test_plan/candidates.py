"""Candidate tests of a rig from the values of its factors, and which of them the rig cannot make."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Final

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.thermal import EllipticSource, contact_rise
from sonolube.prediction.inputs import RigInputs
from sonolube.rig import PowerToSupply, Rig, friction_point, thermal_solid
from sonolube.text.units import format_si, to_si

MAX_CANDIDATES: Final = 200
"""Number of candidates among which points are chosen."""

_SAME: Final = 1e-5  # relative difference of settings that were rounded in text


@dataclass(frozen=True, kw_only=True, slots=True)
class Factors:
    """Values of the factors of a plan.

    Parameters
    ----------
    normal_load : ndarray
        [N]
    sliding_speed : ndarray
        [m/s]
    vibration_amplitude : ndarray
        [m]
    """

    normal_load: Floats
    sliding_speed: Floats
    vibration_amplitude: Floats

    def __post_init__(self) -> None:
        require_positive(normal_load=self.normal_load)
        require_positive(sliding_speed=self.sliding_speed)
        require_positive(vibration_amplitude=self.vibration_amplitude)
        count = self.normal_load.size * self.sliding_speed.size * self.vibration_amplitude.size
        if count > MAX_CANDIDATES:
            raise InvalidInput(
                f"the factors have {count} points, but at most {MAX_CANDIDATES} are compared; give fewer values"
            )


@dataclass(frozen=True, kw_only=True, slots=True)
class RigLimits:
    """Limits of amplifier and contact, each None where there is none.

    Parameters
    ----------
    voltage_maximum : float or None
        Magnitude of the drive voltage, its offset included. [V]
    power_to_supply : float or None
        Power of the amplifier. [W]
    mean_temperature_rise : float or None
        Of the contact by friction without vibration. [K]
    """

    voltage_maximum: float | None = None
    power_to_supply: float | None = None
    mean_temperature_rise: float | None = None


NO_LIMITS: Final[RigLimits] = RigLimits()
"""Limits of a rig that has none."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Candidates:
    """Candidate tests, arrays of shape (m,).

    Parameters
    ----------
    normal_load : ndarray
        [N]
    sliding_speed : ndarray
        [m/s]
    vibration_amplitude : ndarray
        [m]
    voltage_peak_to_peak : ndarray
        NaN where the rig states no voltage. [V]
    voltage_offset : ndarray
        [V]
    power_to_supply : ndarray
        NaN where it is not known. [W]
    charging_power : ndarray
        Part of it that charges the capacitance, D 1.9. [W]
    dissipated_power : ndarray
        Part of it that the motion turns into heat; where it is NaN the power to supply is a lower bound. [W]
    mean_temperature_rise : ndarray
        Of the contact by friction without vibration, the greatest; NaN without materials. [K]
    refused : tuple of str
        Why the rig cannot make a test; empty where it can.
    own : int
        Index of the rig's own operating point.
    """

    normal_load: Floats
    sliding_speed: Floats
    vibration_amplitude: Floats
    voltage_peak_to_peak: Floats
    voltage_offset: Floats
    power_to_supply: Floats
    charging_power: Floats
    dissipated_power: Floats
    mean_temperature_rise: Floats
    refused: tuple[str, ...]
    own: int


def candidate_tests(
    rig: Rig, inputs: RigInputs, factors: Factors, *, limits: RigLimits, pin: str | None = None, disc: str | None = None
) -> Candidates:
    """Candidate tests of a rig with drive, heat, and what exceeds the limits; the rig's own operating point is one.

    The amplitude is proportional to the voltage, as it is where own runs state voltages. The power is that of
    `sonolube.rig.friction_point` at each voltage; the heat that of the friction without vibration.
    """
    points, own = _points(factors, (rig.normal_load, inputs.sliding_speed, inputs.amplitude.value))
    loads, speeds, amplitudes = points.T
    different, order = np.unique(amplitudes, return_inverse=True)
    voltage, offset, power = _driven(rig, inputs, different)
    heat = inputs.friction.value * loads * speeds
    found = Candidates(
        normal_load=loads,
        sliding_speed=speeds,
        vibration_amplitude=amplitudes,
        voltage_peak_to_peak=voltage[order],
        voltage_offset=offset[order],
        **{name: values[order] for name, values in power.items()},
        mean_temperature_rise=heat * _rise_per_watt(rig, speeds, pin, disc),
        refused=(),
        own=own,
    )
    return replace(found, refused=tuple("; ".join(reasons) for reasons in _exceeded(found, limits)))


def _points(factors: Factors, own: tuple[float, float, float]) -> tuple[Floats, int]:
    """Load, speed and amplitude of each point, shape (m, 3), and the index of the rig's own, the first if it is new."""
    points = np.array(list(product(factors.normal_load, factors.sliding_speed, factors.vibration_amplitude)))
    same = np.all(np.isclose(points, own, rtol=_SAME, atol=0), axis=1)
    return (points, int(np.argmax(same))) if same.any() else (np.vstack([own, points]), 0)


_PARTS: Final = ("power_to_supply", "charging_power", "dissipated_power")


def _driven(rig: Rig, inputs: RigInputs, amplitudes: Floats) -> tuple[Floats, Floats, dict[str, Floats]]:
    """Voltage, its offset, and power to supply with its parts at each amplitude; NaN where they are not known."""
    unknown = np.full(amplitudes.shape, np.nan)
    if rig.drive is None or inputs.voltage_peak_to_peak is None:
        return unknown, np.zeros(amplitudes.shape), dict.fromkeys(_PARTS, unknown)
    share = amplitudes / inputs.amplitude.value
    voltage, offset = share * inputs.voltage_peak_to_peak, share * rig.drive.voltage_offset
    powers = [
        friction_point(
            replace(rig, drive=replace(rig.drive, voltage_peak_to_peak=float(one), voltage_offset=float(middle)))
        ).power
        for one, middle in zip(voltage, offset, strict=True)
    ]
    known = {name: np.array([_number_of(each, name) for each in powers]) for name in _PARTS}
    return voltage, offset, known


def _number_of(power: PowerToSupply | None, part: str) -> float:
    """Part of a power; NaN where it is not known."""
    value = getattr(power, part, None)
    return np.nan if value is None else float(value)


def _rise_per_watt(rig: Rig, speeds: Floats, pin: str | None, disc: str | None) -> Floats:
    """Mean temperature rise of the contact, taken as circular, for a watt of friction at each speed. [K/W]"""
    if pin is None or disc is None:
        if pin is not None or disc is not None:
            raise InvalidInput("the temperature rise needs both materials; give --pin and --disc, or neither")
        return np.full(speeds.shape, np.nan)
    radius = float(np.sqrt(rig.contact.nominal_area / np.pi))
    source = EllipticSource(half_length=radius, half_width=radius)
    upper, lower = thermal_solid(pin), thermal_solid(disc)
    found = {
        speed: float(contact_rise(upper, lower, source, heat_rate=1.0, sliding_speed=speed).mean_temperature_rise)
        for speed in np.unique(speeds)
    }
    return np.array([found[speed] for speed in speeds])


def _exceeded(found: Candidates, limits: RigLimits) -> Iterator[list[str]]:
    """Limits that each candidate exceeds, in words."""
    checked = (
        (np.abs(found.voltage_offset) + found.voltage_peak_to_peak / 2, limits.voltage_maximum, "V", "drive reaches"),
        (found.power_to_supply, limits.power_to_supply, "W", "amplifier would supply"),
        (found.mean_temperature_rise, limits.mean_temperature_rise, "K", "contact would be hotter by"),
    )
    for index in range(found.normal_load.size):
        yield [
            f"{text} {format_si(values[index], unit)}, limit {format_si(limit, unit)}"
            for values, limit, unit, text in checked
            if limit is not None and values[index] > limit * (1 + 1e-9)
        ]


MAX_VALUES: Final = 200
"""Number of values of one factor."""

_NUMBER: Final = re.compile(r"[-+.\deE]+")
_DIGITS: Final = 3  # of values between the ends of a range, so that they can be set


def factor_values(text: str, *, unit: str, option: str, count: int) -> Floats:
    """Values of a factor in SI, rising."""
    return _range_values(text, unit, option, count) if ":" in text else _listed(text, unit, option)


def _range_values(text: str, unit: str, option: str, count: int) -> Floats:
    """Values in equal ratios between two ends."""
    parts = [part.strip() for part in text.split(":")]
    number = _split_unit(parts[-1])[0]
    if len(parts) == 3:
        if not number.isdigit():
            raise InvalidInput(f"{option} {text}: the third part is a number of values, such as 20:200:7mm/s")
        if not 2 <= int(number[:9]) <= MAX_VALUES:
            raise InvalidInput(f"{option} {text}: a range has 2 to {MAX_VALUES} values")
        count = int(number)
    elif len(parts) != 2:
        raise InvalidInput(f"{option} {text}: must look like first:last, first:last:count or one,two,...")
    common = _split_unit(parts[-1])[1]
    low, high = (_number(part, common, unit, option) for part in parts[:2])
    if not 0 < low < high:
        raise InvalidInput(f"{option} {text}: the first value must be above 0 and below the last")
    return np.array([float(f"{each:.{_DIGITS}g}") for each in np.geomspace(low, high, count)])


def _listed(text: str, unit: str, option: str) -> Floats:
    """Values of a list."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) > MAX_VALUES:
        raise InvalidInput(f"{option}: {len(parts)} values; at most {MAX_VALUES}")
    common = _split_unit(parts[-1])[1]
    values = np.unique([_number(part, common, unit, option) for part in parts])
    if not np.all(values > 0):
        raise InvalidInput(f"{option} {text}: values must be above 0")
    return np.asarray(values)


def _split_unit(text: str) -> tuple[str, str]:
    """Number and unit of a text."""
    found = _NUMBER.match(text)
    return (found[0], text[found.end() :].strip()) if found else ("", text)


def _number(text: str, common: str, unit: str, option: str) -> float:
    """Number in SI, with the common unit where it has none."""
    number, own = _split_unit(text)
    return to_si(f"{number} {own or common}".strip(), unit=unit, name=option)
