"""Rotation speeds and drive settings of set points, held to the limits of devices."""

from math import pi

from sonolube.errors import InvalidInput
from sonolube.lab.devices import Devices, DriveSetting
from sonolube.lab.interlocks import interlocks_for
from sonolube.protocol import Protocol, SetPoint, flattened
from sonolube.units import format_si


def require_possible(protocol: Protocol, devices: Devices) -> None:
    """Raise where devices cannot do what a protocol says, before anything is connected.

    Parameters
    ----------
    protocol : Protocol
    devices : Devices

    Raises
    ------
    InvalidInput
        Naming the step and the limit of the device, or the limit of the protocol that nothing can watch.
    """
    interlocks_for(protocol.limits, devices.acquisition.channels)
    diameter = groove_diameter(protocol, devices)
    for point in flattened(protocol):
        place = f"step {point.step}"
        if point.voltage_maximum > devices.drive.voltage_maximum * (1 + 1e-9):
            reached, most = (format_si(each, "V") for each in (point.voltage_maximum, devices.drive.voltage_maximum))
            raise InvalidInput(f"{place}: the drive reaches {reached}; {devices.drive.name} gives at most {most}")
        turns, fastest = rotation_speed(point, diameter), devices.motor.rotation_speed_maximum
        if turns > fastest * (1 + 1e-9):
            wanted, most = format_si(turns, "1/s"), format_si(fastest, "1/s")
            raise InvalidInput(f"{place}: needs {wanted}; {devices.motor.name} turns at most at {most}")
        for name in point.channels:
            if name not in devices.acquisition.channels:
                known = ", ".join(devices.acquisition.channels)
                raise InvalidInput(f"{place}: {devices.acquisition.name} has no channel {name}; it has {known}")


def groove_diameter(protocol: Protocol, devices: Devices) -> float:
    """Diameter of the circle under the pin, of the protocol or else of the rig. [m]

    Parameters
    ----------
    protocol : Protocol
    devices : Devices

    Returns
    -------
    float
    """
    return protocol.metadata.groove_diameter or devices.groove_diameter


def rotation_speed(point: SetPoint, diameter: float) -> float:
    """Speed of the disc that a set point asks for. [1/s]

    Parameters
    ----------
    point : SetPoint
    diameter : float
        Of the circle under the pin, in m.

    Returns
    -------
    float
    """
    if point.rotation_speed is not None:
        return point.rotation_speed
    return (point.sliding_speed or 0.0) / (pi * diameter)


def drive_setting(point: SetPoint) -> DriveSetting | None:
    """Output of the drive source that a set point asks for.

    Parameters
    ----------
    point : SetPoint

    Returns
    -------
    DriveSetting or None
        None for off.
    """
    if point.frequency is None or point.voltage_peak_to_peak == 0:
        return None
    return DriveSetting(
        voltage_peak_to_peak=point.voltage_peak_to_peak,
        voltage_offset=point.voltage_offset,
        frequency=point.frequency,
        waveform=point.waveform,
    )
