"""A device of NI-DAQmx in memory: the driver below the real Python package, with its errors at any call.

Only the layer that calls the driver's C library is replaced. Tasks, channels, timing, streams, enumerations and errors
are those of the package `nidaqmx`, so that a call it does not have, or has otherwise, fails here too.
"""

import inspect
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import nidaqmx.utils
import numpy as np
from nidaqmx._base_interpreter import BaseInterpreter
from nidaqmx.constants import (
    AcquisitionType,
    ChannelType,
    FillMode,
    Level,
    OverwriteMode,
    TaskMode,
    WatchdogAOExpirState,
    WDTTaskAction,
)
from nidaqmx.errors import DaqError
from numpy.typing import NDArray
from pytest import MonkeyPatch

from sonolube.laboratory.drivers import read_device_map

CLOCK = 100e6  # Hz, of which every sample rate is a whole part
SAMPLE_CLOCK_RATE = 0x1344
READ_POSITION = 0x1221
CHANNELS = 0x217B
CHANNEL_NAMES = 0x1273
CHANNEL_TYPE = 0x187F
OVERWRITE = 0x1211
INPUT_BUFFER = 0x186C
DEVICE_NAMES = 0x193B
BOOLEANS_PER_CHANNEL = 0x217F
EXPIRED = 0x21A8
VERSION = {0x1272: 25, 0x1923: 0, 0x2F22: 0}


@dataclass
class Task:
    """A task of the driver."""

    inputs: list[str] = field(default_factory=list)
    ranges: list[tuple[float, float]] = field(default_factory=list)
    terminals: list[int] = field(default_factory=list)
    output: str = ""
    rate: float = 0.0
    buffer: int = 0
    overwrite: int = 0
    written: NDArray[np.float64] | None = None
    is_running: bool = False
    position: int = 0
    line: str = ""
    timeout: float = 0.0  # of a watchdog
    safe_voltages: dict[str, float] = field(default_factory=dict)
    safe_lines: dict[str, int] = field(default_factory=dict)
    is_expired: bool = False


class DaqmxDevice:
    """Device Dev1 with voltages at its inputs, and what its outputs give.

    `errors` has the numbers of errors to raise by the name of the call; `unplugged` fails every call.
    """

    def __init__(self) -> None:
        self.names = "Dev1"
        self.errors: dict[str, int] = {}
        self.unplugged = 0
        self.calls: Counter[str] = Counter()
        self.tasks: dict[int, Task] = {}
        self.voltage: Callable[[str, NDArray[np.int64]], NDArray[np.float64]] = lambda _, n: np.zeros(len(n))
        self.outputs: dict[str, NDArray[np.float64]] = {}
        self.output_rates: dict[str, float] = {}
        self.lines: dict[str, bool] = {}
        self.hangs: Callable[[str], None] = lambda call: None  # called first by every call
        self.last: Task | None = None
        self._handles = 0

    @property
    def open_tasks(self) -> int:
        """Tasks that nobody has cleared."""
        return len(self.tasks)

    def call(self, name: str) -> None:
        """Count a call, and fail where that is wanted."""
        self.calls[name] += 1
        self.hangs(name)
        code = self.errors.get(name, 0)
        if self.unplugged and name not in ("clear_task", "create_task"):
            code = self.unplugged
        if code:
            raise DaqError(f"simulated failure\nin {name}", code)

    # -- calls of the driver, as in nidaqmx._base_interpreter

    def get_system_info_attribute_string(self, attribute: int) -> str:
        assert attribute == DEVICE_NAMES
        return "" if self.unplugged else self.names

    def get_system_info_attribute_uint32(self, attribute: int) -> int:
        return VERSION.get(attribute, 0)

    def create_task(self, session_name: str) -> tuple[int, bool]:
        self.call("create_task")
        self._handles += 1
        self.tasks[self._handles] = self.last = Task()
        return self._handles, True

    def clear_task(self, task: int) -> None:
        self.call("clear_task")
        del self.tasks[task]

    def get_task_attribute_string(self, task: int, attribute: int) -> str:
        here = self.tasks[task]
        return (
            ", ".join([*here.inputs, here.output, here.line]).strip(", ")
            if attribute == CHANNEL_NAMES
            else f"task {task}"
        )

    def get_chan_attribute_int32(self, task: int, channel: str, attribute: int) -> int:
        assert attribute == CHANNEL_TYPE
        if self.tasks[task].line:
            return int(ChannelType.DIGITAL_OUTPUT.value)
        return int((ChannelType.ANALOG_OUTPUT if self.tasks[task].output else ChannelType.ANALOG_INPUT).value)

    def create_ai_voltage_chan(
        self,
        task: int,
        physical_channel: str,
        name_to_assign_to_channel: str,
        terminal_config: int,
        min_val: float,
        max_val: float,
        units: int,
        custom_scale_name: str,
    ) -> None:
        self.call("create_ai_voltage_chan")
        here = self.tasks[task]
        here.inputs.append(physical_channel)
        here.ranges.append((min_val, max_val))
        here.terminals.append(terminal_config)

    def create_ao_voltage_chan(
        self,
        task: int,
        physical_channel: str,
        name_to_assign_to_channel: str,
        min_val: float,
        max_val: float,
        units: int,
        custom_scale_name: str,
    ) -> None:
        self.call("create_ao_voltage_chan")
        assert not any(each.output == physical_channel for each in self.tasks.values()), "the output is reserved"
        self.tasks[task].output = physical_channel
        self.tasks[task].ranges.append((min_val, max_val))

    def cfg_samp_clk_timing(
        self, task: int, rate: float, source: str, active_edge: int, sample_mode: int, samps_per_chan: int
    ) -> None:
        self.call("cfg_samp_clk_timing")
        assert sample_mode == AcquisitionType.CONTINUOUS.value
        self.tasks[task].rate = CLOCK / round(CLOCK / rate)
        self.tasks[task].buffer = samps_per_chan

    def get_timing_attribute_double(self, task: int, attribute: int) -> float:
        assert attribute == SAMPLE_CLOCK_RATE
        return self.tasks[task].rate

    def set_buffer_attribute_uint32(self, task: int, attribute: int, value: int) -> None:
        assert attribute == INPUT_BUFFER
        self.tasks[task].buffer = value

    def set_read_attribute_int32(self, task: int, attribute: int, value: int) -> None:
        assert attribute == OVERWRITE
        self.tasks[task].overwrite = value

    def get_read_attribute_uint64(self, task: int, attribute: int) -> int:
        assert attribute == READ_POSITION
        self.call("read_position")
        return self.tasks[task].position

    def get_read_attribute_uint32(self, task: int, attribute: int) -> int:
        assert attribute == CHANNELS
        return len(self.tasks[task].inputs)

    def start_task(self, task: int) -> None:
        self.call("start_task")
        here = self.tasks[task]
        here.is_running = True
        if here.output and here.written is not None:
            self.outputs[here.output] = here.written
            self.output_rates[here.output] = here.rate

    def stop_task(self, task: int) -> None:
        self.call("stop_task")
        self.tasks[task].is_running = False

    def read_analog_f64(
        self, task: int, num_samps_per_chan: int, timeout: float, fill_mode: int, read_array: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], int]:
        self.call("read_analog_f64")
        here = self.tasks[task]
        assert here.is_running
        assert here.overwrite == OverwriteMode.DO_NOT_OVERWRITE_UNREAD_SAMPLES.value
        assert fill_mode == FillMode.GROUP_BY_CHANNEL.value
        assert num_samps_per_chan <= here.buffer
        assert timeout >= 2 * num_samps_per_chan / here.rate
        numbers = here.position + np.arange(num_samps_per_chan)
        for row, terminal in zip(read_array, here.inputs, strict=True):
            row[:] = self.voltage(terminal, numbers)
        here.position += num_samps_per_chan
        return read_array, num_samps_per_chan

    def write_analog_f64(
        self,
        task: int,
        num_samps_per_chan: int,
        auto_start: bool,
        timeout: float,
        data_layout: int,
        write_array: NDArray[np.float64],
    ) -> int:
        self.call("write_analog_f64")
        here = self.tasks[task]
        lowest, highest = here.ranges[0]
        volts = np.array(write_array, dtype=np.float64).ravel()
        assert lowest - 1e-9 <= volts.min() <= volts.max() <= highest + 1e-9
        if auto_start:
            self.outputs[here.output], self.output_rates[here.output] = volts, 0.0
        else:
            assert here.buffer == len(volts)
            here.written = volts
        return len(volts)

    def task_control(self, task: int, action: int) -> None:
        self.call("task_control")
        assert action == TaskMode.TASK_ABORT.value
        self.tasks[task].is_running = False

    def create_do_chan(self, task: int, lines: str, name_to_assign_to_lines: str, line_grouping: int) -> None:
        self.call("create_do_chan")
        self.tasks[task].line = lines

    def get_write_attribute_uint32(self, task: int, attribute: int) -> int:
        assert attribute == BOOLEANS_PER_CHANNEL
        return 1

    def write_digital_lines(
        self,
        task: int,
        num_samps_per_chan: int,
        auto_start: bool,
        timeout: float,
        data_layout: int,
        write_array: NDArray[np.bool_],
    ) -> int:
        self.call("write_digital_lines")
        assert auto_start
        self.lines[self.tasks[task].line] = bool(np.ravel(write_array)[0])
        return 1

    def create_watchdog_timer_task_ex(self, device_name: str, session_name: str, timeout: float) -> tuple[int, bool]:
        self.call("create_watchdog_timer_task_ex")
        assert device_name == self.names
        self._handles += 1
        self.tasks[self._handles] = Task(timeout=timeout)
        return self._handles, True

    def cfg_watchdog_ao_expir_states(
        self,
        task: int,
        channel_names: str,
        expir_state_array: NDArray[np.float64],
        output_type_array: NDArray[np.int32],
    ) -> None:
        self.call("cfg_watchdog_ao_expir_states")
        assert set(output_type_array) == {WatchdogAOExpirState.VOLTAGE.value}
        names = nidaqmx.utils.unflatten_channel_string(channel_names)
        self.tasks[task].safe_voltages = dict(zip(names, map(float, expir_state_array), strict=True))

    def cfg_watchdog_do_expir_states(self, task: int, channel_names: str, expir_state_array: NDArray[np.int32]) -> None:
        self.call("cfg_watchdog_do_expir_states")
        self.tasks[task].safe_lines = {channel_names: int(expir_state_array[0])}

    def control_watchdog_task(self, task: int, action: int) -> None:
        self.call(f"watchdog {WDTTaskAction(action).name}")
        assert self.tasks[task].is_running
        if action == WDTTaskAction.CLEAR_EXPIRATION.value:
            self.tasks[task].is_expired = False

    def get_watchdog_attribute_bool(self, task: int, lines: str, attribute: int) -> bool:
        assert attribute == EXPIRED
        assert self.tasks[task].is_running
        return self.tasks[task].is_expired

    def let_watchdog_expire(self) -> None:
        """Let the time of the running watchdog pass."""
        for here in list(self.tasks.values()):
            if here.timeout and here.is_running:
                here.is_expired = True
                self.outputs |= {name: np.array([volts]) for name, volts in here.safe_voltages.items()}
                self.lines |= {name: state != Level.LOW.value for name, state in here.safe_lines.items()}

    def is_off(self, terminal: str) -> bool:
        """Whether an output gives a steady 0 V."""
        return terminal in self.outputs and not self.outputs[terminal].any()


def install(device: DaqmxDevice, monkeypatch: MonkeyPatch) -> None:
    """Let the package `nidaqmx` call a device in memory instead of the driver."""
    known = {name: call for name, call in vars(BaseInterpreter).items() if inspect.isfunction(call)}
    taken = {name: call for name, call in vars(DaqmxDevice).items() if name in known and not name.startswith("__")}
    for name, call in taken.items():
        assert list(inspect.signature(call).parameters) == list(inspect.signature(known[name]).parameters), name

    def missing(name: str) -> Callable[..., Any]:
        def refuse(*_: object, **__: object) -> Any:
            raise NotImplementedError(f"the simulated driver has no {name}")

        return refuse

    calls = {name: staticmethod(getattr(device, name) if name in taken else missing(name)) for name in known}
    stand_in = type("StandIn", (), {name: call for name, call in calls.items() if not name.startswith("__")})()
    monkeypatch.setattr(nidaqmx.utils, "_select_interpreter", lambda *_, **__: stand_in)
    for task in ("protocol_run", "friction_hold"):  # the device is in the memory of this process alone
        monkeypatch.setattr(f"sonolube.tasks.lab.{task}.ready_devices", lambda path: read_device_map(path).devices())
