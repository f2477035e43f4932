"""Trajectories by the kernel for GPUs beside the processor's: in CUDA's simulator, compiled, and on a GPU if any."""

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

from sonolube.dynamics.attractor import describe
from sonolube.dynamics.backend import device_name
from sonolube.dynamics.first_order_modes import state_pairs
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap
from sonolube.dynamics.structure import Structure, drive_receptance
from sonolube.dynamics.time_marching.batch import Schedule
from sonolube.dynamics.time_marching.records import State, Trajectories
from sonolube.dynamics.transient import march
from sonolube.dynamics.waveform import WAVEFORMS, StartUpRamp, sampled_waveform
from sonolube.errors import GpuUnused

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
    return State(coordinates=random.normal(size=shape) * 1e-7, rates=random.normal(size=shape) * 1e-2)


def apart(here: Trajectories, there: Trajectories) -> float:
    """Return the largest difference of any number, over the largest of its kind."""
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
    """Return how far the kernel's answers lie from the processor's."""
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


def running_away() -> list[str]:
    """Return what becomes of steps far too coarse, whose numbers overflow."""
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
    """Return by how much answers depend on how points are shared among blocks and chunks of one trajectory and more."""
    from sonolube.dynamics.gpu import device as threads
    from sonolube.dynamics.gpu import marching

    body = structure()
    chosen: dict[str, Any] = {"periods": 2, "steps_per_period": 8, "backend": "gpu"}
    given = points(body, 7)
    whole = march(body, ROUGH, **given, **chosen)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(marching, "THREADS", 2)
        patched.setattr(threads, "THREADS", 2)
        patched.setattr(threads, "_ROOM", 1)  # two points to a chunk, the last of one
        pieces = march(body, ROUGH, **given, **chosen)
    return apart(whole, pieces)


def attractors(backend: Any) -> list[Any]:
    given = points(HELD, 2) | {"voltage_peak_to_peak": [20.0, 60.0], "voltage_offset": 0.0}
    start = march(HELD, ROUGH, **given, periods=40).final_state
    found = describe(HELD, ROUGH, **given, initial_state=start, periods=32, backend=backend)
    return [found.kind.tolist(), found.order.tolist(), found.exponent.tolist(), found.state.coordinates.tolist()]


def unserved() -> list[str]:
    """Return what is told, once each, of what the kernel leaves to the processor."""
    from sonolube.dynamics.gpu import unmarched

    class OtherGap:
        """A law of a user's own."""

    chain = 2e8 * (2 * np.eye(9) - np.eye(9, k=1) - np.eye(9, k=-1))
    many = Structure(
        mass_matrix=np.eye(9),
        damping_matrix=1e-6 * chain,
        stiffness_matrix=chain,
        drive_vector=np.eye(9)[0],
        contact_vector=np.eye(9)[8],
        clamped_capacitance=1e-7,
    )
    sine = Schedule(waveform=WAVEFORMS["sine"], ramp=COSINE_RAMP, steps=8, periods=1, window=1, recorded=1, strobed=1)
    bent: dict[str, Any] = {"waveform": sampled_waveform(np.sin(np.arange(5))), "steps_per_period": 8, "backend": "gpu"}
    given = points(HELD, 1) | bent
    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always", GpuUnused)
        march(HELD, ROUGH, **given, periods=1)
        describe(HELD, ROUGH, **given, initial_state=moving(HELD, 1), periods=32)
    return [
        unmarched(state_pairs(many), ROUGH, sine),
        unmarched(state_pairs(HELD), OtherGap(), sine),  # type: ignore[arg-type]
        *(str(each.message) for each in raised if issubclass(each.category, GpuUnused)),
    ]


@pytest.fixture(scope="module")
def simulated() -> dict[str, Any]:
    """What the kernel answers in CUDA's simulator, which must be chosen before numba is imported."""
    code = (
        f"import json, sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); import test_marching_on_gpu as t;"
        "print(json.dumps({'apart': t.cases(3), 'away': t.running_away(), 'shared': t.blocks_and_chunks(),"
        "'found': t.attractors('gpu'), 'told': t.unserved()}))"
    )
    return dict(json.loads(answer_of(code, {"NUMBA_ENABLE_CUDASIM": "1"})))


def answer_of(code: str, environment: dict[str, str]) -> str:
    run = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | environment, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_the_simulated_kernel_marches_as_the_processor_does(simulated: dict[str, Any]) -> None:
    # the same steps: what is left are sums in another order
    assert {case for case, difference in simulated["apart"].items() if not difference < 1e-11} == set()


def test_a_trajectory_that_runs_away_is_told_from_one_that_does_not(simulated: dict[str, Any]) -> None:
    assert simulated["away"] == ["diverged", "diverged"]


def test_answers_do_not_depend_on_blocks_and_chunks(simulated: dict[str, Any]) -> None:
    assert simulated["shared"] == 0.0


def test_the_simulated_kernel_settles_to_the_same_attractors(simulated: dict[str, Any]) -> None:
    kind, order, exponent, coordinates = attractors("cpu")
    assert simulated["found"][:2] == [kind, order]
    assert simulated["found"][2] == approx(exponent, abs=1e-6)  # of a disturbance a millionth of the motion
    assert np.array(simulated["found"][3]) == approx(np.array(coordinates), rel=1e-9)


def test_what_the_kernel_does_not_march_is_named_once(simulated: dict[str, Any]) -> None:
    corners = "computed on the CPU: the GPU marches waveforms with corners between steps, not within one of 8"
    modes, law = "the GPU marches structures of up to 8 modes, not 9", "the GPU marches no OtherGap"
    assert simulated["told"] == [modes, law, corners, corners]


@pytest.mark.skipif(bool(device_name("gpu")), reason="there is a GPU")
def test_without_a_gpu_the_processor_marches_and_says_so() -> None:
    given = points(HELD, 2) | {"periods": 3}
    with pytest.warns(GpuUnused, match=r"computed on the CPU: .*sonolube\[gpu\]"):
        there = march(HELD, ROUGH, backend="gpu", **given)
    assert apart(march(HELD, ROUGH, **given), there) == 0.0


COMPILED = """
from types import SimpleNamespace
import numba.cuda.dispatcher
from numba import boolean, cuda, float64, int64
from sonolube.dynamics.gpu.marching_kernel import marching_points
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
def test_three_modes_under_an_exponential_contact_are_marched_in_registers(tmp_path: Path) -> None:
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
def test_a_gpu_marches_as_the_processor_does() -> None:
    assert {case for case, difference in cases(500).items() if not difference < 1e-9} == set()
    assert running_away() == ["diverged", "diverged"]
    assert blocks_and_chunks() == 0.0
