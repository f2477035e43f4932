"""Faults of devices and processes in every call of a run: do motor and drive end off, and is it said truly?"""

import json
import re
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from itertools import product
from pathlib import Path

from reliability.logged_rig import LoggedRig
from reliability.study import Measure, Record, Study

_OUTPUTS = [f"drive.{each}" for each in ("connect", "drive", "off", "close")]
_OUTPUTS += [f"motor.{each}" for each in ("connect", "turn", "off", "close")]
_INPUTS = [f"inputs.{each}" for each in ("connect", "start", "read", "stop", "close")]
_KINDS = (
    "hang", "late 1", "late 3", "late 12", "held 8", "exit 0", "exit 1", "unspeakable",
    *(f"signal SIG{each}" for each in ("KILL", "STOP", "SEGV", "ABRT", "TERM", "INT", "QUIT", "TSTP", "USR1")),
    *(f"raise {each}" for each in (
        "DeviceError", "OSError", "TimeoutError", "RuntimeError", "ValueError", "MemoryError", "SystemExit",
        "KeyboardInterrupt", "GeneratorExit",
    )),
)  # fmt: skip
_BLOCKS = ("doubled", "longer", "stale", "slowly", "whole numbers", "infinity")
FAULTS = (
    *((where, kind, 1) for where, kind in product((*_OUTPUTS, *_INPUTS), _KINDS)),
    *(("inputs.read", f"acts {each}", 3) for each in _BLOCKS),
    ("inputs.start", "acts slowly", 1),
    *((f"{each}.off", "acts lies", 0) for each in ("drive", "motor")),
)
"""Call, fault and the number of the call from 1 that has it."""

_VERDICT = re.compile(r"motor and drive: (.*)")
_LATER = 4.0  # s, in which a call that outlives its run may act


def _trial(seed: int) -> Record:
    where, kind, call = FAULTS[seed]
    with tempfile.TemporaryDirectory() as place:
        rig = LoggedRig(Path(place) / "rig", where=where, kind=kind, call=call)
        ended = rig.run()
        if kind.startswith(("hang", "late", "held", "signal")):
            time.sleep(_LATER)
        is_on = rig.last("drive") != 0 or rig.last("motor") != 0
    told = ""
    with suppress(ValueError, KeyError):
        told = json.loads(ended.output)["outputs"]
    if found := _VERDICT.search(ended.error):
        told = found[1]
    return {
        "fault": f"{where}: {kind}",
        "on": is_on,
        "told": told,
        "alike": told == ended.record,
        "lies": kind == "acts lies",
        "traceback": "Traceback" in ended.error,
    }


def _measures(records: Sequence[Record]) -> list[Measure]:
    on = [record for record in records if record["on"]]
    measured = [record for record in on if str(record["told"]).startswith("measured off")]
    confirmed = [record for record in on if str(record["told"]).startswith("confirmed off")]
    lying = [record for record in confirmed if record["lies"]]
    return [
        _none("runs told measured off with an output on", measured),
        _none(
            "runs told confirmed off with an output on, by devices that do not lie about it",
            [record for record in confirmed if not record["lies"]],
        ),
        Measure(label="the same by devices that lie about it, and that no channel shows", value=str(len(lying))),
        _none("runs without a verdict on the terminal", [record for record in records if not record["told"]]),
        _none("runs whose record has another verdict, or none", [record for record in records if not record["alike"]]),
        _none("tracebacks", [record for record in records if record["traceback"]]),
        Measure(label="runs that end with an output on, and cut the power", value=str(len(on) - len(confirmed))),
    ]


def _none(label: str, found: Sequence[Record]) -> Measure:
    """Measure of what must not happen."""
    first = f", such as {found[0]['fault']}" if found else ""
    return Measure(label=label, value=f"{len(found)}{first}", bar="0", holds=not found)


STUDY = Study(
    title="Faults of outputs",
    question="A run on a pretended rig, whose hardware is a log, meets a fault: a call that hangs, returns late, keeps"
    " the interpreter, raises, dies, is stopped, gives wrong blocks or lies. Does every run end with a verdict on motor"
    " and drive that the log bears out?",
    sources=("laboratory/*.py", "laboratory/switch_off/*.py", "laboratory/records/recovery.py"),
    trials=len(FAULTS),
    sample=1,
    trial=_trial,
    measures=_measures,
)
