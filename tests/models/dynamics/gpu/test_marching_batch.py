"""Trajectories of the GPU kernel against the CPU: in the CUDA simulator, compiled, and on a GPU if there is one."""

import json
import os
import re
import shutil
import subprocess
import sys
import warnings
from dataclasses import fields
from pathlib import Path
from typing import Any

import numba.cuda
import numpy as np
import pytest
from pytest import approx

from sonolube.errors import GpuUnused
from sonolube.models.dynamics import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap
from sonolube.models.dynamics.attractor import classify_attractor
from sonolube.models.dynamics.backend import device_name
from sonolube.models.dynamics.first_order_modes import first_order_modes
from sonolube.models.dynamics.structure import Structure, drive_receptance
from sonolube.models.dynamics.time_marching.batch import MarchingProblem, MarchingSchedule
from sonolube.models.dynamics.trajectories import State, Trajectories
from sonolube.models.dynamics.transient import march
from sonolube.models.dynamics.waveform import WAVEFORMS, StartUpRamp, sampled_waveform

STACK, ARM = np.array([-1.0, 1.0, 0.0]), np.array([0.0, 1.0, -1.0])
ROUGH = ExponentialGap(decay_length=2e-6)
SEPARATIONS = np.linspace(-2e-5, 4e-5, 121)
GAUSSIAN = TabulatedGap(  # a force whose logarithm bends, as that of Gaussian heights does
    separation=SEPARATIONS,
    normal_force=30 * np.exp(-SEPARATIONS / 2e-6 - (SEPARATIONS / 8e-6) ** 2 / 4 - 2 * np.tanh(SEPARATIONS / 5e-6)),
    normal_stiffness=30
    * np.exp(-SEPARATIONS / 2e-6 - (SEPARATIONS / 8e-6) ** 2 / 4 - 2 * np.tanh(SEPARATIONS / 5e-6))
    * (5e5 + SEPARATIONS / (2 * 8e-6**2) + 2 / 5e-6 / np.cosh(SEPARATIONS / 5e-6) ** 2),
)
LINEAR_RAMP, COSINE_RAMP = StartUpRamp(duration=9.3e-5), StartUpRamp(duration=9.3e-5, shape="cosine")


def structure(arm_damping: float = 20.0) -> Structure:
    return Structure(
        mass_matrix=np.diag([0.15, 0.35, 0.5]),
        damping_matrix=30.0 * np.outer(STACK, STACK) + arm_damping * np.outer(ARM, ARM),
        stiffness_matrix=2e9 * np.outer(STACK, STACK) + 2e5 * np.outer(ARM, ARM),
        drive_vector=17.36 * STACK,
        contact_vector=np.array([1.0, 0.0, 0.0]),
        clamped_capacitance=2.093e-7,
    )


HELD = Structure(
    mass_matrix=np.array([[0.1]]),
    damping_matrix=np.array([[20.0]]),
    stiffness_matrix=np.array([[1e7]]),
    drive_vector=np.array([10.0]),
    contact_vector=np.array([1.0]),
    clamped_capacitance=1e-7,
)


def points(body: Structure, count: int, seed: int = 3) -> dict[str, Any]:
    random = np.random.default_rng(seed)
    frequency, swing = random.uniform(15e3, 30e3, count), random.uniform(0.1e-6, 5e-6, count)
    volts = 2 * np.abs(swing / drive_receptance(body, frequency=frequency))
    return {
        "normal_load": random.uniform(1.0, 30.0, count),
        "frequency": frequency,
        "voltage_peak_to_peak": volts,
        "voltage_offset": volts * random.uniform(-0.2, 0.5, count),
    }


def moving(body: Structure, count: int) -> State:
    random = np.random.default_rng(5)
    shape = (count, body.coordinates)
    return State(coordinates=random.normal(size=shape) * 1e-7, velocities=random.normal(size=shape) * 1e-2)


def apart(here: Trajectories, there: Trajectories) -> float:
    """Return the largest difference of any number over the largest of its kind."""
    assert np.array_equal(here.status, there.status)
    assert np.array_equal(here.advice, there.advice)
    return max(
        float(np.max(np.abs(getattr(one, field.name) - getattr(other, field.name))))
        / float(np.max(np.abs(getattr(one, field.name))))
        for one, other in (
            (here.envelope, there.envelope),
            (here.last_periods, there.last_periods),
            (here.strobed, there.strobed),
            (here.final_state, there.final_state),
        )
        for field in fields(one)
    )


def difference(body: Structure, law: GapLaw, given: dict[str, Any], **choices: Any) -> float:
    chosen: dict[str, Any] = {
        "periods": 7,
        "steps_per_period": 12,
        "periods_per_window": 3,
        "strobed_periods": 2,
    } | choices
    here = march(body, law, **given, **chosen)
    return apart(here, march(body, law, **given, **chosen, backend="gpu"))


def cases(count: int) -> dict[str, float]:
    """Return the differences of the kernel's results from the CPU's, by case."""
    body = structure()
    given, moves = points(body, count), {"initial_state": moving(body, count)}
    hertz = HertzGap(tip_radius=2e-3, effective_modulus=1e9)
    damped = ExponentialGap(decay_length=2e-6, force_damping=0.5)
    same = given | {"frequency": 22e3}
    return {
        "ramped sine": difference(body, ROUGH, given, ramp=COSINE_RAMP, recorded_periods=3),
        "one frequency": difference(body, ROUGH, same, ramp=LINEAR_RAMP, **moves),
        "damped, under a square wave": difference(body, damped, given, waveform=WAVEFORMS["square"], **moves),
        "sphere, under a sawtooth": difference(body, hertz, given, waveform=WAVEFORMS["sawtooth"], ramp=LINEAR_RAMP),
        "spring, under a triangle": difference(
            body, LinearGap(normal_stiffness=1e6, force_damping=0.1), given, waveform=WAVEFORMS["triangle"]
        ),
        "table, under samples": difference(
            body, GAUSSIAN, given, waveform=sampled_waveform([0.0, 1.0, 0.3, -1.0]), ramp=COSINE_RAMP
        ),
        "overdamped": difference(structure(arm_damping=2e4), ROUGH, given, **moves),
        "one mode": difference(HELD, ROUGH, points(HELD, count), ramp=LINEAR_RAMP),
    }


def diverging() -> list[str]:
    """Return the statuses of steps far too coarse, whose numbers overflow."""
    stiff = LinearGap(normal_stiffness=1e15)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        given: dict[str, Any] = {
            "normal_load": [3.0, 4.0],
            "frequency": 22e3,
            "voltage_peak_to_peak": 20.0,
            "periods": 60,
        }
        return [str(status) for status in march(structure(), stiff, backend="gpu", **given).status]


def blocks_and_chunks() -> float:
    """Return the difference of results with blocks and chunks of two points, the last of them of one."""
    from sonolube.models.dynamics.gpu import device, marching_batch

    body = structure()
    chosen: dict[str, Any] = {"periods": 2, "steps_per_period": 8, "backend": "gpu"}
    given = points(body, 7)
    whole = march(body, ROUGH, **given, **chosen)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(marching_batch, "THREADS", 2)
        patched.setattr(device, "THREADS", 2)
        patched.setattr(device, "_CAPACITY", 1)  # two points to a chunk, the last of one
        pieces = march(body, ROUGH, **given, **chosen)
    return apart(whole, pieces)


def attractors(backend: Any) -> list[Any]:
    given = points(HELD, 2) | {"voltage_peak_to_peak": [20.0, 60.0], "voltage_offset": 0.0}
    start = march(HELD, ROUGH, **given, periods=40).final_state
    found = classify_attractor(HELD, ROUGH, **given, initial_state=start, periods=32, backend=backend)
    return [
        found.kind.tolist(),
        found.order.tolist(),
        found.lyapunov_exponent.tolist(),
        found.final_state.coordinates.tolist(),
    ]


def problem(body: Structure, law: GapLaw) -> MarchingProblem:
    one = np.ones(1)
    schedule = MarchingSchedule(
        waveform=WAVEFORMS["sine"], ramp=COSINE_RAMP, steps=8, periods=1, window=1, recorded=1, strobed=1
    )
    return MarchingProblem(
        modes=first_order_modes(body),
        contact_output=np.zeros((2, body.coordinates, 2)),
        gap_law=law,
        schedule=schedule,
        normal_load=one,
        frequency=one,
        voltage_peak_to_peak=one,
        voltage_offset=one,
        start=np.zeros((2 * body.coordinates, 1)),
    )


def unsupported() -> list[str]:
    """Return the reasons, and the warnings, for what the kernel leaves to the CPU."""
    from sonolube.models.dynamics.gpu import unsupported_march

    class OtherGap:
        """Contact law that no kernel evaluates."""

    chain = 2e8 * (2 * np.eye(9) - np.eye(9, k=1) - np.eye(9, k=-1))
    many = Structure(
        mass_matrix=np.eye(9),
        damping_matrix=1e-6 * chain,
        stiffness_matrix=chain,
        drive_vector=np.eye(9)[0],
        contact_vector=np.eye(9)[8],
        clamped_capacitance=1e-7,
    )
    bent: dict[str, Any] = {"waveform": sampled_waveform(np.sin(np.arange(5))), "steps_per_period": 8, "backend": "gpu"}
    given = points(HELD, 1) | bent
    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always", GpuUnused)
        march(HELD, ROUGH, **given, periods=1)
        classify_attractor(HELD, ROUGH, **given, initial_state=moving(HELD, 1), periods=32)
    return [
        unsupported_march(problem(many, ROUGH)),
        unsupported_march(problem(HELD, OtherGap())),  # type: ignore[arg-type]
        *(str(each.message) for each in raised if issubclass(each.category, GpuUnused)),
    ]


@pytest.fixture(scope="module")
def simulated() -> dict[str, Any]:
    """Results of the kernel in the CUDA simulator, which must be selected before numba is imported."""
    code = (
        f"import json, sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); import test_marching_batch as t;"
        "print(json.dumps({'apart': t.cases(3), 'diverging': t.diverging(), 'shared': t.blocks_and_chunks(),"
        "'found': t.attractors('gpu'), 'unsupported': t.unsupported()}))"
    )
    return dict(json.loads(answer_of(code, {"NUMBA_ENABLE_CUDASIM": "1"})))


def answer_of(code: str, environment: dict[str, str]) -> str:
    run = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | environment, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_trajectories_of_the_simulated_kernel_agree_with_the_cpu(simulated: dict[str, Any]) -> None:
    # the steps are the same: the remaining differences are those of sums in another order
    assert {case for case, difference in simulated["apart"].items() if not difference < 1e-11} == set()


def test_diverging_trajectories_are_reported_by_the_simulated_kernel(simulated: dict[str, Any]) -> None:
    assert simulated["diverging"] == ["diverged", "diverged"]


def test_results_do_not_depend_on_blocks_and_chunks(simulated: dict[str, Any]) -> None:
    assert simulated["shared"] == 0.0


def test_the_simulated_kernel_reaches_the_same_attractors(simulated: dict[str, Any]) -> None:
    kind, order, exponent, coordinates = attractors("cpu")
    assert simulated["found"][:2] == [kind, order]
    assert simulated["found"][2] == approx(exponent, abs=1e-6)  # of a disturbance a millionth of the motion
    assert np.array(simulated["found"][3]) == approx(np.array(coordinates), rel=1e-9)


def test_what_the_kernel_does_not_support_is_reported_once(simulated: dict[str, Any]) -> None:
    corners = "computed on the CPU: the GPU marches waveforms with corners between steps, not within one of 8"
    modes, law = "the GPU marches structures with up to 8 modes, not 9", "the GPU marches no OtherGap"
    assert simulated["unsupported"] == [modes, law, corners, corners]


@pytest.mark.skipif(bool(device_name("gpu")), reason="there is a GPU")
def test_without_a_gpu_the_cpu_marches_with_a_warning() -> None:
    given = points(HELD, 2) | {"periods": 3}
    with pytest.warns(GpuUnused, match=r"computed on the CPU: .*sonolube\[gpu\]"):
        there = march(HELD, ROUGH, backend="gpu", **given)
    assert apart(march(HELD, ROUGH, **given), there) == 0.0


COMPILED = """
from types import SimpleNamespace
import numba.cuda.dispatcher
from numba import boolean, cuda, float64, int64
from sonolube.models.dynamics.gpu.marching_kernel import marching_points
# functions of the device are compiled for the one at hand: here for none
numba.cuda.dispatcher.get_current_device = lambda: SimpleNamespace(compute_capability=(9, 0))
row, table, block = float64[::1], float64[:, ::1], float64[:, :, ::1]
given = (table, row, table, table, table, table, table, float64, boolean, int64, int64, table, table)
kernel = marching_points(3, 0, False)
code, _ = cuda.compile(
    kernel, (*given, block, block, block, table, table), cc=(9, 0), output="ptx", device=False, abi="numba"
)
print(code.decode() if isinstance(code, bytes) else code)
"""


@pytest.mark.skipif(numba.cuda.implementation != "NVIDIA", reason="there is no numba-cuda here")
@pytest.mark.skipif(shutil.which("ptxas") is None, reason="there is no ptxas, NVIDIA's assembler, here")
def test_three_modes_on_an_exponential_contact_are_marched_in_registers(tmp_path: Path) -> None:
    loads = [sys.executable, "-c", "from numba.cuda.cudadrv.nvvm import NVVM; NVVM()"]
    if subprocess.run(loads, capture_output=True, check=False).returncode:
        pytest.skip("there is no NVVM, the compiler that numba-cuda calls, here")
    kernel = tmp_path / "kernel.ptx"
    kernel.write_text(answer_of(COMPILED, {}))
    assembled = subprocess.run(
        ["ptxas", "-v", "-arch=sm_90", str(kernel), "-o", str(tmp_path / "kernel.cubin")],
        capture_output=True,
        text=True,
        check=True,
    ).stderr
    spilled = re.search(r"march_points.*?(\d+) bytes spill stores, (\d+) bytes spill loads", assembled, re.DOTALL)
    assert spilled is not None, assembled
    assert spilled.groups() == ("0", "0")


@pytest.mark.gpu
@pytest.mark.skipif(not device_name("gpu"), reason="there is no NVIDIA GPU with numba-cuda here")
def test_trajectories_of_a_gpu_agree_with_the_cpu() -> None:
    assert {case for case, difference in cases(500).items() if not difference < 1e-9} == set()
    assert diverging() == ["diverged", "diverged"]
    assert blocks_and_chunks() == 0.0
