"""The process of one run: `python -m sonolube.browser.lab.runner FOLDER` follows a protocol and serves its stop page.

It belongs to no workbench: the end of that, of its terminal or of the network changes nothing of the run.
"""

import json
import os
import sys
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final

from sonolube.browser.lab.live_run import LiveRun
from sonolube.browser.lab.runner_records import END, REQUEST, RUNNER, write_private
from sonolube.browser.lab.stop_page import StopServer
from sonolube.browser.requests import Places
from sonolube.errors import SonolubeError
from sonolube.laboratory import RunControl
from sonolube.operating_system import process_start
from sonolube.storage.files import locked_folder
from sonolube.storage.interruption import asked_by_signal, end_program_at_signals, undone_at_signal
from sonolube.tasks.faults import unexpected

_AT_WORK: Final = "at-work"


class _Recorded(LiveRun):
    """State of a run whose folder is told to the record of the runner."""

    def __init__(self, about: Mapping[str, Any], control: RunControl, folder: Path) -> None:
        super().__init__(about, control)
        self._record, self.known = folder / RUNNER, dict[str, Any]()

    def records(self, folder: Path) -> None:
        """Take the folder of the record."""
        super().records(folder)
        self.known["run_folder"] = str(folder.resolve())
        write_private(self._record, self.known)


def main(folder: Path) -> None:
    """Follow the protocol of a request to its end."""
    end_program_at_signals()
    request = json.loads((folder / REQUEST).read_text(encoding="utf-8"))
    control = RunControl()
    live = _Recorded(request["about"], control, folder)
    server = StopServer(live, control)
    server.start()
    live.known.update(
        {
            "process": os.getpid(),
            "started": process_start(os.getpid()),
            "port": server.port,
            "token": server.token,
            "control": server.control,
        }
    )
    write_private(folder / RUNNER, live.known)
    try:
        with ExitStack() as stack:
            stack.enter_context(undone_at_signal(lambda: _note_early_end(live, folder)))
            stack.enter_context(asked_by_signal(control.stop, is_final=True))
            stack.enter_context(locked_folder(folder.parent / _AT_WORK, purpose="run of the laboratory"))
            ended = _followed(request, live, control)
    except SonolubeError as failure:
        ended = _broken(live, str(failure))
    except BaseException as failure:  # whatever it was, the outputs were switched off on the way
        ended = _broken(live, str(unexpected(failure, "lab run", request)))
    live.end(*ended)
    try:
        write_private(folder / END, live.status())
    finally:
        server.close()


def _broken(live: LiveRun, reason: str) -> tuple[str, str, str]:
    """State, outcome and reason where the task gave no answer: before anything was connected, or after all is over."""
    state = live.status()["state"]
    return ("safe", "refused", reason) if state == "preparing" else (state, "failed", reason)


def _note_early_end(live: LiveRun, folder: Path) -> None:
    """Record an end by a signal before anything was connected; later ones are ends of the run."""
    if live.status()["state"] == "preparing":
        live.end("safe", "refused", "ended by a signal before anything was connected")
        write_private(folder / END, live.status())


def _followed(request: Mapping[str, Any], live: LiveRun, control: RunControl) -> tuple[str, str, str]:
    """State, outcome and reason of a run, after it."""
    from sonolube.browser.answers import given_rig
    from sonolube.tasks.files import NamedBytes
    from sonolube.tasks.lab.protocol_run import RunAnswer, run

    places = Places(**request["places"])
    name, text = request["protocol"]["name"], request["protocol"].get("text")
    if places.device_map:
        on: dict[str, Any] = {"device_map": places.device_map}
    else:
        on = {"seed": request["seed"], "real_time": True}
    with ExitStack() as stack:
        answer = run(
            NamedBytes(f"{name}.toml", text.encode("utf-8", "replace")) if text else name,
            rig=None if request["rig"] is None else given_rig(request["rig"], places, stack),
            anyway=request["anyway"],
            tag=request["tags"],
            fact=request["facts"],
            out=places.runs,
            operator=live.ask,
            control=control,
            watcher=live,
            progress=live.progress,
            **on,
        )
    assert isinstance(answer, RunAnswer)
    result = answer.result
    return result.state.value, result.outcome, result.reason


if __name__ == "__main__":
    main(Path(sys.argv[1]))
