"""Readiness of a device map: packages and drivers missing, demands of a protocol beyond it, a first block read."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from math import ceil
from pathlib import Path

from sonolube.errors import InvalidInput
from sonolube.extras import EXTRAS
from sonolube.facts.protocol import Protocol, SetPoint, flattened
from sonolube.laboratory.devices import DeviceError, Devices
from sonolube.laboratory.drivers.daqmx_library import DRIVER_REMEDY, daqmx_errors, daqmx_library
from sonolube.laboratory.drivers.device_map import DeviceMap, read_device_map
from sonolube.laboratory.reservation import reserved
from sonolube.laboratory.set_points import highest_of_steps, impossibilities
from sonolube.text.units import format_si

BLOCK_DURATION = 0.1
"""Of the first look. [s]"""

_DRIVING = ("drive", "voltage_steps", "sweep")


def missing_parts(device_map: DeviceMap) -> tuple[str, ...]:
    """Packages and drivers that a device map needs and that are not installed, each with its remedy.

    Parameters
    ----------
    device_map : DeviceMap

    Returns
    -------
    tuple of str
    """
    missing = [
        f"{EXTRAS[name].package} is not installed: {EXTRAS[name].command}"
        for name in device_map.extras
        if not EXTRAS[name].is_installed
    ]
    if "daqmx" in device_map.extras and EXTRAS["daqmx"].is_installed and not _has_daqmx_driver():
        missing.append(f"the driver NI-DAQmx is not installed: {DRIVER_REMEDY}")
    return tuple(missing)


def unfulfilled(device_map: DeviceMap, protocol: Protocol) -> tuple[str, ...]:
    """Demands of a protocol that the devices of a map cannot meet.

    Parameters
    ----------
    device_map : DeviceMap
    protocol : Protocol

    Returns
    -------
    tuple of str
        All of them, each with its step.
    """
    beyond = highest_of_steps(_beyond(device_map, flattened(protocol)))
    return (*impossibilities(protocol, device_map.devices()), *beyond)


def _beyond(device_map: DeviceMap, points: Sequence[SetPoint]) -> Iterator[tuple[str, str, float, str]]:
    """Step, kind, value and text of frequencies and sample rates beyond the devices of a map."""
    highest = device_map.frequency_maximum
    further = device_map.entries.acquisitions.values()
    beside = {each.name for entry in further for each in entry.channel_entries}
    total = device_map.entries.acquisition.total_rate_maximum
    for point in points:
        place, frequency, rate = f"step {point.step}", point.frequency, point.sample_rate
        if frequency is not None and frequency > highest * (1 + 1e-9) and point.kind in _DRIVING:
            wanted, most = format_si(frequency, "Hz"), format_si(highest, "Hz")
            yield point.step, "frequency", frequency, f"{place}: drives at {wanted}; the drive gives at most {most}"
        count = sum(name not in beside for name in point.channels)
        if rate is not None and rate * count > total * (1 + 1e-9) and point.kind == "acquire":
            wanted = f"{count} channels at {format_si(rate, 'Hz')}"
            text = f"{place}: records {wanted}; the device takes {format_si(total, 'Hz')} in all"
            yield point.step, "rate", rate, text


def first_readings(devices: Devices, *, sample_rate: float) -> dict[str, float]:
    """Connect all devices, read one block of all channels with motor and drive off, and release the devices.

    Parameters
    ----------
    devices : Devices
    sample_rate : float
        Of each channel that has no rate of its own. [Hz]

    Returns
    -------
    dict of str to float
        Mean of each channel in SI.

    Raises
    ------
    DeviceError
        If a device is missing, does not answer or is in use by a run; the others are off and released then.
    """
    with reserved(devices.resources), ExitStack() as after:
        guarded = () if devices.guard is None else (devices.guard,)
        inputs = (devices.acquisition, *devices.further.values())
        for device in (*inputs, *guarded, devices.drive, devices.motor):
            after.callback(device.close)
            device.connect()
        devices.drive.off()
        devices.motor.off()
        means: dict[str, float] = {}
        for each in inputs:
            names = list(each.channels)
            rate = each.start(names, sample_rate=each.channels[names[0]].sample_rate or sample_rate)
            values = each.read(max(ceil(BLOCK_DURATION * rate), 1)).values.mean(axis=0)
            means |= {name: float(mean) for name, mean in zip(names, values, strict=True)}
        return means


def _has_daqmx_driver() -> bool:
    """Whether the driver of NI-DAQmx answers."""
    try:
        library = daqmx_library()
        with daqmx_errors("NI-DAQmx"):
            library.system.System.local().driver_version  # noqa: B018
    except (DeviceError, ImportError):
        return False
    return True


def ready_devices(device_map: Path) -> Devices:
    """Devices of a map, whose packages and drivers are installed."""
    found = read_device_map(device_map)
    missing = missing_parts(found)
    if missing:
        raise InvalidInput(f"{device_map}: {'; '.join(missing)}")
    return found.devices()
