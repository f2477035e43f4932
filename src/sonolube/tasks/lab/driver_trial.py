"""Task `lab try-driver`: faults in every call to a driver's devices, and whether each run has the right verdict."""

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from typing import Annotated, Any, Unpack

from sonolube.errors import InvalidInput
from sonolube.execution.threads import thread_pool
from sonolube.laboratory.driver_trial import (
    DriversToTry,
    Fault,
    TriedFault,
    drivers_to_try,
    faults_of,
    try_fault,
    without_fault,
)
from sonolube.laboratory.dry_run.report import SAFETY
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, Table, answer
from sonolube.tasks.parameters import DeviceParameter, KeyValues, Parameter, Watched
from sonolube.tasks.progress import stage
from sonolube.tasks.task import task
from sonolube.text.units import format_si
from sonolube.vocabulary import si


@answer
class TriedDrivers(Answer):
    """Runs with a fault each, and what was wrong of their ends.

    Parameters
    ----------
    drivers : DriversToTry
    unanswered : str
        Why the devices of the drivers are pretended; empty where they are not.
    runs : sequence of TriedFault
    """

    drivers: DriversToTry
    unanswered: str
    runs: Sequence[TriedFault]

    def blocks(self) -> Sequence[Block]:
        """Counts, then a row a fault, then what is wrong."""
        names = ", ".join(f"{role} {each.__name__}" for role, each in self.drivers.classes.items())
        counts = self._counts
        rows = [
            ("runs with a fault", str(len(self.runs))),
            ("motor and drive off at the end", str(counts["off"])),
            ("on at the end, and the verdict says so", str(counts["on"])),
            ("on at the end of a device that lies", f"{counts['lie']} (no channel measures it here)"),
            ("wrong verdict or none", str(counts["wrong"])),
        ]
        slowest = max((each.seconds_to_off for each in self.runs if each.seconds_to_off is not None), default=None)
        if slowest is not None:
            rows.append(("longest time from a fault to off", format_si(slowest, "s", digits=2)))
        table = Table(("call", "fault", "outputs", "verdict", "off after"), [_cells(each) for each in self.runs])
        wrong = [f"wrong: {_named(each.fault)}: {each.wrong}" for each in self.runs if each.wrong]
        return [f"{self.drivers.module}: {names}", Rows(rows), table, *wrong]

    @property
    def _counts(self) -> Counter[str]:
        """Number of runs by how they ended."""
        return Counter(
            "wrong" if each.wrong else "off" if each.is_off else "lie" if each.fault.is_lie else "on"
            for each in self.runs
        )

    def object(self) -> dict[str, Any]:
        """Same as an object."""
        return {
            "module": self.drivers.module,
            "drivers": {role: each.__name__ for role, each in self.drivers.classes.items()},
            "is_pretended": self.drivers.is_pretended,
            "runs": [
                {
                    "call": each.fault.where,
                    "fault": each.fault.kind,
                    "is_on": each.is_on,
                    "outputs": each.verdict,
                    "recorded": each.recorded,
                    "wrong": each.wrong,
                    **si({"seconds_to_off": each.seconds_to_off}, unit="s"),
                }
                for each in self.runs
            ],
        }

    def caveats(self) -> Sequence[str]:
        """What these runs do not show."""
        pretended = (
            f"no instrument answers ({self.unanswered}): the calls to the devices are pretended, so that these runs"
            " show the sections of the driver and the program around it, and nothing of what its calls do"
        )
        on = "an output counts as on from the call that sets it until a call that switches off has returned"
        own = () if self.drivers.pretend is not None and not self.drivers.is_pretended else (on,)
        return (*((pretended,) if self.unanswered else ()), *own, SAFETY)

    def dataset(self) -> Dataset:
        """A row a fault."""
        import xarray as xr

        faults = [_named(each.fault) for each in self.runs]
        off = [float("nan") if each.seconds_to_off is None else each.seconds_to_off for each in self.runs]
        return xr.Dataset(
            {
                "is_on": ("fault", [each.is_on for each in self.runs], {"long_name": "output on at the end"}),
                "verdict": ("fault", [each.verdict for each in self.runs], {"long_name": "verdict"}),
                "seconds_to_off": ("fault", off, {"units": "s", "long_name": "time from the fault to off"}),
            },
            coords={"fault": ("fault", faults, {"long_name": "call and its fault"})},
            attrs=self.notes(),
        )

    @property
    def is_failure(self) -> bool:
        """Whether a run ended with a wrong verdict, or none."""
        return any(each.wrong for each in self.runs)


def _named(fault: Fault) -> str:
    return f"{fault.where}: {fault.kind.removeprefix('acts ')}"


def _cells(run: TriedFault) -> tuple[str, ...]:
    """Cells of a fault: of the verdict its first words, before what it rests on."""
    after = "" if run.seconds_to_off is None else format_si(run.seconds_to_off, "s", digits=2)
    told = run.verdict.partition(",")[0].partition(":")[0] or "none"
    call, _, kind = _named(run.fault).partition(": ")
    return call, kind, "on" if run.is_on else "off", told, after


@task
def try_driver(
    module: Annotated[
        str, DeviceParameter("Module or file of Python with drivers; NAME:CLASS for one of it.", "MODULE")
    ],
    *,
    quick: Annotated[bool, Parameter("Ten faults of each device, in place of all.")] = False,
    given: Annotated[
        Mapping[str, str] | None,
        KeyValues("An entry of a section, such as drive.voltage_maximum=60V.", "ROLE.KEY=VALUE", option="--set"),
    ] = None,
    **watch: Unpack[Watched],
) -> TriedDrivers:
    """Try a driver against faults of its calls: hang, late, raise, die, lie. Is every run off, and its verdict right?

    Each fault has a run of its own, at 20 V and 22 kHz where the driver gives them; the other devices of the rig are
    pretended. Connect no instrument. Ends with exit code 1 where a verdict is wrong.

    Example: sonolube lab try-driver examples/lab/bench_source.py --quick
    """
    found = drivers_to_try(module, given)
    with stage("trying without a fault"):
        drivers, unanswered = without_fault(found)
    faults = faults_of(drivers.roles, quick=quick)
    if not faults:
        raise InvalidInput(f"{module}: no call of {', '.join(drivers.roles)} has a fault")
    return TriedDrivers(drivers=drivers, unanswered=unanswered, runs=list(_tried(drivers, faults)))


def _tried(drivers: DriversToTry, faults: Sequence[Fault]) -> Iterator[TriedFault]:
    """Runs with each fault, some at a time."""
    with stage("trying faults") as advance, thread_pool(os.cpu_count() or 1) as pool:
        runs = [pool.submit(try_fault, drivers, fault) for fault in faults]
        for done, run in enumerate(as_completed(runs), 1):
            advance(_named(run.result().fault), done, len(faults))
    yield from (run.result() for run in runs)
