"""Steady states by JAX, on its GPU or else its CPU, beside the compiled kernels of the CPU in the same process.

Points are those of `test_steady_state_speed.py`, with stability. The time is that of the whole call, with transfers and
the parts that the CPU computes for either. JAX compiles before. Without a GPU there are fewer points.
"""

import os
import time
from pathlib import Path
from typing import Any

import jax
import numpy as np
from pytest_benchmark.fixture import BenchmarkFixture

from sonolube.models.contact import decay_length
from sonolube.models.dynamics import ExponentialGap, SteadyStates, backend, drive_receptance, steady_state
from sonolube.rig import read_rig

RIG = read_rig(Path(__file__).parent.parent / "examples" / "rigs" / "tribometer.toml")
DEVICE = jax.devices()[0]
POINTS = int(os.environ.get("SONOLUBE_GPU_POINTS", "1000000" if DEVICE.platform == "gpu" else "16384"))


def drawn(points: int) -> dict[str, Any]:
    assert RIG.structure is not None
    random = np.random.default_rng(1)
    frequency, load = random.uniform(18e3, 26e3, points), random.uniform(1.0, 10.0, points)
    volts = random.uniform(0.5e-6, 14e-6, points) / np.abs(drive_receptance(RIG.structure, frequency=frequency))
    return {"frequency": frequency, "normal_load": load, "voltage_amplitude": volts}


def test_steady_states_by_jax_beside_the_compiled_kernels(benchmark: BenchmarkFixture, monkeypatch: Any) -> None:
    monkeypatch.setattr(backend, "_gpu", lambda: (DEVICE.device_kind, ""))
    given = drawn(POINTS)

    def solved(processor: Any) -> SteadyStates:
        assert RIG.structure is not None
        law = ExponentialGap(decay_length=float(decay_length(RIG.contact)))
        return steady_state(RIG.structure, law, workers=2, backend=processor, **given)

    before = time.perf_counter()
    solved("gpu")
    first = time.perf_counter() - before
    solved("cpu")
    times = []
    for _ in range(3):
        before = time.perf_counter()
        by_kernels = solved("cpu")
        times.append(time.perf_counter() - before)
    by_jax = benchmark.pedantic(solved, args=("gpu",), rounds=3)  # type: ignore[no-untyped-call]
    assert np.array_equal(by_jax.status, by_kernels.status)
    assert benchmark.stats is not None
    benchmark.extra_info |= {
        "device": DEVICE.device_kind,
        "us_a_point": 1e6 * benchmark.stats.stats.median / POINTS,
        "kernels_us_a_point": 1e6 * float(np.median(times)) / POINTS,
        "first_call_s": first,
    }
