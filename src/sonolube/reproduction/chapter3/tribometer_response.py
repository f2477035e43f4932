"""Response of the identified tribometer over voltage, speed, frequency and waveform, and its start-up."""

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.facts.published import published_number, si_value
from sonolube.models.dynamics import modes
from sonolube.reproduction.tribometer_rigs import tribometer_rig
from sonolube.rig import (
    StartUp,
    frequency_grid,
    frequency_study,
    least_power_study,
    operating_points,
    speed_study,
    start_up,
    structure_in_contact,
    voltage_study,
    waveform_study,
)

if TYPE_CHECKING:
    import xarray as xr

CURVE_VOLTAGES: Final = (20.0, 50.0, 100.0, 200.0)
"""Voltages of the curves over speed and frequency, peak to peak; D states only their range. [V]"""

STEPS_PER_PERIOD: Final = 16
"""Steps of a start-up in each period."""

_DURATION: Final = 0.1  # s, twice the stated time to the steady state


@cache
def response_over_voltage(friction_model: str = "asperity_stick_slip") -> "xr.Dataset":
    """Response over the voltages of figure 3.15."""
    volts = published_number("3.3.5-voltage")
    return voltage_study(
        tribometer_rig(friction_model=friction_model), voltage_peak_to_peak=np.linspace(volts.low, volts.high, 101)
    )


@cache
def response_over_speed() -> "xr.Dataset":
    """Response over the sliding speeds of figure 3.16, from a thousandth of the highest."""
    highest = published_number("3.3.5-sliding-speed").high
    return speed_study(
        tribometer_rig(), sliding_speed=np.geomspace(1e-3 * highest, highest, 31), voltage_peak_to_peak=CURVE_VOLTAGES
    )


@cache
def response_over_frequency() -> "xr.Dataset":
    """Response over the frequencies of figure 3.17."""
    return frequency_study(tribometer_rig(), frequency=_frequencies(), voltage_peak_to_peak=CURVE_VOLTAGES)


@cache
def least_power_over_frequency() -> "xr.Dataset":
    """Voltage and powers over frequency at the friction of the tests."""
    rig = tribometer_rig()
    return least_power_study(
        rig,
        frequency=_frequencies(),
        friction_ratio=float(operating_points(rig).friction_ratio),
        voltage_maximum=published_number("3.3.5-voltage").high,
    )


@cache
def response_over_waveform(friction_model: str = "asperity_stick_slip") -> "xr.Dataset":
    """Response to the waveforms of figure 3.18, from 0 to 200 V."""
    rig, volts = tribometer_rig(friction_model=friction_model), si_value("3.3.5-waveform-voltage")
    drive = replace(
        rig.drive, voltage_peak_to_peak=volts, voltage_offset=volts / 2, frequency=si_value("3.3.5-waveform-frequency")
    )
    return waveform_study(replace(rig, drive=drive, sliding_speed=si_value("3.3.5-waveform-sliding-speed")))


@cache
def start_up_from_rest() -> StartUp:
    """Start-up of the tribometer from rest, figure 3.13."""
    return start_up(tribometer_rig(), duration=_DURATION)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Envelope:
    """Envelope of a displacement over the periods of the drive.

    Parameters
    ----------
    time : ndarray, shape (n,)
        End of each period. [s]
    low, high : ndarray, shape (n,)
        Lowest and highest displacement in each period, in m.
    """

    time: Floats
    low: Floats
    high: Floats


def envelope(*, displacement: Floats) -> Envelope:
    """Envelope of a displacement of the start-up.

    Parameters
    ----------
    displacement : ndarray, shape (n,)
        Displacement at the times of the start-up. [m]

    Returns
    -------
    Envelope
    """
    time, x = start_up_from_rest().trajectory.time, displacement[1:]
    periods = x.size // STEPS_PER_PERIOD
    steps = x[: periods * STEPS_PER_PERIOD].reshape(periods, STEPS_PER_PERIOD)
    return Envelope(
        time=time[STEPS_PER_PERIOD::STEPS_PER_PERIOD][:periods], low=steps.min(axis=1), high=steps.max(axis=1)
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Resonance:
    """Resonance of the stack on the loaded contact, with its half-power bandwidth.

    Parameters
    ----------
    natural_frequency : float
        Undamped natural frequency. [Hz]
    damping_ratio : float
        Damping over critical damping. []
    """

    natural_frequency: float
    damping_ratio: float

    def nearest(self, frequency: Floats) -> int:
        """Index of the frequency nearest to the resonance."""
        return int(np.argmin(np.abs(frequency - self.natural_frequency)))

    def outside(self, frequency: Floats) -> NDArray[np.bool_]:
        """Which frequencies are outside the half-power bandwidth."""
        return np.asarray(np.abs(frequency / self.natural_frequency - 1) > self.damping_ratio)


@cache
def resonance() -> Resonance:
    """Resonance of the tribometer."""
    natural = modes(structure_in_contact(tribometer_rig()))
    return Resonance(
        natural_frequency=float(natural.natural_frequency[-1]), damping_ratio=float(natural.damping_ratio[-1])
    )


def _frequencies() -> Floats:
    """Frequencies of figure 3.17, concentrated about the resonance. [Hz]"""
    limits = published_number("3.3.5-frequency")
    return frequency_grid(tribometer_rig(), lowest=limits.low, highest=limits.high, points=60, resonance_points=31)
