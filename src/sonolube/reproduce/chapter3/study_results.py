"""What the identified tribometer does over voltage, speed, frequency, waveform and load, computed once."""

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics import modes
from sonolube.rig import (
    StartUp,
    frequency_grid,
    frequency_study,
    least_power_study,
    load_study,
    operating_points,
    speed_study,
    start_up,
    structure_in_contact,
    voltage_study,
    waveform_study,
)
from sonolube.validation.inputs import said
from sonolube.validation.tribometer_rig import plate_rig, tribometer_rig

if TYPE_CHECKING:
    import xarray as xr

CURVES = (20.0, 50.0, 100.0, 200.0)
"""Voltages of the curves over speed and frequency, peak to peak, in V; D names none but their range."""

_DURATION = 0.1  # s, twice the time to the steady state that is stated
STEPS_PER_PERIOD = 16
"""Steps of a start-up."""


@cache
def over_voltage(friction_model: str = "asperity_stick_slip") -> "xr.Dataset":
    """Return the tribometer over the voltages of figure 3.15."""
    volts = said("3.3.5-voltage")
    return voltage_study(
        tribometer_rig(friction_model=friction_model), voltage_peak_to_peak=np.linspace(volts.low, volts.high, 101)
    )


@cache
def over_speed() -> "xr.Dataset":
    """Return the tribometer over the sliding speeds of figure 3.16, from a thousandth of the highest."""
    highest = said("3.3.5-sliding-speed").high
    return speed_study(
        tribometer_rig(), sliding_speed=np.geomspace(1e-3 * highest, highest, 31), voltage_peak_to_peak=CURVES
    )


@cache
def over_frequency() -> "xr.Dataset":
    """Return the tribometer over the frequencies of figure 3.17."""
    return frequency_study(tribometer_rig(), frequency=_frequencies(points=60), voltage_peak_to_peak=CURVES)


@cache
def power_over_frequency() -> "xr.Dataset":
    """Return what it takes over frequency to have the friction that the tests' drive gives."""
    rig = tribometer_rig()
    return least_power_study(
        rig,
        frequency=_frequencies(points=60),
        friction_ratio=float(operating_points(rig).friction_ratio),
        voltage_maximum=said("3.3.5-voltage").high,
    )


@cache
def over_waveform(friction_model: str = "asperity_stick_slip") -> "xr.Dataset":
    """Return the tribometer under the waveforms of figure 3.18, from 0 to 200 V."""
    rig, volts = tribometer_rig(friction_model=friction_model), said("3.3.5-waveform-voltage").value
    drive = replace(
        rig.drive,
        voltage_peak_to_peak=volts,
        voltage_offset=volts / 2,
        frequency=said("3.3.5-waveform-frequency").value,
    )
    return waveform_study(replace(rig, drive=drive, sliding_speed=said("3.3.5-waveform-sliding-speed").value))


@cache
def over_load() -> "xr.Dataset":
    """Return the tribometer with the steel plates and weights of section 4.1, at the settings of its example test."""
    loads = said("4.1.1-normal-load")
    return load_study(plate_rig(), normal_load=np.arange(loads.low, loads.high + 0.125, 0.25))


@cache
def from_rest() -> StartUp:
    """Return how the tribometer starts up, figure 3.13."""
    return start_up(tribometer_rig(), duration=_DURATION)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Envelope:
    """Highest displacement of the tip in each period of a start-up, and when that period ends, in s and m."""

    time: Floats
    highest: Floats


def envelope() -> Envelope:
    """Return the upper envelope of the tip's start-up."""
    marched = from_rest().trajectory
    x = marched.contact.displacement[1:]
    periods = x.size // STEPS_PER_PERIOD
    steps = x[: periods * STEPS_PER_PERIOD].reshape(periods, STEPS_PER_PERIOD)
    return Envelope(time=marched.time[STEPS_PER_PERIOD::STEPS_PER_PERIOD][:periods], highest=steps.max(axis=1))


@dataclass(frozen=True, kw_only=True, slots=True)
class Resonance:
    """The stack's resonance on the loaded contact, and the width at half its power.

    Parameters
    ----------
    natural_frequency : float
        Frequency without damping. [Hz]
    damping_ratio : float
        Damping over critical damping. []
    """

    natural_frequency: float
    damping_ratio: float

    def place(self, frequency: Floats) -> int:
        """Return which of the frequencies is the resonance."""
        return int(np.argmin(np.abs(frequency - self.natural_frequency)))

    def outside(self, frequency: Floats) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
        """Return which frequencies lie outside the half-power width."""
        return np.asarray(np.abs(frequency / self.natural_frequency - 1) > self.damping_ratio)


@cache
def resonance() -> Resonance:
    """Return the tribometer's resonance."""
    natural = modes(structure_in_contact(tribometer_rig()))
    return Resonance(
        natural_frequency=float(natural.natural_frequency[-1]), damping_ratio=float(natural.damping_ratio[-1])
    )


def _frequencies(*, points: int) -> Floats:
    ends = said("3.3.5-frequency")
    return frequency_grid(tribometer_rig(), lowest=ends.low, highest=ends.high, points=points, resonance_points=31)
