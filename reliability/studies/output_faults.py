"""Faults of devices and processes in every call of a run: do motor and drive end off, and is it said truly?"""

from collections.abc import Sequence

from reliability.study import Measure, Record, Study
from sonolube.laboratory.driver_trial import DriversToTry, Fault, faults_of, try_fault

FAULTS = faults_of(("drive", "motor", "acquisition"))


def _trial(seed: int) -> Record:
    return record_of(None, FAULTS[seed])


def record_of(drivers: DriversToTry | None, fault: Fault) -> Record:
    """Record of a run of drivers, or of pretended devices alone, with a fault."""
    found = try_fault(drivers, fault)
    return {
        "fault": f"{fault.where}: {fault.kind}",
        "on": found.is_on,
        "told": found.verdict,
        "alike": found.verdict == found.recorded,
        "lies": fault.is_lie,
        "recordable": fault.kind != "disk full",
        "traceback": "Traceback" in found.error,
        "ended": found.code is not None,
    }


def measures_of(records: Sequence[Record]) -> list[Measure]:
    """Runs whose end was told wrongly."""
    on = [record for record in records if record["on"]]
    measured = [record for record in on if str(record["told"]).startswith("measured off")]
    confirmed = [record for record in on if str(record["told"]).startswith("confirmed off")]
    lying = [record for record in confirmed if record["lies"]]
    unlike = [record for record in records if not record["alike"] and record["recordable"]]
    return [
        _none("runs told measured off with an output on", measured),
        _none(
            "runs told confirmed off with an output on, by devices that do not lie about it",
            [record for record in confirmed if not record["lies"]],
        ),
        Measure(label="the same by devices that lie about it, and that no channel shows", value=str(len(lying))),
        _none("runs without a verdict on the terminal", [record for record in records if not record["told"]]),
        _none("runs whose record has another verdict, or none though the disk is not full", unlike),
        _none("tracebacks", [record for record in records if record["traceback"]]),
        _none("runs that do not end in two minutes", [record for record in records if not record["ended"]]),
        Measure(label="runs that end with an output on, and cut the power", value=str(len(on) - len(confirmed))),
    ]


def _none(label: str, found: Sequence[Record]) -> Measure:
    """Measure of what must not happen."""
    first = f", such as {found[0]['fault']}" if found else ""
    return Measure(label=label, value=f"{len(found)}{first}", bar="0", holds=not found)


SOURCES = (
    "laboratory/*.py",
    "laboratory/switch_off/*.py",
    "laboratory/driver_trial/*.py",
    "laboratory/records/recovery.py",
)

STUDY = Study(
    title="Faults of outputs",
    question="A run on a pretended rig, whose hardware is a log, meets a fault: a call that hangs, returns late, keeps"
    " the interpreter, raises, dies, is stopped, gives wrong blocks or lies; a full disk, a clock that is set. Does"
    " every run end with a verdict on motor and drive that the log bears out?",
    sources=SOURCES,
    trials=len(FAULTS),
    sample=1,
    trial=_trial,
    measures=measures_of,
)
