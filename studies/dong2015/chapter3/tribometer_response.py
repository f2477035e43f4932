"""Response of the identified tribometer over voltage, speed, frequency and waveform, start-up, and one period."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from dong2015.plots import axes_row, line_style, report_figure
from dong2015.published_rigs import IDENTIFIED_NOTE, tribometer_rig
from sonolube.checks import Floats
from sonolube.facts.published import published_number, si_value
from sonolube.figure import ReportFigure
from sonolube.models.contact import cube_tangential_stiffness, separation
from sonolube.models.dynamics import modes
from sonolube.rig import (
    StartUp,
    frequency_grid,
    frequency_response,
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
    from matplotlib.figure import Figure

CURVE_VOLTAGES: Final = (20.0, 50.0, 100.0, 200.0)
"""Voltages of the curves over speed and frequency, peak to peak; D states only their range. [V]"""

_IMPEDANCE_RANGE: Final = (15e3, 30e3)  # Hz, about the resonance of the tests; D only draws its own

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


_VOLTAGES: Final = (50.0, 100.0, 150.0, 200.0)
_SAMPLES: Final = 1024  # friction peaks within a hundredth of the period
_MIN_DRAWN: Final = 1e-4  # of the value at rest: "virtually zero" in D 3.3.5


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class VibrationPeriod:
    """One period of the contact at a voltage.

    Parameters
    ----------
    turns : ndarray, shape (n,)
        Time over the period, from 0 to 1.
    displacement : ndarray, shape (n,)
        Of the tip from its place at rest, away from the disc. [m]
    velocity : ndarray, shape (n,)
        Of the tip, away from the disc, in m/s.
    stiffness_ratio : ndarray, shape (n,)
        Tangential stiffness of the cube over that at rest.
    friction_ratio : ndarray, shape (n,)
        Instantaneous friction over friction without vibration. []
    """

    turns: Floats
    displacement: Floats
    velocity: Floats
    stiffness_ratio: Floats
    friction_ratio: Floats


def vibration_period_figures() -> Iterator[ReportFigure]:
    """Figures of impedance and of one period."""
    yield report_figure("figure-3-12-impedance", _impedance, identified=IDENTIFIED_NOTE)
    yield report_figure("figure-3-15-period", _period, identified=IDENTIFIED_NOTE)


def _impedance() -> "Figure":
    """Draw magnitude and phase of the electrical impedance of the tribometer over frequency."""
    figure, (magnitude, phase) = axes_row(2, (7.4, 3.3), sharex=True)
    found = frequency_response(tribometer_rig(), frequency=np.linspace(*_IMPEDANCE_RANGE, 2001))
    magnitude.semilogy(1e-3 * found.frequency, found.impedance, **line_style(0))
    phase.plot(1e-3 * found.frequency, np.degrees(found.phase), **line_style(0))
    magnitude.set(xlabel="Frequency [kHz]", ylabel="Magnitude of the impedance [Ω]")
    phase.set(xlabel="Frequency [kHz]", ylabel="Phase [degrees]", yticks=(-90, -45, 0, 45, 90))
    for axes in (magnitude, phase):
        axes.axvline(1e-3 * si_value("2.3.1-frequency"), color="0.5", linestyle=":", label="drive of the tests")
    magnitude.legend(loc="lower right")
    return figure


@cache
def vibration_period(voltage: float) -> VibrationPeriod:
    """One period of the tribometer at a voltage with the cube on it, D 3.44 and 3.47."""
    rig, study = tribometer_rig(), response_over_voltage()
    sampled = study["displacement"].sel(voltage_peak_to_peak=voltage, method="nearest").values
    harmonics = np.fft.rfft(sampled, norm="forward")
    rate = 2j * np.pi * rig.drive.frequency * np.arange(harmonics.size)
    x, velocity = (np.fft.irfft(each, _SAMPLES, norm="forward") for each in (harmonics, rate * harmonics))
    at_rest = float(separation(rig.contact, normal_load=rig.normal_load))
    stiffness, of_rest = (cube_tangential_stiffness(rig.contact, separation=at_rest + gap) for gap in (x, 0.0))
    ratio = stiffness / of_rest
    cosine = rig.sliding_speed / np.hypot(rig.sliding_speed, velocity)
    whole = [np.append(values, values[0]) for values in (x, velocity, ratio, ratio * cosine)]
    turns = np.linspace(0.0, 1.0, x.size + 1)
    return VibrationPeriod(
        turns=turns, displacement=whole[0], velocity=whole[1], stiffness_ratio=whole[2], friction_ratio=whole[3]
    )


def mean_friction_ratio(voltage: float) -> float:
    """Mean friction ratio at a voltage by D 3.48 as printed, about the mean at rest. []"""
    study = response_over_voltage("dong_2015_full_period")
    return float(study["raw_friction_ratio"].sel(voltage_peak_to_peak=voltage, method="nearest"))


def _period() -> "Figure":
    """Draw velocity, stiffness and friction over one period at four voltages."""
    figure, (velocity, stiffness, friction) = axes_row(3, (7.8, 3.2))
    for index, voltage in enumerate(_VOLTAGES):
        period, style = vibration_period(voltage), line_style(index)
        velocity.plot(
            period.turns, period.velocity, **style, label=f"{voltage:g} V, mean {mean_friction_ratio(voltage):.2f}"
        )
        stiffness.plot(period.turns, period.stiffness_ratio, **style)
        friction.plot(period.turns, period.friction_ratio, **style)
    velocity.set(ylabel="Velocity of the tip [m/s]", yticks=(-2, -1, 0, 1, 2))
    stiffness.set(ylabel="Tangential stiffness over that at rest [1]")
    friction.set(ylabel="Friction over that without vibration [1]")
    for axes in (stiffness, friction):
        axes.set(yscale="log", ylim=(_MIN_DRAWN, 1e3), yticks=(1e-4, 1e-2, 1, 100))
        axes.yaxis.set_major_formatter("{x:g}")
        axes.minorticks_off()
        axes.axhline(1.0, color="0.4", linestyle=":", linewidth=1)
    for axes in (velocity, stiffness, friction):
        axes.set(xlabel="Time over the period [1]", xlim=(0, 1), xticks=(0, 0.5, 1))
    figure.legend(*velocity.get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return figure
