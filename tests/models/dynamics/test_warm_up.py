"""Parallel compilation of the kernels at a first call, and none at later ones."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba.core.event import Event, EventStatus, broadcast

from sonolube.models.dynamics.harmonic_balance.floquet_kernel import monodromy_power_norms
from sonolube.models.dynamics.harmonic_balance.harmonic_kernel import newton_solve
from sonolube.models.dynamics.kernels.contact_kernel import KernelLaw
from sonolube.models.dynamics.warm_up import compile_in_parallel

UNDAMPED = KernelLaw((), (), 2e-6, 0.0, np.empty((0, 4)))
CALL = """
from sonolube.models.dynamics import ExponentialGap, Structure, friction_averages, steady_state
from sonolube.models.dynamics.harmonic_balance.floquet_kernel import monodromy_power_norms
from sonolube.models.dynamics.harmonic_balance.harmonic_kernel import newton_solve
from sonolube.models.dynamics.friction_average.elliptic_kernel import elliptic_averages
structure = Structure(
    mass_matrix=[[0.1]], damping_matrix=[[30.0]], stiffness_matrix=[[2e9]], drive_vector=[17.0], contact_vector=[1.0],
    clamped_capacitance=2e-7,
)
states = steady_state(
    structure, ExponentialGap(decay_length=2e-6, force_damping={damping}), normal_load=3.0, frequency=22e3,
    voltage_amplitude=14.0, stability={stability}, relative_tolerance={tolerance}, workers=2,
)
friction_averages(states, sliding_speed=[0.1])
kernels = [kernel.compiled for kernel in (newton_solve, monodromy_power_norms, elliptic_averages)]
print([sum(kernel.stats.cache_misses.values()) for kernel in kernels])
"""


def test_the_caller_compiles_only_the_first_kernel_and_loads_the_others_from_the_cache(tmp_path: Path) -> None:
    def compiled() -> str:
        call = CALL.format(damping=0.0, stability=True, tolerance=1e-6)
        command, environment = [sys.executable, "-c", call], os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.strip()

    assert compiled() == "[1, 0, 0]"
    assert compiled() == "[0, 0, 0]"


def begin_to_compile(kernel: object) -> None:
    event = Event("numba:compile", EventStatus.START, {"dispatcher": kernel})  # type: ignore[no-untyped-call]
    broadcast(event)  # type: ignore[no-untyped-call]


def interrupted() -> None:
    begin_to_compile(newton_solve.compiled)
    raise KeyboardInterrupt


def test_an_interrupted_caller_kills_the_second_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    endless = tmp_path / "python"
    endless.write_text("#!/bin/sh\nexec sleep 3600\n")
    endless.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(endless))
    with pytest.raises(KeyboardInterrupt), compile_in_parallel(UNDAMPED, stability=True, tolerance=1e-6) as process:
        interrupted()
    assert process.wait() not in {None, 0}


def test_no_process_is_started_when_another_kernel_is_compiled() -> None:
    with compile_in_parallel(UNDAMPED, stability=True, tolerance=1e-6) as process:
        begin_to_compile(monodromy_power_norms.compiled)
    assert process.wait() is None


@pytest.mark.parametrize(
    ("where", "name", "value"),
    [
        (sys, "executable", "/nowhere/python"),  # cannot be started
        (sys, "executable", ""),  # an embedded interpreter
        (sys, "frozen", True),  # a frozen program
        (os, "cpu_count", lambda: 1),  # a single CPU
    ],
)
def test_the_caller_works_where_no_second_process_can_be_started(
    monkeypatch: pytest.MonkeyPatch, where: object, name: str, value: object
) -> None:
    monkeypatch.setattr(where, name, value, raising=False)
    with compile_in_parallel(UNDAMPED, stability=True, tolerance=1e-6) as process:
        begin_to_compile(newton_solve.compiled)
    assert process.wait() is None
