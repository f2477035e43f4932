"""Stability by array operations over all kicks: the same exponents as the kernel of loops gives."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import MonkeyPatch, approx
from tests.models.dynamics.tribometer_chain import TRIBOMETER

from sonolube.checks import Floats
from sonolube.execution.compilation import Kernel, few_points
from sonolube.models.dynamics import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap, steady_state
from sonolube.models.dynamics.harmonic_balance import solver
from sonolube.models.dynamics.harmonic_balance.floquet_exponent import floquet_exponents

SEPARATION = np.linspace(0.0, 60e-6, 200)
LAWS: dict[str, GapLaw] = {
    "exponential": ExponentialGap(decay_length=2e-6),
    "Hertz": HertzGap(tip_radius=5e-3, effective_modulus=1e11),
    "linear": LinearGap(normal_stiffness=5e6),
    "table": TabulatedGap(
        separation=SEPARATION,
        normal_force=100 * np.exp(-SEPARATION / 4e-6),
        normal_stiffness=100 / 4e-6 * np.exp(-SEPARATION / 4e-6),
    ),
}


@pytest.mark.parametrize(("name", "damping"), list(zip(LAWS, (0.0, 0.3, 0.0, 0.3), strict=True)))
def test_exponents_are_those_of_the_kernel(name: str, damping: float, monkeypatch: MonkeyPatch) -> None:
    found: list[tuple[Floats, Floats]] = []

    def both(*arguments: object, **_: object) -> Floats:
        with monkeypatch.context() as patch:
            patch.setattr(Kernel, "takes_few", lambda *_, **__: False)
            patch.setattr(Kernel, "compiled", Kernel.interpreted)  # the same statements, in less time than to compile
            by_loops = floquet_exponents(*arguments)  # type: ignore[arg-type]
        with monkeypatch.context() as patch:
            patch.setattr(Kernel, "compiled", None)
            found.append((by_loops, floquet_exponents(*arguments)))  # type: ignore[arg-type]
        return by_loops

    monkeypatch.setattr(solver, "floquet_exponents", both)
    volts, frequency = np.linspace(0.1, 40, 6), np.linspace(5e3, 40e3, 6)
    law = replace(LAWS[name], force_damping=damping)  # type: ignore[type-var]
    with few_points():
        steady_state(TRIBOMETER, law, normal_load=3.0, frequency=frequency, voltage_amplitude=volts)
    assert found
    for by_loops, by_rows in found:
        assert by_rows == approx(by_loops, abs=1e-9, rel=1e-9)
