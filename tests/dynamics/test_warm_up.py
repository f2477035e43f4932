"""A first call compiles its kernels in two processes, later ones in none, and nothing is left running."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from numba.core.event import Event, EventStatus, broadcast

from sonolube.dynamics.harmonic_balance.contact_kernel import Compiled
from sonolube.dynamics.harmonic_balance.floquet_kernel import growth_rates
from sonolube.dynamics.harmonic_balance.harmonic_kernel import balance
from sonolube.dynamics.warm_up import compiling_alongside

UNDAMPED = Compiled(kind=(), damped=())
CALL = """
from sonolube.dynamics import ExponentialGap, Structure, sliding_friction, steady_state
from sonolube.dynamics.harmonic_balance.floquet_kernel import growth_rates
from sonolube.dynamics.harmonic_balance.harmonic_kernel import balance
from sonolube.dynamics.friction_average.kernel import sliding_means
structure = Structure(
    mass_matrix=[[0.1]], damping_matrix=[[30.0]], stiffness_matrix=[[2e9]], drive_vector=[17.0], contact_vector=[1.0],
    clamped_capacitance=2e-7,
)
states = steady_state(
    structure, ExponentialGap(decay_length=2e-6, force_damping={damping}), normal_load=3.0, frequency=22e3,
    voltage_amplitude=14.0, stability={stability}, relative_tolerance={tolerance}, workers=2,
)
sliding_friction(states, sliding_speed=[0.1])
print([sum(kernel.stats.cache_misses.values()) for kernel in (balance, growth_rates, sliding_means)])
"""


@pytest.mark.parametrize(("damping", "stability", "tolerance"), [(0.0, True, 1e-6), (0.5, False, 1e-4)])
def test_the_caller_compiles_the_first_kernel_only_and_finds_the_others(
    tmp_path: Path, damping: float, stability: bool, tolerance: float
) -> None:
    def compiled() -> str:
        call = CALL.format(damping=damping, stability=stability, tolerance=tolerance)
        command, environment = [sys.executable, "-c", call], os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.strip()

    assert compiled() == "[1, 0, 0]"
    assert compiled() == "[0, 0, 0]"


def begin_to_compile(kernel: object) -> None:
    event = Event("numba:compile", EventStatus.START, {"dispatcher": kernel})  # type: ignore[no-untyped-call]
    broadcast(event)  # type: ignore[no-untyped-call]


def interrupted() -> None:
    begin_to_compile(balance)
    raise KeyboardInterrupt


def test_an_interrupted_caller_ends_the_other_process() -> None:
    with pytest.raises(KeyboardInterrupt), compiling_alongside(UNDAMPED, stability=True, tolerance=1e-6) as helper:
        interrupted()
    assert helper.wait() not in {None, 0}


def test_no_process_is_started_for_other_kernels() -> None:
    with compiling_alongside(UNDAMPED, stability=True, tolerance=1e-6) as helper:
        begin_to_compile(growth_rates)
    assert helper.wait() is None


@pytest.mark.parametrize(
    ("where", "name", "value"),
    [
        (sys, "executable", "/nowhere/python"),  # can't be started
        (sys, "executable", ""),  # an interpreter within another program
        (sys, "frozen", True),  # the executable is a program of its own
        (os, "cpu_count", lambda: 1),  # nothing would be gained
    ],
)
def test_the_caller_does_without_where_no_process_can_help(
    monkeypatch: pytest.MonkeyPatch, where: object, name: str, value: object
) -> None:
    monkeypatch.setattr(where, name, value, raising=False)
    with compiling_alongside(UNDAMPED, stability=True, tolerance=1e-6) as helper:
        begin_to_compile(balance)
    assert helper.wait() is None
