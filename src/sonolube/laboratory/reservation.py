"""Reservation of devices for one run of a user, whatever folder, map or program it comes from."""

import hashlib
import json
import os
import platform
import re
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any, Final

from sonolube.errors import InvalidInput
from sonolube.laboratory.devices import DeviceError
from sonolube.operating_system import process_start, remove_file
from sonolube.storage.files import is_locked, locked_folder, user_state_folder, write_atomically

_HOLDER: Final = "holder.json"  # process that has a device
_LARGEST: Final = 10_000  # bytes of it


class DeviceInUse(DeviceError):
    """A device that another run has."""


@contextmanager
def reserved(resources: Sequence[str]) -> Iterator[None]:
    """Keep other runs of this user from devices inside a `with` block; a dead process keeps nobody out."""
    with ExitStack() as held:
        for resource in sorted(set(resources)):
            held.enter_context(_reserved(resource))
        yield


def require_free(resources: Sequence[str]) -> None:
    """Raise where a run has one of these devices."""
    with reserved(resources):
        pass


@contextmanager
def _reserved(resource: str) -> Iterator[None]:
    """Keep other runs from one device."""
    folder = _folder(resource)
    with ExitStack() as held:
        try:
            held.enter_context(locked_folder(folder, purpose="run"))
        except InvalidInput:
            if is_locked(folder):
                raise _in_use(resource, folder) from None
            raise
        if _is_alive(_holder(folder)):  # of a file system without locks
            raise _in_use(resource, folder)
        own = {"process": os.getpid(), "started": process_start(os.getpid()), "folder": str(Path.cwd())}
        write_atomically(folder / _HOLDER, json.dumps(own))
        held.callback(remove_file, folder / _HOLDER)
        yield


def _folder(resource: str) -> Path:
    """Folder of the lock of a device, which is one of this computer unless it is on the network."""
    place = "network" if resource.startswith("tcpip ") else platform.node() or "computer"
    words = re.sub(r"[^a-z0-9]+", "-", f"{place} {resource}".lower()).strip("-")[:80]
    digest = hashlib.sha256(f"{place} {resource}".encode()).hexdigest()[:8]  # of names with the same letters
    return user_state_folder() / "devices" / f"{words}-{digest}"


def _in_use(resource: str, folder: Path) -> DeviceInUse:
    """Refusal with the process that has a device."""
    holder = _holder(folder)
    process = holder.get("process")
    if not process:
        return DeviceInUse(f"{resource} is in use by another run; wait for its end")
    if not _is_alive(holder):
        return DeviceInUse(
            f"{resource} is in use by a program that process {process}, now dead, had started; see that motor and drive"
            " are off, and end it"
        )
    return DeviceInUse(f"{resource} is in use by another run: process {process}, started in {holder.get('folder')}")


def _holder(folder: Path) -> dict[str, Any]:
    """Process that has, or had, a device; empty where none is known."""
    with suppress(OSError, ValueError, RecursionError):
        found = json.loads((folder / _HOLDER).read_bytes()[:_LARGEST])
        if isinstance(found, dict) and isinstance(found.get("process"), int):
            return found
    return {}


def _is_alive(holder: dict[str, Any]) -> bool:
    """Whether the very process lives, and not a later one of the same number."""
    started = process_start(holder["process"]) if holder else ""
    return bool(started) and started == holder.get("started")
