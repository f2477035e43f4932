"""What each channel of a device map reads on a virtual rig, by its quantity and name."""

import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from sonolube.laboratory.block import Channel
from sonolube.laboratory.drivers.entry import AcquisitionEntry, ChannelEntry
from sonolube.laboratory.rehearsal.faults import ActiveFaults
from sonolube.laboratory.virtual_tribometer.streams import Source
from sonolube.text.units import format_si

_BY_QUANTITY: Final[Mapping[str, str]] = {  # signals of the virtual rig
    "friction_force": "friction_force",
    "normal_load": "normal_load",
    "stack_voltage": "voltage",
    "voltage_peak_to_peak": "voltage_peak_to_peak",
    "stack_current": "current",
    "stack_current_peak": "current_peak",
    "stack_current_rms": "current_rms",
    "magnetic_flux_density": "gaussmeter",
    "rotation_speed": "rotation_speed",
    "vibration_amplitude": "vibration_amplitude",
    "vibration_velocity": "surface_velocity",
    "surface_velocity": "surface_velocity",
    "surface_displacement": "surface_displacement",
    "displacement": "displacement",
}
_PLACES: Final[Mapping[str, float | None]] = {  # words in names of thermocouples; None for one that the rig has not
    "ambient": None,
    "room": None,
    "air": None,
    "disc": None,
    "pin": 1.0,
    "contact": 1.0,
    "actuator": 0.0,
    "stack": 0.0,
    "transducer": 0.0,
    "piezo": 0.0,
}
_SPOKEN: Final = {0.0: "actuator", 1.0: "contact: pin and flash"}
_NOISE_SHARE: Final = 1e-3  # of the half width of the range, of a channel at rest
_NOISE: Final = 1e-3  # in SI, where it has no range


@dataclass(frozen=True, kw_only=True, slots=True)
class SimulatedChannel:
    """Channel of a device map on a virtual rig.

    Parameters
    ----------
    name, clock : str
        Of the channel, and of its acquisition; empty for that of protocols.
    quantity : str
    reads : str
        What it reads, in words.
    is_simulated : bool
        Whether the rig has that; else it is the value at rest.
    error : float
        Deviation of its calibration in this run, in SI.
    """

    name: str
    clock: str
    quantity: str
    reads: str
    is_simulated: bool
    error: float = 0.0

    @property
    def told(self) -> str:
        """What it reads, and by which clock, in words."""
        return f"{self.reads}{f', clock {self.clock}' if self.clock else ''}"

    @property
    def described(self) -> str:
        """Channel and what it reads, in words."""
        return f"{self.name}: {self.told}"


def generator_of(seed: int, channel: str, part: str) -> np.random.Generator:
    """Random numbers of a channel of a map and a part of its noise, whatever else the map has."""
    key = zlib.crc32(f"{channel} {part}".encode())
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_OWN, key)))


_OWN: Final = 1_000  # beside the streams of the virtual rig


def source_of(
    entry: AcquisitionEntry,
    channel_entry: ChannelEntry,
    channel: Channel,
    *,
    clock: str,
    files: Mapping[str, str],
    thermocouple: str,
    ambient_temperature: float,
    seed: int,
    active: ActiveFaults,
) -> tuple[Source, SimulatedChannel]:
    """Source of a channel of a map, and what is said of it.

    Parameters
    ----------
    entry : AcquisitionEntry
    channel_entry : ChannelEntry
    channel : Channel
        With its range.
    clock : str
        Name of its acquisition.
    files : mapping of str to str
        Of the map.
    thermocouple : str
        Place of the channel `temperature` by the protocol; empty where it says none.
    ambient_temperature : float
        [K]
    seed : int
    active : ActiveFaults

    Returns
    -------
    Source
    SimulatedChannel
    """
    name, uncertainty = channel.name, channel_entry.uncertainty_value
    error = uncertainty * float(generator_of(seed, name, "error").standard_normal()) if uncertainty else 0.0
    chain, broken = entry.chain(name, files), entry.open_reading(name, files)
    signal, share, words = _signal(channel, thermocouple)
    rest = ambient_temperature if channel.quantity == "temperature" else _rest(channel)
    width = channel.highest - channel.lowest
    noise = _NOISE_SHARE * width / 2 if np.isfinite(width) else _NOISE
    source = Source(
        signal=signal,
        contact_share=share,
        rest=rest,
        noise=noise if channel.quantity != "temperature" else _NOISE,
        reading=lambda values: active.read(channel, chain(active.sensed(channel, values) + error), broken=broken),
    )
    if signal == "rest":
        words = f"{words}: reads {format_si(rest, channel.unit)} with noise"
    told = SimulatedChannel(
        name=name, clock=clock, quantity=channel.quantity, reads=words, is_simulated=signal != "rest", error=error
    )
    return source, told


def _signal(channel: Channel, thermocouple: str) -> tuple[str, float | None, str]:
    """Signal of a channel, place of a thermocouple, and what it reads in words."""
    if channel.quantity == "temperature":
        return _thermocouple(channel.name, thermocouple)
    signal = _BY_QUANTITY.get(channel.quantity)
    if signal is None or (signal.startswith("surface") and channel.unit not in ("m/s", "m")):
        return "rest", None, f"the virtual rig has no {channel.quantity.replace('_', ' ')}"
    if signal == "displacement" and "vibrometer" in channel.name:
        signal = "surface_displacement"
    return signal, None, _WORDS.get(signal, channel.quantity.replace("_", " "))


_WORDS: Final[Mapping[str, str]] = {
    "voltage": "voltage at the actuator",
    "current": "current into the actuator",
    "gaussmeter": "pulses of the Hall probe, one a turn",
    "surface_velocity": "velocity of the contact by vibration",
    "surface_displacement": "displacement of the contact by vibration",
    "displacement": "deflection of the holder by friction",
}


def _thermocouple(name: str, thermocouple: str) -> tuple[str, float | None, str]:
    """Signal and place of a thermocouple by its name, that of the standard name by the protocol."""
    words = name.lower().split("_")
    place = next((word for word in words if word in _PLACES), thermocouple if name == "temperature" else "")
    if not place:
        return "rest", None, "neither map nor protocol says where the thermocouple stands"
    share = _PLACES[place]
    if share is None:
        return "rest", None, f"the virtual rig does not warm its {place}"
    return "temperature", share, f"temperature of the {_SPOKEN[share]}"


def _rest(channel: Channel) -> float:
    """Value at rest: 0, or the middle of a range without it."""
    if channel.lowest <= 0 <= channel.highest:
        return 0.0
    return (channel.lowest + channel.highest) / 2
