"""Friction to be held in closed loop: reference, steps of the speed, limits, channels and protocol; what was held."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import ceil
from typing import Any, Final

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.design.control import ControlDesign, ControlSettings, FrictionController
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Limits, Protocol, exact_text, protocol_from
from sonolube.laboratory.block import Channel
from sonolube.laboratory.interlocks import DriveSampling, interlocks_for
from sonolube.laboratory.verdict import Verdict
from sonolube.models.actuator.drive import Drive
from sonolube.text.units import format_si


@dataclass(frozen=True, kw_only=True, slots=True)
class SpeedStep:
    """Sliding speed from a time on.

    Parameters
    ----------
    time : float
        Since the controller took over. [s]
    sliding_speed : float
        [m/s]
    """

    time: float
    sliding_speed: float

    def __post_init__(self) -> None:
        require_non_negative(time=self.time, sliding_speed=self.sliding_speed)


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionHold:
    """Friction to be held at a reference while the sliding speed changes.

    Parameters
    ----------
    controller : FrictionController
        As `sonolube.design.control.design_control` tunes it; its sampling interval is that of the loop.
    friction_force : float
        Reference. [N]
    frequency : float
        Of the drive. [Hz]
    speeds : tuple of SpeedStep
        In the order of time, the first at 0.
    duration : float
        Time under control. [s]
    limits : Limits
        Which end the test, as in a protocol.
    run_in : float
        Time of sliding without vibration before it, in s.
    offset_ratio : float
        Mean voltage over peak-to-peak voltage; one half never pulls at the actuator.
    averaging : float
        Part of each interval, at its end, whose mean is the measured friction.
    sample_rate : float
        Of the acquisition. [Hz]

    Raises
    ------
    InvalidInput
        If a value has no meaning, speeds are not in the order of time, or an interval is no whole number of samples.
    """

    controller: FrictionController
    friction_force: float
    frequency: float
    speeds: tuple[SpeedStep, ...]
    duration: float
    limits: Limits
    run_in: float = 1.0
    offset_ratio: float = 0.5
    averaging: float = 1.0
    sample_rate: float = 2000.0

    def __post_init__(self) -> None:
        require_positive(frequency=self.frequency, duration=self.duration, sample_rate=self.sample_rate)
        require_non_negative(friction_force=self.friction_force, run_in=self.run_in)
        require_finite(offset_ratio=self.offset_ratio)
        if not 0 < self.averaging <= 1:
            raise InvalidInput(f"averaging must be above 0 and at most 1, got {self.averaging:g}")
        times = [step.time for step in self.speeds]
        if not times or times[0] != 0 or any(late <= early for early, late in pairwise(times)):
            raise InvalidInput(f"speeds must start at 0 s and follow in the order of time, got times {times}")
        self.samples_per_interval(self.sample_rate)

    @property
    def voltage_maximum(self) -> float:
        """Greatest magnitude of the voltage that the controller may command, its offset included. [V]"""
        return (abs(self.offset_ratio) + 0.5) * self.controller.level_maximum

    @property
    def drive_sampling(self) -> DriveSampling:
        """Sample rate and frequency of the drive, a sine."""
        return DriveSampling(sample_rate=self.sample_rate, frequency=self.frequency)

    def samples_per_interval(self, sample_rate: float) -> int:
        """Number of samples in an interval of the controller.

        Parameters
        ----------
        sample_rate : float
            [Hz]

        Returns
        -------
        int

        Raises
        ------
        InvalidInput
            If the interval is no whole number of samples, within a thousandth.
        """
        exact = sample_rate * self.controller.process.sample_interval
        if exact < 0.5 or abs(round(exact) / exact - 1) > 1e-3:
            raise InvalidInput(
                f"sample_rate {sample_rate:g} Hz makes {exact:g} samples in an interval of"
                f" {self.controller.process.sample_interval:g} s; take one that makes a whole number"
            )
        return round(exact)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HeldFriction:
    """Friction under control; every array has one entry per interval of the controller.

    Parameters
    ----------
    hold : FrictionHold
    time : ndarray
        Start of each interval since the controller took over. [s]
    setpoint : ndarray
        Reference, in N.
    friction_force : ndarray
        Mean over the interval as the controller measures it. [N]
    friction_force_deviation : ndarray
        Standard deviation of its samples within the interval. [N]
    voltage_peak_to_peak : ndarray
        Drive over the interval. [V]
    sliding_speed : ndarray
        [m/s]
    intrinsic_friction_force : float
        Mean over the run-in, NaN without one. [N]
    outcome : str
        completed, stopped or failed.
    reason : str
        Why it ended before its time.
    verdict : Verdict or None
        On motor and drive after the end; None where the loop connected no device.
    """

    hold: FrictionHold
    time: Floats
    setpoint: Floats
    friction_force: Floats
    friction_force_deviation: Floats
    voltage_peak_to_peak: Floats
    sliding_speed: Floats
    intrinsic_friction_force: float
    outcome: str
    reason: str
    verdict: Verdict | None

    @property
    def is_safe(self) -> bool:
        """Whether drive and motor are off, as far as the verdict knows."""
        return self.verdict is None or self.verdict.is_off


_RECORDED: Final = ("friction_force", "normal_load", "voltage_peak_to_peak", "voltage", "temperature", "gaussmeter")
_MIN_WAIT: Final = 1e-6  # s


def recorded_channels(hold: FrictionHold, channels: Mapping[str, Channel]) -> tuple[str, ...]:
    """Channels that are recorded while friction is held: those of its analysis, and those that limits watch.

    Parameters
    ----------
    hold : FrictionHold
    channels : mapping of str to Channel
        Of the acquisition, by name.

    Returns
    -------
    tuple of str
    """
    watched = (lock.channel.name for lock in interlocks_for(hold.limits, channels, hold.drive_sampling))
    return tuple(dict.fromkeys([*(name for name in _RECORDED if name in channels), *watched]))


def hold_protocol(hold: FrictionHold, channels: Mapping[str, Channel]) -> Protocol:
    """Speeds and recording of a hold as a protocol; the voltage, which the controller sets, is not in it.

    Parameters
    ----------
    hold : FrictionHold
    channels : mapping of str to Channel
        Of the acquisition, by name.

    Returns
    -------
    Protocol
    """
    names = recorded_channels(hold, channels)
    total = hold.run_in + hold.duration
    rate, lasts = exact_text(hold.sample_rate, unit="Hz"), exact_text(total, unit="s")
    steps: list[dict[str, Any]] = [{"kind": "acquire", "channels": list(names), "sample_rate": rate, "duration": lasts}]
    begins = [0.0, *(hold.run_in + step.time for step in hold.speeds[1:]), total]
    for step, (begin, end) in zip(hold.speeds, pairwise(begins), strict=True):
        steps.append({"kind": "motor_speed", "sliding_speed": exact_text(step.sliding_speed, unit="m/s")})
        if end - begin >= _MIN_WAIT:
            steps.append({"kind": "wait", "duration": exact_text(end - begin, unit="s")})
    return protocol_from(
        {
            "title": f"Friction held at {format_si(hold.friction_force, 'N')}",
            "source": "sonolube lab hold: the drive voltage is that of the controller",
            "limits": hold.limits.model_dump(mode="json", exclude_none=True),
            "steps": steps,
        }
    )


_SAMPLE_RATE = 2000.0  # Hz, at least
_HEADROOM = 1.1  # of the limit of the measured voltage, for noise, over the voltage that may be commanded


def planned_hold(
    drive: Drive,
    design: ControlDesign,
    *,
    speeds: tuple[SpeedStep, ...],
    settings: ControlSettings,
    run_in: float,
    temperature: float | None,
    force: float | None,
) -> FrictionHold:
    """Friction to be held by a controller, with the limits that end the test.

    Parameters
    ----------
    drive : Drive
    design : ControlDesign
    speeds : tuple of SpeedStep
    settings : ControlSettings
        Of the design.
    run_in : float
        Time of sliding before the controller takes over, in s.
    temperature : float or None
        Limit of the temperature. [K]
    force : float or None
        Limit of the friction force, in N.

    Returns
    -------
    FrictionHold
    """
    swing = drive.voltage_peak_to_peak or 0.0
    ratio = drive.voltage_offset / swing if swing else 0.0
    highest = _HEADROOM * (abs(ratio) + 0.5) * design.controller.level_maximum
    rate = 1 / settings.sample_interval
    return FrictionHold(
        controller=design.controller,
        friction_force=design.friction_force,
        frequency=drive.frequency,
        speeds=speeds,
        duration=settings.duration,
        limits=_limits(highest, lasts=run_in + settings.duration, temperature=temperature, force=force),
        run_in=run_in,
        offset_ratio=ratio,
        sample_rate=rate * ceil(_SAMPLE_RATE / rate),
    )


def _limits(voltage: float, *, lasts: float, temperature: float | None, force: float | None) -> Limits:
    """Limits that end the test."""
    content = {"voltage_maximum": exact_text(voltage, unit="V"), "duration_maximum": exact_text(lasts, unit="s")}
    if temperature is not None:
        content["temperature_maximum"] = exact_text(temperature, unit="K")
    if force is not None:
        content["friction_force_maximum"] = exact_text(force, unit="N")
    return Limits.model_validate(content)
