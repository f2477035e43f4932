"""A worker process: imports sonolube once, then answers requests one after the other, within limits."""

import contextlib
import gc
import json
import os
import signal
import sys
import traceback
from collections.abc import Mapping
from multiprocessing.connection import Connection
from typing import Any, Final

from sonolube.browser.places import OPENED, Places
from sonolube.errors import SonolubeError

_BAD_REQUEST, _REFUSED, _FAILED = 400, 422, 500
_GIBIBYTE: Final = 2**30


def limit_process(*, memory: int = 2 * _GIBIBYTE, file_size: int = _GIBIBYTE, cpu_time: int | None = None) -> None:
    """Limit what this process may use, where the system has such limits: bytes of memory and of a file, seconds."""
    try:
        import resource
    except ImportError:  # Windows
        return
    limits = {resource.RLIMIT_DATA: memory, resource.RLIMIT_FSIZE: file_size}
    if cpu_time is not None:
        limits[resource.RLIMIT_CPU] = cpu_time
    for kind, most in limits.items():
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(kind, (most, most))


def serve(connection: Connection, folder: str, warm: Connection) -> None:
    """Answer requests from a connection until it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends its workers
    os.chdir(folder)
    limit_process()
    warm_up()
    with contextlib.suppress(OSError):  # where the workbench has ended meanwhile, as the next line sees
        warm.send(True)
    while True:
        try:
            request = connection.recv()
        except (EOFError, OSError):
            return
        try:
            connection.send(reply(*request))
        except (BrokenPipeError, OSError):
            return


def warm_up() -> None:
    """Import what most requests need, and load the kernels of a first prediction."""
    with contextlib.suppress(SonolubeError):
        reply("task", {"task": "predict", "arguments": {"rig": {"name": OPENED}, "draws": 200}}, Places(rigs={}))
    gc.collect()
    gc.freeze()  # modules and kernels stay, so that later collections need not look at them


def reply(kind: str, payload: Mapping[str, Any], places: Places) -> tuple[int, bytes]:
    """Status and JSON of the answer to a request."""
    from sonolube.browser.answers import refusal_object
    from sonolube.browser.kinds import KINDS

    try:
        return 200, encoded(KINDS[kind](payload, places))
    except SonolubeError as failure:
        return _REFUSED, encoded(refusal_object(failure))
    except MemoryError:
        text = "does not fit into the memory of a worker; ask for fewer points, or use the terminal"
        return _REFUSED, encoded({"text": text, "faults": [{"key": "", "text": text}]})
    except (KeyError, TypeError, AttributeError, ValueError) as failure:
        traceback.print_exc(file=sys.stderr)
        return _FAILED, encoded({"text": f"a fault of sonolube: {type(failure).__name__}", "faults": []})


def encoded(content: Any) -> bytes:
    """JSON as bytes; numbers that JSON lacks become null."""
    try:
        return json.dumps(content, allow_nan=False).encode()
    except ValueError:
        return json.dumps(_finite(content)).encode()


def _finite(content: Any) -> Any:
    """Content with None in place of values that are not finite."""
    if isinstance(content, float):
        return content if content - content == 0.0 else None
    if isinstance(content, Mapping):
        return {key: _finite(value) for key, value in content.items()}
    return [_finite(each) for each in content] if isinstance(content, list | tuple) else content
