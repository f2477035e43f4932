"""Canonical names of instruments, by which a run reserves them: two ways to write one address have one name."""

import os
import re
from typing import Final

_SERIAL: Final = re.compile(r"ASRL(.*?)(::INSTR)?|(?:\\\\\.\\)?(COM\d+)", re.IGNORECASE)
_PORT: Final = re.compile(r"(?:\\\\\.\\)?(?:COM)?(\d+)", re.IGNORECASE)
_CLASSES: Final = ("instr", "socket", "raw")  # of resources


def visa_resource(resource: str) -> str:
    """Name of an instrument by its address: host and port, number of the serial port, bus and address.

    VISA takes board 0, device inst0 of a LAN instrument, interface 0 of one on USB and class INSTR where an address has
    none, and numbers in decimal or hexadecimal. ASRL3 is COM3 of Windows.

    Source: IVI Foundation, VPP-4.3, The VISA Library, grammar of address strings.
    """
    serial = _SERIAL.fullmatch(resource.strip())
    if serial:
        port = serial[1] or serial[3] or "0"
        number = _PORT.fullmatch(port)
        return f"serial {int(number[1])}" if number else f"serial {os.path.realpath(port)}"
    interface, *parts = resource.strip().lower().split("::")
    kind, board = re.fullmatch(r"(\D*)(\d*)", interface).groups()  # type: ignore[union-attr]
    parts = [part for part in parts if part not in _CLASSES]
    if kind == "tcpip":
        host, *others = parts
        return " ".join([kind, host, *(map(_number, others) if others != ["inst0"] else ())])
    if kind == "usb":
        maker, model, *others = parts
        return " ".join([kind, _number(maker), _number(model), *(others[:-1] if others[1:] == ["0"] else others)])
    return " ".join([f"{kind}{int(board or 0)}", *map(_number, parts)])


def _number(part: str) -> str:
    """Part of an address, a number as a decimal one."""
    if re.fullmatch(r"0x[0-9a-f]+", part):
        return str(int(part, 16))
    return str(int(part)) if part.isdecimal() else part
