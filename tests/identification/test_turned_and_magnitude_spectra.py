"""Spectra turned by 180 degrees, without phase, and with inductive parts: fitted alike or refused by what they hold."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from pytest import approx, mark, skip
from tests.same import same

from sonolube.checks import Complexes
from sonolube.identification.circuit_fit import CircuitFit, fit_circuit
from sonolube.identification.stack_fit import minimum_phase_admittance
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum, passive_spectrum, read_impedance
from sonolube.models.actuator import ButterworthVanDyke, MotionalBranch, circuit_admittance

RB5100 = Path(__file__).parents[3] / "shared" / "data" / "impedance" / "RB5100.txt"
CIRCUIT = ButterworthVanDyke(
    parallel_capacitance=2e-9, branches=(MotionalBranch(resistance=160.0, inductance=0.17, capacitance=3e-10),)
)


NOISE = np.asarray(0.1 * np.random.default_rng(5).standard_normal(401), dtype=np.complex128)  # ohm


def made(noise: float = 0.0, *, seed: int = 0) -> ImpedanceSpectrum:
    f = np.linspace(16e3, 32e3, 401)
    rng = np.random.default_rng(seed)
    scatter = noise * (rng.standard_normal(f.size) + 1j * rng.standard_normal(f.size))
    return ImpedanceSpectrum(frequency=f, impedance=np.exp(scatter) / circuit_admittance(CIRCUIT, frequency=f))


def measured() -> ImpedanceSpectrum:
    if not RB5100.is_file():
        skip(f"{RB5100.name} is not available")
    return read_impedance(RB5100)


def without_phase(spectrum: ImpedanceSpectrum) -> ImpedanceSpectrum:
    return replace(spectrum, impedance=np.abs(spectrum.impedance).astype(complex), has_phase=False)


def disagreement(one: CircuitFit, other: CircuitFit) -> float:
    """Largest difference of two fits' parameters over the half width of the wider interval, in logarithms."""
    shares = [0.0]
    for name, found in other.intervals.items():
        wider = max((found, one.intervals[name]), key=lambda interval: interval.upper / interval.value)
        shares.append(abs(math.log(one.intervals[name].value / found.value)) / math.log(wider.upper / wider.value))
    return max(shares)


@mark.parametrize("spectrum", [made(0.01), "RB5100"], ids=["made", "RB5100"])
def test_a_spectrum_turned_by_180_degrees_is_fitted_as_the_one_it_was(spectrum: ImpedanceSpectrum | str) -> None:
    true = measured() if isinstance(spectrum, str) else spectrum
    found, upright = fit_circuit(replace(true, impedance=-true.impedance)), fit_circuit(true)
    same(found.intervals, upright.intervals)
    assert "turned by 180 degrees" in found.caveats[0]
    assert not any("turned" in caveat for caveat in upright.caveats)


def test_noise_about_a_conductance_of_zero_turns_no_spectrum() -> None:
    lossless = replace(made(), impedance=np.asarray(1j * made().impedance.imag + NOISE))
    assert passive_spectrum(lossless) == (lossless, ())


@mark.parametrize("spectrum", [made(0.01, seed=1), made(0.003, seed=2), "RB5100"], ids=["1 %", "0.3 %", "RB5100"])
def test_the_magnitude_alone_gives_the_same_circuit_within_the_errors(spectrum: ImpedanceSpectrum | str) -> None:
    true = measured() if isinstance(spectrum, str) else spectrum
    found, complete = fit_circuit(without_phase(true)), fit_circuit(true)
    assert found.residual == "log-magnitude"
    assert len(found.circuit.branches) == len(complete.circuit.branches)
    assert disagreement(found, complete) < 1
    assert "no phase" in found.caveats[0]
    assert "it determines every parameter" in found.caveats[0]


def test_the_intervals_of_a_fit_to_magnitudes_hold_the_truth_as_often_as_they_say() -> None:
    hits = 0
    for seed in range(40):
        interval = fit_circuit(without_phase(made(0.01, seed=seed)), branches=1).intervals[
            "mechanical_quality_factor_1"
        ]
        hits += interval.lower < np.sqrt(0.17 / 3e-10) / 160 < interval.upper
    assert hits >= 34  # of 40 at 95 %: fewer than 34 in one of 100 000 series


def test_the_phase_that_belongs_to_a_magnitude_is_that_of_the_circuit() -> None:
    true = made().admittance
    found = minimum_phase_admittance(np.abs(true), frequency=made().frequency)
    assert np.abs(found) == approx(np.abs(true))
    assert np.sqrt(np.mean(np.angle(found / true) ** 2)) < 0.2  # rad


def test_a_coil_in_series_is_a_part_of_the_circuit() -> None:
    inductive: Complexes = made().impedance + 2j * np.pi * made().frequency * 0.02
    found = fit_circuit(replace(made(), impedance=inductive), branches=1)
    assert found.circuit.series_inductance == approx(0.02)
    assert found.circuit.branches[0].inductance == approx(0.17)
    assert found.caveats == ()
    plain = fit_circuit(replace(made(), impedance=inductive), branches=1, parts=())
    assert any("leads or a coil in series" in caveat for caveat in plain.caveats)
