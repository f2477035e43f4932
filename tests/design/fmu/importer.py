"""Instances of exported units, imported by FMPy in either version of the interface."""

from collections.abc import Mapping
from contextlib import suppress
from ctypes import byref, c_bool, c_double
from pathlib import Path
from typing import Any, Self

import pytest

from sonolube.design.fmu import MockUpUnit

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
fmi2 = pytest.importorskip("fmpy.fmi2", reason="FMPy is not installed")
fmi3 = pytest.importorskip("fmpy.fmi3", reason="FMPy is not installed")


def written(unit: MockUpUnit, folder: Path) -> Path:
    """File of a unit."""
    path = folder / f"{unit.description.identifier}-{unit.version}.fmu"
    path.write_bytes(unit.content)
    return path


class Instance:
    """One instance of a unit, with the messages that it logged."""

    def __init__(self, unit: MockUpUnit, folder: Path, *, start_time: float = 0.0) -> None:
        path = written(unit, folder)
        self.time, self.messages = start_time, list[str]()
        self._is_2 = unit.version == "2"
        description = fmpy.read_model_description(str(path))
        self._references = {each.name: each.valueReference for each in description.modelVariables}
        arguments: dict[str, Any] = {
            "guid": description.guid if self._is_2 else description.instantiationToken,
            "unzipDirectory": fmpy.extract(str(path), str(folder / f"{path.stem}-{id(self)}")),
            "modelIdentifier": description.coSimulation.modelIdentifier,
            "instanceName": "one",
        }
        if self._is_2:
            self._fmu = fmi2.FMU2Slave(**arguments)
            callbacks = fmi2.fmi2CallbackFunctions()
            callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log_2)
            self._kept = callbacks
            self._fmu.instantiate(callbacks=callbacks, loggingOn=True)
        else:
            self._fmu = fmi3.FMU3Slave(**arguments)
            self._fmu.instantiate(loggingOn=True, logMessage=self._log_3)

    def _log_2(self, environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.messages.append(message.decode())

    def _log_3(self, environment: Any, status: int, category: bytes, message: bytes) -> None:
        self.messages.append(message.decode())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(OSError):
            self._fmu.freeInstance()

    def initialize(self, values: Mapping[str, float]) -> None:
        """Set values and enter the steps."""
        self.set(values)
        if self._is_2:
            self._fmu.setupExperiment(startTime=self.time)
            self._fmu.enterInitializationMode()
        else:
            self._fmu.enterInitializationMode(startTime=self.time)
        self._fmu.exitInitializationMode()

    def set(self, values: Mapping[str, float]) -> None:
        """Set values by name."""
        references = [self._references[name] for name in values]
        (self._fmu.setReal if self._is_2 else self._fmu.setFloat64)(references, list(values.values()))

    def get(self, *names: str) -> list[float]:
        """Values by name."""
        references = [self._references[name] for name in names]
        return list((self._fmu.getReal if self._is_2 else self._fmu.getFloat64)(references))

    def value(self, name: str) -> float:
        """One value."""
        return self.get(name)[0]

    def step(self, duration: float) -> int:
        """Take one step and return its status."""
        if self._is_2:
            status = self._fmu.fmi2DoStep(self._fmu.component, self.time, duration, 1)
        else:
            flags, last = [c_bool() for _ in range(3)], c_double()
            status = self._fmu.fmi3DoStep(
                self._fmu.component, self.time, duration, c_bool(True), *map(byref, flags), byref(last)
            )
            assert last.value == self.time + duration
        self.time += duration
        return int(status)

    def steps(self, count: int, duration: float) -> None:
        """Take some steps."""
        for _ in range(count):
            self.step(duration)

    def reset(self) -> None:
        """Return to the state before initialization."""
        self._fmu.reset()
        self.time = 0.0

    def snapshot(self) -> bytes:
        """State, serialized."""
        if self._is_2:
            state = self._fmu.getFMUstate()
            content = self._fmu.serializeFMUstate(state)
            self._fmu.freeFMUstate(state)
        else:
            state = self._fmu.getFMUState()
            content = self._fmu.serializeFMUState(state)
            self._fmu.freeFMUState(state)
        return bytes(content)

    def restore(self, content: bytes, time: float) -> None:
        """Continue from a serialized state."""
        if self._is_2:
            state = self._fmu.deSerializeFMUstate(content)
            self._fmu.setFMUstate(state)
            self._fmu.freeFMUstate(state)
        else:
            state = self._fmu.deserializeFMUState(content)
            self._fmu.setFMUState(state)
            self._fmu.freeFMUState(state)
        self.time = time
