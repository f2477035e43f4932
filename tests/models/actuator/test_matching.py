"""Matching networks against circuit calculations by hand."""

import math

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.actuator import (
    ButterworthVanDyke,
    MatchingNetwork,
    MotionalBranch,
    circuit_admittance,
    input_admittance,
    l_match,
    matched_band,
    matched_power_factor,
    parallel_inductor,
    series_inductor,
    voltage_gain,
)

F = 22e3
CIRCUIT = ButterworthVanDyke(
    parallel_capacitance=360e-9, branches=(MotionalBranch(resistance=40.0, inductance=10e-3, capacitance=5.4e-9),)
)
conductances = st.floats(1e-5, 1.0)
susceptances = st.floats(1e-5, 1.0)


@given(g=conductances, b=susceptances)
def test_one_inductor_gives_a_unity_power_factor(g: float, b: float) -> None:
    y, omega = complex(g, b), 2 * math.pi * F
    across = parallel_inductor(admittance=y, frequency=F)
    assert across.shunt_inductance is not None
    assert y + 1 / (1j * omega * across.shunt_inductance) == approx(g, abs=1e-12)
    line = series_inductor(admittance=y, frequency=F)
    assert line.series_inductance is not None
    z = 1 / y + 1j * omega * line.series_inductance
    assert abs(z.imag) <= 1e-9 * abs(1 / y)
    for network in (across, line):
        assert matched_power_factor(network, admittance=y, frequency=F) == approx(1)


@given(g=conductances, b=st.floats(-1.0, 1.0), r=st.floats(0.1, 1e4))
def test_an_l_section_matches_any_actuator_to_any_resistance(g: float, b: float, r: float) -> None:
    y, s = complex(g, b), 2j * math.pi * F
    network = l_match(admittance=y, frequency=F, source_resistance=r)
    series, shunt = 0j, 0j
    if network.series_inductance is not None:
        series = s * network.series_inductance
    if network.series_capacitance is not None:
        series = 1 / (s * network.series_capacitance)
    if network.shunt_inductance is not None:
        shunt = 1 / (s * network.shunt_inductance)
    if network.shunt_capacitance is not None:
        shunt = s * network.shunt_capacitance
    total = 1 / (shunt + 1 / (series + 1 / y)) if network.shunt_at_source else series + 1 / (y + shunt)
    assert total == approx(r, rel=1e-6)
    assert 1 / complex(input_admittance(network, admittance=y, frequency=F)) == approx(total, rel=1e-6)


def test_a_lossless_network_transmits_the_power_at_the_voltage_of_its_gain() -> None:
    y = 0.02 + 0.05j
    for network in (
        series_inductor(admittance=y, frequency=F),
        l_match(admittance=y, frequency=F, source_resistance=8.0),
        l_match(admittance=y, frequency=F, source_resistance=300.0),
    ):
        gain = complex(voltage_gain(network, admittance=y, frequency=F))
        total = complex(input_admittance(network, admittance=y, frequency=F))
        assert abs(gain) ** 2 * y.real == approx(total.real)


def test_an_actuator_that_is_the_resistance_of_the_amplifier_needs_no_element() -> None:
    assert l_match(admittance=1 / 64, frequency=F, source_resistance=64.0) == MatchingNetwork()


@mark.parametrize("g", [1e-3, 3e-3, 7e-3, 0.013, 0.1, 0.7])
def test_an_actuator_of_the_parallel_resistance_of_the_amplifier_needs_one_element(g: float) -> None:
    for r in (1 / g, math.nextafter(1 / g, 1e9), math.nextafter(1 / g, 0.0)):
        network = l_match(admittance=complex(g, 2e-3), frequency=F, source_resistance=r)
        assert complex(input_admittance(network, admittance=complex(g, 2e-3), frequency=F)) == approx(g, rel=1e-6)


def test_the_bandwidth_of_a_parallel_resonant_circuit_follows_from_its_quality_factor() -> None:
    # across R, C and the L that compensates C: cos phi = 1/sqrt(1 + Q^2 (x - 1/x)^2), x = f/f0
    r, c = 200.0, 360e-9
    quality = 2 * math.pi * F * c * r
    network = parallel_inductor(admittance=1 / r + 2j * math.pi * F * c, frequency=F)
    low, high = matched_band(network, lambda f: 1 / r + 2j * np.pi * f * c, frequency=F, least_power_factor=0.8)
    assert low * high == approx(F**2, rel=1e-6)
    assert (high - low) / F == approx(0.75 / quality, rel=1e-6)


def test_a_capacitance_error_of_a_fifth_lowers_the_power_factor_as_computed_directly() -> None:
    y = complex(circuit_admittance(CIRCUIT, frequency=F))
    network = parallel_inductor(admittance=y, frequency=F)
    off = y + 0.2j * 2 * math.pi * F * 360e-9
    expected = y.real / abs(complex(y.real, 0.2 * 2 * math.pi * F * 360e-9))
    assert matched_power_factor(network, admittance=off, frequency=F) == approx(expected)


def test_an_inductive_actuator_and_ambiguous_elements_are_refused() -> None:
    with raises(InvalidInput, match="must be capacitive"):
        parallel_inductor(admittance=0.1 - 0.01j, frequency=F)
    with raises(OutsideRange, match=r"not above 0\.9"):
        matched_band(MatchingNetwork(), lambda f: 1j * f, frequency=F)
    with raises(InvalidInput, match="are alternatives: give one of them"):
        MatchingNetwork(series_inductance=1e-3, series_capacitance=1e-9)
