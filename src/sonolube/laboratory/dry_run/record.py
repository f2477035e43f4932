"""Records of a dry run: set points with their amplitudes and loads, recordings, durations and findings."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

from sonolube.facts.protocol import Protocol, SetPoint
from sonolube.laboratory.dry_run.amplifier_load import DriveLoad
from sonolube.laboratory.dry_run.heating import Heating

SAMPLE_SIZE: Final = 8
"""Bytes of one sample of a raw block."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PlannedPoint:
    """Set point of a protocol with amplitude, friction and current of a rig; None where unknown.

    Parameters
    ----------
    setting : SetPoint
    duration : float
        Until the next set point. [s]
    content : str
        What a prompt asks, a check looks at, or a wait is for.
    sliding_speed : float or None
        [m/s]
    vibration_amplitude : float or None
        Vibration of the contact, zero to peak. [m]
    friction_force : float or None
        Mean friction force. [N]
    load : DriveLoad or None
    """

    setting: SetPoint
    duration: float
    content: str = ""
    sliding_speed: float | None = None
    vibration_amplitude: float | None = None
    friction_force: float | None = None
    load: DriveLoad | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class PlannedRecording:
    """Recording of a protocol.

    Parameters
    ----------
    step : str
        Place of its step.
    start : float
        Time at which it starts, in s.
    duration : float
        [s]
    sample_rate : float
        Of each channel. [Hz]
    channels : tuple of str
    """

    step: str
    start: float
    duration: float
    sample_rate: float
    channels: tuple[str, ...]

    @property
    def samples(self) -> int:
        """Number of samples of all channels."""
        return round(self.duration * self.sample_rate) * len(self.channels)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DryRun:
    """Planned course of a protocol.

    Parameters
    ----------
    protocol : Protocol
    rig_title : str
        Empty without a rig.
    points : tuple of PlannedPoint
        One a set point, the end included.
    recordings : tuple of PlannedRecording
    duration : float
        Time without prompts. [s]
    prompt_time : float
        Time that prompts are taken to need, in s.
    heating : Heating or None
        Temperatures over the time line.
    refusals : tuple of str
        What makes the test impossible or ends it early, each in one line.
    caveats : tuple of str
        What else to know before it, each in one line.
    assumptions : mapping of str to str
    """

    protocol: Protocol
    rig_title: str
    points: tuple[PlannedPoint, ...]
    recordings: tuple[PlannedRecording, ...]
    duration: float
    prompt_time: float
    heating: Heating | None = None
    refusals: tuple[str, ...] = ()
    caveats: tuple[str, ...] = ()
    assumptions: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def samples(self) -> int:
        """Number of samples of all recordings and channels."""
        return sum(recording.samples for recording in self.recordings)

    @property
    def bytes(self) -> int:
        """Size of the raw blocks."""
        return SAMPLE_SIZE * self.samples

    @property
    def amplifier_energy(self) -> float | None:
        """Energy that a linear amplifier draws for the drive; None where it is not known. [J]"""
        loads = [(point.load, point.duration) for point in self.points]
        if any(load is None for load, _ in loads):
            return None
        return sum(load.actuator_power * lasts for load, lasts in loads if load is not None)
