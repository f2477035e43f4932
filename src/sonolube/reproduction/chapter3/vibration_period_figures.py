"""Section 3.3.5, voltage: figure of velocity, tangential stiffness and friction within one period of the vibration."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.figure import ReportFigure
from sonolube.models.contact import cube_tangential_stiffness, separation
from sonolube.reproduction.chapter3.tribometer_response import response_over_voltage
from sonolube.reproduction.plots import axes_row, line_style
from sonolube.reproduction.tribometer_rigs import IDENTIFIED_NOTE, tribometer_rig

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
    """Figure of one period."""
    yield ReportFigure(
        name="figure-3-15-period",
        title="Velocity, tangential stiffness and friction in one period",
        caption="As D figure 3.15 (b) to (d): the computed motion, and the cube on it, 3 N, 22 kHz and 20.3 mm/s, "
        "stiffness by D 3.44, friction by D 3.47 with the resultant velocity. Both peak where the bodies are closest, "
        "as in D; their scales are logarithmic, and what is below a ten-thousandth is not drawn. The legend has "
        "the mean of this friction, D 3.48: it grows with the voltage, beyond that without vibration, and other models "
        f"take its place. {IDENTIFIED_NOTE}.",
        draw=_period,
    )


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
