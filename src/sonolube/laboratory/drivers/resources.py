"""Canonical names of devices, by which a run reserves them: two ways to write one address have one name."""

import os
import re
from typing import Final

_SERIAL: Final = re.compile(r"ASRL(.*?)(::INSTR)?", re.IGNORECASE)


def daqmx_resource(terminal: str) -> str:
    """Name of a device of NI-DAQmx.

    Parameters
    ----------
    terminal : str
        The device or one of its terminals, such as Dev1 or Dev1/ao0; NI-DAQmx does not tell upper from lower case.

    Returns
    -------
    str
    """
    return f"NI-DAQmx {terminal.partition('/')[0]}".lower()


def visa_resource(resource: str) -> str:
    """Name of an instrument by its address: host and port, number of the serial port, bus and address.

    Parameters
    ----------
    resource : str
        As VISA calls it, such as TCPIP0::192.168.1.21::5025::SOCKET or ASRL/dev/ttyUSB0::INSTR.

    Returns
    -------
    str
    """
    serial = _SERIAL.fullmatch(resource)
    if serial:
        port = serial[1]
        return f"serial {port}".lower() if port.isdigit() else f"serial {os.path.realpath(port)}"
    interface, *parts = resource.lower().split("::")
    kind, board = re.fullmatch(r"(\D*)(\d*)", interface).groups()  # type: ignore[union-attr]
    if kind == "tcpip":
        parts, board = [part for part in parts if part not in ("instr", "socket", "inst0")], ""
    elif kind == "usb":
        parts = [str(int(part, 16)) if part.startswith("0x") else part for part in parts if part not in ("instr", "0")]
    else:
        parts = [part for part in parts if part != "instr"]
    bus = f"{kind}{int(board or 0)}" if kind not in ("tcpip", "usb") else kind
    return " ".join([bus, *parts])
