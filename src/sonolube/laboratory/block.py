"""Channels of an acquisition and blocks of their samples."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sonolube.errors import UnknownName
from sonolube.vocabulary import unit_of

CHANNEL_QUANTITIES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "friction_force": "friction_force",
        "normal_load": "normal_load",
        "voltage": "stack_voltage",
        "voltage_peak_to_peak": "voltage_peak_to_peak",
        "current": "stack_current",
        "current_peak": "stack_current_peak",
        "current_rms": "stack_current_rms",
        "temperature": "temperature",
        "rotation_speed": "rotation_speed",
        "gaussmeter": "magnetic_flux_density",
        "displacement": "displacement",
    }
)
"""Quantity of the vocabulary that each channel of a protocol measures; recordings are named by the quantity."""


BLOCK_DURATION: Final = 0.05
"""Longest time between two looks at the limits, and at requests to pause or stop. [s]"""


@dataclass(frozen=True, kw_only=True, slots=True)
class Sensor:
    """Sensor of a channel, as the device map states it; empty where it does not.

    Parameters
    ----------
    identifier : str
        Serial number of sensor or amplifier.
    calibration : str
        Gain and offset, or points.
    calibrated : str
        Date of the calibration, such as 2026-03-01.
    uncertainty : float or None
        Standard uncertainty of a reading, in SI.
    """

    identifier: str = ""
    calibration: str = ""
    calibrated: str = ""
    uncertainty: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Channel:
    """Channel of an acquisition.

    Parameters
    ----------
    name : str
        As protocols name it, such as gaussmeter.
    quantity : str
        Of the vocabulary, whose SI unit the samples have, or a free one.
    lowest, highest : float
        Range of sensor and input, in SI; samples at an end of it are saturated.
    free_unit : str
        SI unit of a free quantity; empty for those of the vocabulary and for pure numbers.
    limit : float
        Greatest magnitude that the rig stands, in SI, beyond which every run ends.
    sample_rate : float or None
        That of an acquisition with a clock of its own; None where the protocol tells it. [Hz]
    sensor : Sensor
    """

    name: str
    quantity: str
    lowest: float = -np.inf
    highest: float = np.inf
    free_unit: str = ""
    limit: float = np.inf
    sample_rate: float | None = None
    sensor: Sensor = Sensor()

    @property
    def unit(self) -> str:
        """SI unit of the samples."""
        return self.free_unit or unit_of(self.quantity)

    @property
    def is_watched_at_rest(self) -> bool:
        """Whether its limits hold while motor and drive are off and people work at the rig."""
        return self.quantity == "temperature" or self.limit < np.inf

    @property
    def is_standard(self) -> bool:
        """Whether it has one of the names that every rig uses for the quantity."""
        return CHANNEL_QUANTITIES.get(self.name) == self.quantity


@dataclass(frozen=True, kw_only=True, slots=True)
class Block:
    """Samples of all channels that were taken one after the other on a hardware clock.

    Parameters
    ----------
    first_sample : int
        Number of the first sample since the acquisition started, from 0, by the counter of the hardware.
    sample_rate : float
        Of each channel. [Hz]
    values : ndarray, shape (samples, channels)
        In SI, channels in the order in which they were asked for.
    """

    first_sample: int
    sample_rate: float
    values: NDArray[np.float64]

    def __post_init__(self) -> None:
        """Make values floating-point: the magnitude of the lowest integer of a kind is negative, within all limits."""
        object.__setattr__(self, "values", np.asarray(self.values, dtype=np.float64))

    @property
    def samples(self) -> int:
        """Number of samples of each channel."""
        return int(self.values.shape[0])

    @property
    def next_sample(self) -> int:
        """Number that the first sample of the next block must have."""
        return self.first_sample + self.samples

    @property
    def start(self) -> float:
        """Time of the first sample since the acquisition started. [s]"""
        return self.first_sample / self.sample_rate


def quantity_of(channel: str) -> str:
    """Quantity of the vocabulary that a channel of a protocol measures."""
    try:
        return CHANNEL_QUANTITIES[channel]
    except KeyError:
        raise UnknownName.among(CHANNEL_QUANTITIES, kind="channel", name=channel) from None
