"""Workbench and browser where no other host can be reached, as a process: `python -m tests.browser.isolated FOLDER`."""

import errno
import json
import socket
import sys
from pathlib import Path

from tests.browser.pages import VOLTS, enter, numbers, opened, show, started_browser
from tests.browser.workbench import served

_ELSEWHERE = ("192.0.2.1", 80)  # an address of documentation, RFC 5737


def raise_loopback() -> None:
    """Let this computer reach itself in a network namespace of its own."""
    import fcntl
    import struct

    flags, set_flags = 0x1 | 0x40, 0x8914  # up and running; SIOCSIFFLAGS
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as device:
        fcntl.ioctl(device, set_flags, struct.pack("16sh", b"lo", flags))


def has_route() -> bool:
    """Whether another host could be reached."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as outside:
        outside.setblocking(False)
        return outside.connect_ex(_ELSEWHERE) != errno.ENETUNREACH


def visited(folder: Path) -> dict[str, list[list[str]]]:
    """Numbers of a changed rig, after all pages were shown; `opened` refuses requests to other hosts."""
    with served(folder) as workbench, started_browser() as browser, opened(browser, workbench) as page:
        page.route(lambda url: not url.startswith((workbench.address, "data:", "blob:")), lambda route: route.abort())
        for where in ("explore", "dissertation", "jobs", "new", "predict"):
            show(page, workbench, "tribometer", {}, where=where)
        enter(page, VOLTS, "21 V")
        return {"numbers": numbers(page)}


if __name__ == "__main__":
    raise_loopback()
    sys.stdout.write(json.dumps(visited(Path(sys.argv[1])) | {"has_route": has_route()}))
