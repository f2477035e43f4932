"""Butterworth-Van Dyke circuits against textbook formulae and circuit laws."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from pytest import approx, raises
from scipy.optimize import brentq

from sonolube.errors import InvalidInput
from sonolube.models.actuator import ButterworthVanDyke, MotionalBranch, circuit_admittance, circuit_resonances

# a quartz-like crystal and a piezo actuator with two modes
CRYSTAL = ButterworthVanDyke(
    parallel_capacitance=5e-12, branches=(MotionalBranch(resistance=50.0, inductance=0.1, capacitance=0.02e-12),)
)


def branch(frequency: float, capacitance: float, quality: float) -> MotionalBranch:
    omega = 2 * np.pi * frequency
    inductance = 1 / (omega**2 * capacitance)
    return MotionalBranch(resistance=omega * inductance / quality, inductance=inductance, capacitance=capacitance)


branches = st.builds(branch, st.floats(1e3, 1e6), st.floats(1e-12, 1e-7), st.floats(1, 1e5))
circuits = st.builds(
    ButterworthVanDyke,
    parallel_capacitance=st.floats(1e-12, 1e-6),
    branches=st.lists(branches, max_size=4).map(tuple),
    series_resistance=st.floats(0, 100),
)


def test_one_branch_has_the_resonances_of_the_textbook() -> None:
    found = circuit_resonances(CRYSTAL)
    f_s = 1 / (2 * np.pi * np.sqrt(0.1 * 0.02e-12))
    assert found.series_frequency == approx(f_s)
    assert found.parallel_frequency == approx(f_s * np.sqrt(1 + 0.02 / 5))
    assert found.mechanical_quality_factor == approx(2 * np.pi * f_s * 0.1 / 50)
    assert found.coupling_factor == approx(np.sqrt(0.02 / 5.02))


def test_far_below_resonance_all_capacitances_add() -> None:
    y = circuit_admittance(CRYSTAL, frequency=1.0)
    assert y.imag / (2 * np.pi) == approx(5.02e-12, rel=1e-9, abs=0)


def test_at_resonance_the_branch_is_its_resistance() -> None:
    f_s = float(circuit_resonances(CRYSTAL).series_frequency[0])
    assert circuit_admittance(CRYSTAL, frequency=f_s) == approx(1 / 50 + 2j * np.pi * f_s * 5e-12, rel=1e-9)


def test_the_width_at_half_power_is_the_frequency_over_the_quality_factor() -> None:
    found = circuit_resonances(CRYSTAL)
    f_s, quality = float(found.series_frequency[0]), float(found.mechanical_quality_factor[0])
    edges = f_s * (1 + np.array([-0.5, 0.5]) / quality)
    assert circuit_admittance(CRYSTAL, frequency=edges).real == approx(np.full(2, 0.5 / 50), rel=1e-4)


def test_the_resistance_of_the_leads_is_in_series() -> None:
    bare = ButterworthVanDyke(parallel_capacitance=1e-9, branches=CRYSTAL.branches)
    leads = ButterworthVanDyke(parallel_capacitance=1e-9, branches=CRYSTAL.branches, series_resistance=7.0)
    f = np.geomspace(1e3, 1e7, 50)
    difference = 1 / circuit_admittance(leads, frequency=f) - 1 / circuit_admittance(bare, frequency=f)
    assert difference.real == approx(np.full(50, 7.0), rel=1e-6)


@given(circuit=circuits, frequency=st.floats(1, 1e7))
def test_the_conductance_of_a_circuit_is_never_negative(circuit: ButterworthVanDyke, frequency: float) -> None:
    assert circuit_admittance(circuit, frequency=frequency).real >= 0


@given(
    frequencies=st.lists(st.floats(1e3, 1e5), min_size=1, max_size=4, unique=True),
    shares=st.lists(st.floats(0.01, 2), min_size=4, max_size=4),
)
def test_each_parallel_resonance_is_a_zero_of_the_capacitance_below_the_next_series_one(
    frequencies: list[float], shares: list[float]
) -> None:
    frequencies = sorted(frequencies)
    assume(all(b > 1.01 * a for a, b in pairwise(frequencies)))
    parts = tuple(branch(f, share * 1e-9, 1e12) for f, share in zip(frequencies, shares, strict=False))
    circuit = ButterworthVanDyke(parallel_capacitance=1e-9, branches=parts[::-1])
    found = circuit_resonances(circuit)
    assert found.series_frequency == approx(np.array(frequencies))

    def capacitance(f: float) -> float:
        motional = sum(part.capacitance / (1 - (f / own) ** 2) for part, own in zip(parts, frequencies, strict=True))
        return 1e-9 + motional

    for low, high, f_p in zip(frequencies, [*frequencies[1:], 1e7], found.parallel_frequency, strict=True):
        root = brentq(capacitance, low * (1 + 1e-9), high * (1 - 1e-9), rtol=1e-13)
        assert f_p == approx(root, rel=1e-9)


def test_a_branch_without_resistance_has_an_infinite_quality_factor() -> None:
    circuit = ButterworthVanDyke(
        parallel_capacitance=1e-9, branches=(MotionalBranch(resistance=0.0, inductance=1e-3, capacitance=1e-9),)
    )
    assert circuit_resonances(circuit).mechanical_quality_factor == approx(np.inf)


def test_a_bare_capacitance_has_no_resonance() -> None:
    found = circuit_resonances(ButterworthVanDyke(parallel_capacitance=1e-9, branches=()))
    assert found.series_frequency.size == found.parallel_frequency.size == found.coupling_factor.size == 0


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"resistance": -1.0}, r"resistance must not be negative, got -1\.0 ohm"),
        ({"inductance": 0.0}, r"inductance must be positive, got 0\.0 H"),
        ({"capacitance": np.inf}, r"capacitance must be finite, got inf F"),
    ],
)
def test_impossible_elements_are_refused(values: dict[str, float], message: str) -> None:
    with raises(InvalidInput, match=message):
        MotionalBranch(**({"resistance": 1.0, "inductance": 1.0, "capacitance": 1.0} | values))


def test_loss_and_leads_are_those_of_a_lossy_capacitor_behind_a_coil() -> None:
    lossy = ButterworthVanDyke(
        parallel_capacitance=2e-9, branches=(), series_resistance=3.0, series_inductance=4e-6, loss_tangent=0.02
    )
    # 2 nF (1 - 0.02 i) at 100 kHz: 795.77 ohm and a phase of -90 degrees and atan 0.02; the coil has 2.5133 ohm
    impedance = 1 / circuit_admittance(lossy, frequency=1e5)
    assert impedance == approx(795.775 / (1 + 0.02**2) * (0.02 - 1j) + 3.0 + 2.51327j, rel=1e-5)


@pytest.mark.parametrize("name", ["series_resistance", "series_inductance", "loss_tangent"])
def test_negative_losses_and_leads_are_refused(name: str) -> None:
    with raises(InvalidInput, match=f"{name} must not be negative"):
        ButterworthVanDyke(parallel_capacitance=1e-9, branches=(), **{name: -1.0})


def test_the_coupling_factor_of_a_branch_is_its_share_of_the_capacitance_whatever_stands_beside_it() -> None:
    # 0.25^2/(1 - 0.25^2) is 1/15
    main, spurious = branch(20e3, 4.5e-9 / 15, 800), branch(20.35e3, 4.5e-9 * 0.03**2 / (1 - 0.03**2), 300)
    alone = circuit_resonances(ButterworthVanDyke(parallel_capacitance=4.5e-9, branches=(main,)))
    both = circuit_resonances(ButterworthVanDyke(parallel_capacitance=4.5e-9, branches=(spurious, main)))
    assert alone.coupling_factor == approx([0.25])
    assert alone.effective_coupling_factor == approx([0.25])
    assert both.coupling_factor == approx([0.25, 0.03])
    assert both.effective_coupling_factor[0] < 0.19
