"""Driven rig, whose stack, structure and drive voltage are known, so that its motion can be computed; its excitation.

Of the drive voltage: waveform, harmonics, extremes, and the charge of a capacitance from a linear amplifier.
"""

from dataclasses import dataclass, fields
from functools import cached_property
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.models.actuator import PiezoStack
from sonolube.models.actuator.drive import Drive, linear_amplifier_power
from sonolube.models.dynamics import WAVEFORMS, Sine, Structure, Waveform
from sonolube.models.dynamics.waveform import fourier_coefficients, sampled_waveform, waveform_extremes
from sonolube.rig.record import Rig


@final
@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class DrivenRig(Rig):
    """A rig with everything that a computed motion needs.

    Parameters
    ----------
    stack : PiezoStack
        Piezoelectric stack.
    structure : Structure
        Masses, springs and dampers, or modes, with the stack in them.
    drive : Drive
        Drive of the stack, with its voltage.

    Raises
    ------
    InvalidInput
        If one of them, or the voltage of the drive, is missing.

    Notes
    -----
    `read_rig` returns one for a file with the tables `stack` and `structure`; `driven_rig` turns a `Rig` into one.
    """

    stack: PiezoStack
    structure: Structure
    drive: Drive

    def __post_init__(self) -> None:
        Rig.__post_init__(self)
        if self.stack is None or self.structure is None:
            raise InvalidInput(
                f"{self.title}: the tables stack and structure are missing, of which its motion is computed;"
                " `sonolube example tribometer` writes a rig that has both; or sweep over"
                " vibration.vibration_amplitude, which needs none"
            )
        require_drive(self)

    @property
    def voltage_peak_to_peak(self) -> float:
        """Difference of the highest and the lowest drive voltage. [V]"""
        assert self.drive.voltage_peak_to_peak is not None  # checked at construction
        return self.drive.voltage_peak_to_peak


def require_drive(rig: Rig) -> Drive:
    """Drive of a rig whose drive voltage is known."""
    if rig.drive is None or rig.drive.voltage_peak_to_peak is None:
        raise InvalidInput(
            f"{rig.title}: drive.voltage_peak_to_peak is missing; give the voltage under which its amplitude holds, or"
            " sweep over vibration.vibration_amplitude"
        )
    return rig.drive


def driven_rig(rig: Rig) -> DrivenRig:
    """Rig as one whose motion can be computed; the rig itself where it is one already."""
    if isinstance(rig, DrivenRig):
        return rig
    return DrivenRig(**{field.name: getattr(rig, field.name) for field in fields(rig) if field.init})


_VOLTAGE_HARMONICS = 64  # the 65th of a square wave moves the tip by less than 1e-5 of the first

NO_DISSIPATED_POWER = (
    "no dissipated power: the vibration is a sine of a stated amplitude, which no structure with losses gives; take the"
    " amplitude computed, from the tables stack and structure"
)
"""Reason for which a stated vibration has no dissipated power, and advice."""


def waveform_of(drive: Drive) -> Waveform:
    """Shape of the drive voltage."""
    return WAVEFORMS[drive.waveform] if drive.waveform_samples is None else sampled_waveform(drive.waveform_samples)


@dataclass(frozen=True, kw_only=True, eq=False)
class DriveVoltage:
    """Voltage of a drive over time, its waveform evaluated once.

    Parameters
    ----------
    drive : Drive
    """

    drive: Drive

    @cached_property
    def waveform(self) -> Waveform:
        """Shape of the voltage."""
        return waveform_of(self.drive)

    @cached_property
    def harmonics_per_volt(self) -> Complexes:
        """Harmonics V_k of V = offset + Re sum V_k exp(2 pi i k f t) over the voltage peak to peak. []"""
        return voltage_harmonics(self.waveform)

    def harmonics(self, *, voltage_peak_to_peak: ArrayLike | None = None) -> Complexes:
        """Harmonics of the voltage along the last axis, at other voltages peak to peak where given. [V]"""
        return self._swing(voltage_peak_to_peak)[..., np.newaxis] * self.harmonics_per_volt

    def range(
        self, *, voltage_peak_to_peak: ArrayLike | None = None, voltage_offset: ArrayLike | None = None
    ) -> tuple[Floats, Floats]:
        """Lowest and highest voltage, at other voltages peak to peak and offsets where given. [V]"""
        offset = np.asarray(self.drive.voltage_offset if voltage_offset is None else voltage_offset, dtype=np.float64)
        swing, (lowest, highest) = self._swing(voltage_peak_to_peak), self._extremes_per_volt
        return offset + swing * lowest, offset + swing * highest

    def charging_power(
        self,
        *,
        capacitance: float,
        voltage_peak_to_peak: ArrayLike | None = None,
        voltage_offset: ArrayLike | None = None,
        frequency: ArrayLike | None = None,
    ) -> Floats:
        """Charge of a capacitance from a linear amplifier, its rail at the highest voltage, D 1.9. [W]"""
        lowest, highest = self.range(voltage_peak_to_peak=voltage_peak_to_peak, voltage_offset=voltage_offset)
        return linear_amplifier_power(
            capacitance=capacitance,
            voltage_maximum=np.maximum(np.abs(lowest), np.abs(highest)),
            voltage_peak_to_peak=self._swing(voltage_peak_to_peak),
            frequency=self.drive.frequency if frequency is None else frequency,
        )

    @cached_property
    def _extremes_per_volt(self) -> tuple[float, float]:
        return waveform_extremes(self.waveform)

    def _swing(self, voltage_peak_to_peak: ArrayLike | None) -> Floats:
        own = self.drive.voltage_peak_to_peak or 0.0
        return require_non_negative(voltage_peak_to_peak=own if voltage_peak_to_peak is None else voltage_peak_to_peak)


def voltage_harmonics(waveform: Waveform) -> Complexes:
    """Harmonics V_k, V = offset + Re sum V_k exp(2 pi i k f t), of a voltage of 1 V peak to peak. [V]"""
    count = 1 if isinstance(waveform, Sine) else _VOLTAGE_HARMONICS
    return 2 * fourier_coefficients(waveform, count)[1:]


def actuator_capacitance(rig: Rig) -> float | None:
    """Capacitance that an amplifier drives: that of the stack, else of the actuator. [F]"""
    return rig.capacitance if rig.stack is None else rig.stack.free_capacitance
