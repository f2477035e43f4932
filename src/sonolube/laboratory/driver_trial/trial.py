"""A driver in a run of `sonolube lab run` with a fault, and the verdict of that run beside what the outputs were."""

import json
import os
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from dataclasses import dataclass, field, replace
from importlib import import_module
from inspect import isabstract
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import Any, Final, get_args

from pydantic import ValidationError

from sonolube.errors import InvalidInput, words_of
from sonolube.laboratory.driver_trial.faults import CALLS, Fault, Injector, lines_of
from sonolube.laboratory.drivers import AcquisitionEntry, DriveEntry, DriverEntry, MotorEntry
from sonolube.laboratory.records import last_verdict
from sonolube.laboratory.verdict import Outputs
from sonolube.operating_system import process_start
from sonolube.storage.files import write_atomically

_BASES: Final[Mapping[str, type[Any]]] = MappingProxyType(
    {"acquisition": AcquisitionEntry, "drive": DriveEntry, "motor": MotorEntry}
)
_DEFAULTS: Final[Mapping[str, Any]] = MappingProxyType(  # of entries that a section must have
    {
        "channels": ({"name": "friction_force"},),
        "voltage_maximum": "80 V",
        "frequency_maximum": "100 kHz",
        "rotation_speed_maximum": "300 rpm",
        "groove_diameter": "50 mm",
    }
)
_OF_PRETENDED: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "acquisition": (),
        "drive": ("voltage_maximum", "frequency_maximum"),
        "motor": ("rotation_speed_maximum", "groove_diameter"),
    }
)
_HOOK: Final = "pretended_instruments"
_VOLTAGE, _FREQUENCY, _SPEED = 20.0, 22e3, 1.0  # V, Hz, 1/s: what a run sets, as far as the driver gives it
_LONGEST: Final = 120.0  # s, of a run
_LATER: Final = 15.0  # s, in which a process that outlives its run may act
_LOOK: Final = 0.05  # s

_ENTRY_POINTS = "[sonolube.drivers]\n" + "".join(
    f"{role}.tried = sonolube.laboratory.driver_trial.tried_devices:Tried{role.capitalize()}Entry\n" for role in _BASES
)
_PROTOCOL = """title = "trial of a driver"
source = "none"

[limits]
voltage_maximum = "{limit!r} V"
duration_maximum = "200 s"

[[steps]]
kind = "acquire"
channels = [{channel}]
sample_rate = "400 Hz"
duration = "{duration:g} s"

[[steps]]
kind = "motor_speed"
rotation_speed = "{speed!r} Hz"

[[steps]]
kind = "drive"
voltage_peak_to_peak = "{voltage!r} V"
frequency = "{frequency!r} Hz"

[[steps]]
kind = "wait"
duration = "{duration:g} s"
"""


@dataclass(frozen=True, kw_only=True)
class PretendedInstruments:
    """Instruments that a module pretends to its drivers for one run.

    Parameters
    ----------
    sections : mapping of str to mapping of str to object
        Entries of the sections of a device map by the role of the device, such as an address on this computer.
    is_on : callable or None
        Whether an output of the instruments is on; None where the calls to the devices tell it.
    """

    sections: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    is_on: Callable[[], bool] | None = None


@dataclass(frozen=True, kw_only=True)
class DriversToTry:
    """Drivers of a module.

    Parameters
    ----------
    module : str
        Name by which it is imported.
    classes : mapping of str to type
        Its sections of a device map by the role of the device: acquisition, drive, motor.
    given : mapping of str to mapping of str to object
        Entries of the sections by role.
    pretend : callable or None
        Context manager of the module that yields `PretendedInstruments`.
    is_pretended : bool
        Whether nothing answers the drivers, so that their devices are made and never called.
    """

    module: str
    classes: Mapping[str, type[DriverEntry]]
    given: Mapping[str, Mapping[str, Any]]
    pretend: Callable[[], AbstractContextManager[PretendedInstruments]] | None = None
    is_pretended: bool = False

    @property
    def roles(self) -> tuple[str, ...]:
        """Roles of the devices."""
        return tuple(self.classes)

    @contextmanager
    def instruments(self) -> Iterator[PretendedInstruments]:
        """Instruments for one run, with the entries that were given."""
        with ExitStack() as after:
            found = PretendedInstruments() if self.pretend is None else after.enter_context(self.pretend())
            sections = {role: {**found.sections.get(role, {}), **self.given.get(role, {})} for role in self.roles}
            yield replace(found, sections=sections)

    def entry(self, role: str, entries: Mapping[str, Any]) -> tuple[DriverEntry, dict[str, Any]]:
        """Section of a role, and its content.

        Raises
        ------
        InvalidInput
            With every entry that it refuses or lacks.
        """
        driver = self.classes[role]
        fields = driver.model_fields
        named = {"driver": get_args(fields["driver"].annotation)[0]} if get_args(fields["driver"].annotation) else {}
        known = {key: value for key, value in _DEFAULTS.items() if key in fields and fields[key].is_required()}
        section = {**known, **named, **entries}
        try:
            return driver.model_validate(section), section
        except ValidationError as refusal:
            faults = [f"{role}.{'.'.join(map(str, each['loc']))}: {each['msg']}" for each in refusal.errors()]
        raise InvalidInput(
            f"{self.module}: {driver.__name__}: {'; '.join(faults)}; state entries by --set {role}.KEY=VALUE, or by"
            f" {_HOOK} of the module"
        )


def drivers_to_try(module: str | Path, given: Mapping[str, str] | None = None) -> DriversToTry:
    """Drivers of a module.

    Parameters
    ----------
    module : str or Path
        Name, such as acme_drive, or a file of Python; behind a colon the class, where it has several of a role.
    given : mapping of str to str, optional
        Entries of sections, by role and key, such as {"drive.address": "TCPIP::127.0.0.1::5025::SOCKET"}.

    Returns
    -------
    DriversToTry

    Raises
    ------
    InvalidInput
        If the module cannot be imported, has no driver of an acquisition, a drive or a motor, or several of one.
    """
    place, _, wanted = str(module).partition(":")
    is_file = place.endswith(".py")
    if is_file and not Path(place).is_file():
        raise InvalidInput(f"{place}: no such file")
    name, folder = (Path(place).stem, Path(place).parent) if is_file else (place, Path())
    if str(folder.resolve()) not in sys.path:  # also for the programs of the runs
        sys.path.insert(0 if is_file else len(sys.path), str(folder.resolve()))
    try:
        found = import_module(name)
    except Exception as failure:  # whatever a module raises
        told = f"{type(failure).__name__}: {words_of(failure)}"
        raise InvalidInput(f"{place}: cannot be imported ({told}); name a module, or a file of Python") from None
    classes: dict[str, type[DriverEntry]] = {}
    for role, base in _BASES.items():
        known = [each for each in vars(found).values() if _is_driver(each, base, wanted)]
        of_role = [each for each in known if each.__module__ == name] or known
        if len(of_role) > 1:
            names = ", ".join(each.__name__ for each in of_role)
            raise InvalidInput(f"{place} has several drivers of the {role}: {names}; choose one as {place}:NAME")
        if of_role:
            classes[role] = of_role[0]
    if not classes:
        of = f"no class {wanted} that is a driver" if wanted else "no driver"
        bases = ", ".join(each.__name__ for each in _BASES.values())
        raise InvalidInput(f"{place} has {of}: a class that derives from {bases} and has all that they demand")
    return DriversToTry(
        module=name,
        classes=MappingProxyType(classes),
        given=_sections(given or {}, classes),
        pretend=getattr(found, _HOOK, None),
    )


def _is_driver(found: object, base: type, wanted: str) -> bool:
    """Whether an object of a module is a driver of a role, that of a name where one is wanted."""
    is_driver = isinstance(found, type) and issubclass(found, base) and not isabstract(found)
    return is_driver and wanted in ("", getattr(found, "__name__", ""))


def _sections(given: Mapping[str, str], roles: Mapping[str, object]) -> dict[str, dict[str, Any]]:
    """Entries by role and key from their texts."""
    found: dict[str, dict[str, Any]] = {}
    for name, text in given.items():
        role, _, key = name.partition(".")
        if role not in roles or not key:
            raise InvalidInput(f"{name!r} is no entry of {' or '.join(roles)}; write it as {next(iter(roles))}.KEY")
        found.setdefault(role, {})[key] = _value(text)
    return found


def _value(text: str) -> Any:
    """Value of an entry as TOML has it; a text that is none of its values stands for itself."""
    with suppress(tomllib.TOMLDecodeError):
        return tomllib.loads(f"value = {text}")["value"]
    return text


@dataclass(frozen=True, kw_only=True)
class TriedFault:
    """End of a run with a fault.

    Parameters
    ----------
    fault : Fault
    is_on : bool
        Whether an output was on after every process of the run had ended.
    verdict : str
        As the terminal had it; empty without one.
    recorded : str
        As the record has it.
    code : int or None
        Exit code; None where the run did not end.
    output, error : str
        What it wrote.
    seconds_to_off : float or None
        From the fault until the last output was off, in s; None where none was on, or one still is.
    """

    fault: Fault
    is_on: bool
    verdict: str
    recorded: str
    code: int | None
    output: str
    error: str
    seconds_to_off: float | None = None

    @property
    def is_off(self) -> bool:
        """Whether all outputs are off."""
        return not self.is_on

    @property
    def wrong(self) -> str:
        """What is not right of the end; empty for nothing. A device that lies about itself is not wrong of the run."""
        said_off = self.verdict.startswith((Outputs.MEASURED_OFF.value, Outputs.CONFIRMED_OFF.value))
        is_believed = self.fault.is_lie and self.verdict.startswith(Outputs.CONFIRMED_OFF.value)
        is_full = self.fault.kind == "disk full"  # where no record can be closed
        faults = {
            "has not ended": self.code is None,
            "no verdict": not self.verdict,
            "called off with an output on": self.is_on and said_off and not is_believed,
            "another verdict in its record": self.verdict != self.recorded and (self.recorded or not is_full),
            "a traceback": "Traceback" in self.error,
        }
        return "; ".join(name for name, holds in faults.items() if holds)

    @property
    def reason(self) -> str:
        """Why the run failed, in its own words; empty where it did not."""
        if self.code == 0:
            return ""
        with suppress(ValueError, KeyError, TypeError):
            return str(json.loads(self.output)["reason"])
        return self.error.strip().rpartition("\n")[2]


class Trial:
    """A run of `sonolube lab run` in a folder.

    Parameters
    ----------
    folder : Path
        Which is made.
    drivers : DriversToTry or None
        The other devices of the rig are pretended; None for all.
    fault : Fault
    instruments : PretendedInstruments or None
        Of the drivers, as `DriversToTry.instruments` has them.
    duration : float
        Of the run. [s]
    program : sequence of str
        Arguments of Python that run the program.

    Raises
    ------
    InvalidInput
        If a section of a driver refuses an entry, or lacks one.
    """

    def __init__(
        self,
        folder: Path,
        drivers: DriversToTry | None = None,
        fault: Fault | None = None,
        instruments: PretendedInstruments | None = None,
        *,
        duration: float = 0.4,
        program: Sequence[str] = ("-m", "sonolube"),
    ) -> None:
        self.folder, self.fault = folder, fault or Fault()
        self._drivers, self._program = drivers, tuple(program)
        self._injector = Injector(str(folder / "log.txt"), self.fault)
        self._is_on = None if instruments is None else instruments.is_on
        sections = {} if instruments is None else instruments.sections
        entries = {} if drivers is None else {role: drivers.entry(role, sections[role]) for role in drivers.roles}
        metadata = folder / "sonolube_trial-1.0.dist-info"
        write_atomically(metadata / "METADATA", "Metadata-Version: 2.1\nName: sonolube-trial\nVersion: 1.0\n")
        write_atomically(metadata / "entry_points.txt", _ENTRY_POINTS)
        write_atomically(folder / "devices.toml", self._map(entries))
        write_atomically(folder / "short.toml", _protocol(entries, duration))

    def start(self) -> "subprocess.Popen[str]":
        """Start the program of the run."""
        path, own = os.pathsep.join(filter(None, (str(self.folder), *sys.path))), str(self.folder / "state")
        words = [*self._program, "lab", "run", "short.toml", "--device", "devices.toml", "--out", "runs", "--json"]
        return subprocess.Popen(
            [sys.executable, *words, "--no-self-test"],
            cwd=self.folder,
            env=os.environ | {"PYTHONPATH": path} | dict.fromkeys(("XDG_STATE_HOME", "SONOLUBE_DEVICE_LOCKS"), own),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def ended(self, process: "subprocess.Popen[str]") -> TriedFault:
        """What is left when every process of the run has ended."""
        code: int | None = None
        try:
            output, error = process.communicate(timeout=_LONGEST)
            code = process.returncode
        except subprocess.TimeoutExpired:
            process.kill()
            output, error = process.communicate()
        self._wait_for_the_last()
        folders = list((self.folder / "runs").glob("*/"))
        return TriedFault(
            fault=self.fault,
            is_on=self._is_on() if self._is_on is not None else bool(self.last("drive") or self.last("motor")),
            verdict=_verdict_in(output, error),
            recorded=last_verdict(folders[0]) if folders else "",
            code=code,
            output=output,
            error=error,
            seconds_to_off=self._seconds_to_off(),
        )

    def run(self) -> TriedFault:
        """Run to the end."""
        return self.ended(self.start())

    @property
    def log(self) -> list[list[Any]]:
        """Lines of the log: time in s, process, and role and value of an output, or "call" or "fault" and the call."""
        return lines_of(Path(self._injector.log))

    def last(self, output: str) -> float:
        """Value that an output was set to last."""
        return next((float(words[3]) for words in reversed(self.log) if words[2] == output), 0.0)

    def _seconds_to_off(self) -> float | None:
        log, on = self.log, {"drive": 0.0, "motor": 0.0}
        began = next((line[0] for line in log if line[2] == "fault"), None)
        ended = None
        for seconds, _, name, value in log:
            was_on = any(on.values())
            if name in on:
                on[name] = value
            if began is not None and was_on and not any(on.values()) and seconds >= began:
                ended = seconds
        return None if ended is None or began is None or any(on.values()) else float(ended - began)

    def _wait_for_the_last(self) -> None:
        """Wait for processes that outlive the run, which may act later."""
        latest = time.monotonic() + _LATER
        while time.monotonic() < latest and any(map(process_start, {line[1] for line in self.log})):
            time.sleep(_LOOK)

    def _map(self, entries: Mapping[str, tuple[DriverEntry, dict[str, Any]]]) -> str:
        """Device map of the run."""
        lines = ['title = "rig of a trial"']
        for role in CALLS:
            content: dict[str, Any] = {"role": role, **self._injector.content()}
            keys = {key: _DEFAULTS[key] for key in _OF_PRETENDED[role]}
            if role in entries and self._drivers is not None:
                entry, section = entries[role]
                driver = type(entry)
                content |= {"module": driver.__module__, "class": driver.__name__, "section": section}
                content["pretended"] = self._drivers.is_pretended
                keys = entry.model_dump(mode="json", include=set(_BASES[role].model_fields) - {"driver"})
            keys = {"driver": "tried", "trial": json.dumps(content), **keys}
            lines += [
                "",
                f"[{role}]",
                *(f"{key} = {json.dumps(each)}" for key, each in keys.items() if each is not None),
            ]
        return "\n".join(lines) + "\n"


def _protocol(entries: Mapping[str, tuple[DriverEntry, dict[str, Any]]], duration: float) -> str:
    """Protocol of a run that the drivers can follow."""
    acquisition, drive, motor = (entries.get(role, (None,))[0] for role in CALLS)
    channels = acquisition.channel_entries if isinstance(acquisition, AcquisitionEntry) else ()
    most, highest = _VOLTAGE, _FREQUENCY
    if isinstance(drive, DriveEntry):
        most, highest = min(most, 2 * drive.limits.voltage_maximum), min(highest, drive.highest_frequency)
    speed = min(_SPEED, motor.rotation_speed_maximum) if isinstance(motor, MotorEntry) else _SPEED
    channel = json.dumps(channels[0].name if channels else "friction_force")
    return _PROTOCOL.format(
        limit=most, voltage=most, frequency=highest, speed=speed, duration=duration, channel=channel
    )


def _verdict_in(output: str, error: str) -> str:
    """Verdict that a terminal shows, the last word of the switch-off process before the answer."""
    for line in reversed(error.splitlines()):
        if "motor and drive: " in line:
            return line.partition("motor and drive: ")[2]
    with suppress(ValueError, KeyError, TypeError):
        return str(json.loads(output)["outputs"])
    return ""


def try_fault(drivers: DriversToTry | None, fault: Fault) -> TriedFault:
    """Run a rig with a driver that is tried and a fault, to the end.

    Parameters
    ----------
    drivers : DriversToTry or None
        The other devices are pretended; None for all.
    fault : Fault

    Returns
    -------
    TriedFault

    Raises
    ------
    InvalidInput
        If a section of a driver refuses an entry, or lacks one.
    """
    with ExitStack() as after:
        folder = Path(after.enter_context(TemporaryDirectory(prefix="sonolube-trial-"))) / "rig"
        instruments = None if drivers is None else after.enter_context(drivers.instruments())
        return Trial(folder, drivers, fault, instruments).run()


def without_fault(drivers: DriversToTry) -> tuple[DriversToTry, str]:
    """Drivers as they can be tried: with their devices pretended where the run without a fault does not end well.

    Parameters
    ----------
    drivers : DriversToTry

    Returns
    -------
    DriversToTry, str
        And why they are pretended; empty where they are not.

    Raises
    ------
    InvalidInput
        If a section of a driver refuses an entry, or lacks one, or the run fails with devices that are pretended too.
    """
    found = try_fault(drivers, Fault())
    if found.code == 0 and not found.wrong:
        return drivers, ""
    pretended = replace(drivers, is_pretended=True)
    again = try_fault(pretended, Fault())
    if again.code != 0 or again.wrong:
        raise InvalidInput(f"{drivers.module}: the run without a fault fails: {again.reason or again.wrong}")
    return pretended, found.reason or found.wrong
