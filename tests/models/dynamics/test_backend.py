"""Choice of the processor: a GPU where JAX has one, and else the CPU with the reason."""

import sys
from types import SimpleNamespace
from typing import Any

import pytest
from pytest import MonkeyPatch, approx, raises
from tests.models.dynamics.tribometer_chain import TRIBOMETER

from sonolube.errors import GpuUnused, InvalidInput
from sonolube.models.dynamics import ExponentialGap, backend, steady_state

ROUGH = ExponentialGap(decay_length=2e-6)


def jax_with(monkeypatch: MonkeyPatch, *platforms: str) -> None:
    devices = [SimpleNamespace(platform=each, device_kind=f"a {each}") for each in platforms]
    monkeypatch.setitem(sys.modules, "jax", SimpleNamespace(devices=lambda: devices, __spec__="found"))
    monkeypatch.setattr(backend, "_gpu", backend._gpu.__wrapped__)


def test_without_a_gpu_the_cpu_solves_with_a_warning(monkeypatch: MonkeyPatch) -> None:
    jax_with(monkeypatch, "cpu")
    given: Any = {"normal_load": 5.0, "frequency": 20e3, "voltage_amplitude": 5.0}
    with pytest.warns(GpuUnused, match=r"computed on the CPU: JAX finds no GPU; for one of NVIDIA, pip install 'jax\["):
        states = steady_state(TRIBOMETER, ROUGH, backend="gpu", **given)
    assert states.harmonics == approx(steady_state(TRIBOMETER, ROUGH, **given).harmonics, rel=0, abs=0)


def test_a_gpu_of_jax_is_used_under_its_name(monkeypatch: MonkeyPatch) -> None:
    jax_with(monkeypatch, "cpu", "gpu")
    assert backend.usable_backend("gpu") == "gpu"
    assert backend.device_name("gpu") == "a gpu"
    assert backend.device_name("cpu") == ""


def test_a_driver_that_fails_is_the_reason_in_one_line(monkeypatch: MonkeyPatch) -> None:
    def broken() -> None:
        raise RuntimeError("CUDA_ERROR_NO_DEVICE\nmore lines")

    jax_with(monkeypatch)
    monkeypatch.setattr(sys.modules["jax"], "devices", broken)
    assert backend.gpu_obstacle().startswith("JAX cannot be used (CUDA_ERROR_NO_DEVICE); install it with ")


def test_another_backend_is_refused() -> None:
    with raises(InvalidInput, match="backend must be cpu or gpu, got 'tpu'"):
        backend.usable_backend("tpu")  # type: ignore[arg-type]
