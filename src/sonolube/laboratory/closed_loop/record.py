"""Records of friction held in closed loop: reference, steps of the speed, and result."""

from dataclasses import dataclass
from itertools import pairwise

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.design.control import FrictionController
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Limits
from sonolube.laboratory.drive_sampling import DriveSampling


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
    is_safe : bool
        Whether drive and motor have confirmed that they are off.
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
    is_safe: bool
