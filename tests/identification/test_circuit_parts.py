"""Dielectric loss and leads beside branches: found where spectra of closed form have them, and nowhere else."""

import numpy as np
from pytest import approx, mark, raises

from sonolube.checks import Complexes, Floats
from sonolube.errors import UnknownName
from sonolube.identification.circuit_fit import CIRCUIT_PARTS, CircuitFit, fit_circuit
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum


def capacitance_of(c_0: float, k: float) -> float:
    """Of the branch whose share of all capacitance is k^2. [F]"""
    return c_0 * k**2 / (1 - k**2)


def impedance(
    f: Floats,
    *,
    c_0: float,
    modes: tuple[tuple[float, float, float], ...],
    tan_d: float = 0.0,
    inductance: float = 0.0,
    resistance: float = 0.0,
) -> Complexes:
    """Impedance of modes (series frequency, quality factor, k) beside a lossy capacitor behind leads. [ohm]"""
    compliance = c_0 * (1 - 1j * tan_d) + 0j * f
    for f_s, quality, k in modes:
        compliance = compliance + capacitance_of(c_0, k) / (1 - (f / f_s) ** 2 + 1j * f / (f_s * quality))
    return np.asarray(1 / (2j * np.pi * f * compliance) + resistance + 2j * np.pi * f * inductance)


def noisy(f: Floats, z: Complexes, *, noise: float, seed: int) -> ImpedanceSpectrum:
    one, other = np.random.default_rng(seed).normal(scale=noise, size=(2, f.size))
    return ImpedanceSpectrum(frequency=f, impedance=z * (1 + one + 1j * other))


LOW, HIGH = np.linspace(29e3, 34e3, 161), np.linspace(230e3, 390e3, 201)
IDEAL = {"c_0": 3.1e-9, "modes": ((31e3, 900.0, 0.22),)}
CABLE = {"c_0": 1.4e-9, "modes": ((300e3, 60.0, 0.4),)}


def lossy(seed: int) -> ImpedanceSpectrum:
    return noisy(LOW, impedance(LOW, **IDEAL, tan_d=0.012), noise=0.004, seed=seed)  # type: ignore[arg-type]


def behind_cable(seed: int) -> ImpedanceSpectrum:
    z = impedance(HIGH, **CABLE, inductance=3.5e-6, resistance=1.6)  # type: ignore[arg-type]
    return noisy(HIGH, z, noise=0.004, seed=seed)


def holds(found: CircuitFit, **values: float) -> bool:
    """Whether the interval of each quantity has its value."""
    return all(found.intervals[name].lower <= value <= found.intervals[name].upper for name, value in values.items())


def parts_of(found: CircuitFit) -> set[str]:
    return {part for part in CIRCUIT_PARTS if getattr(found.circuit, part) > 0}


def test_a_dielectric_loss_is_found_with_its_interval_and_leaves_the_quality_factor_right() -> None:
    found = fit_circuit(lossy(7))
    assert parts_of(found) == {"loss_tangent"}
    assert len(found.circuit.branches) == 1
    assert found.caveats == ()
    assert found.circuit.loss_tangent == approx(0.012, rel=0.1)
    assert found.resonances.mechanical_quality_factor == approx([900.0], rel=0.03)
    assert found.resonances.coupling_factor == approx([0.22], rel=2e-3)
    without = fit_circuit(lossy(7), branches=1, parts=())
    assert without.resonances.mechanical_quality_factor[0] < 850


def test_resistance_and_inductance_of_the_leads_are_found_and_leave_the_transducer_right() -> None:
    found = fit_circuit(behind_cable(2))
    assert parts_of(found) == {"series_inductance", "series_resistance"}
    assert len(found.circuit.branches) == 1
    assert found.caveats == ()
    assert found.circuit.series_inductance == approx(3.5e-6, rel=0.1)
    assert found.circuit.series_resistance == approx(1.6, rel=0.15)
    assert found.resonances.series_frequency == approx([300e3], rel=1e-3)
    assert found.resonances.coupling_factor == approx([0.4], rel=5e-3)
    assert found.circuit.parallel_capacitance == approx(1.4e-9, rel=0.01)


def test_a_known_resistance_of_the_leads_is_not_fitted() -> None:
    found = fit_circuit(behind_cable(2), branches=1, series_resistance=1.6)
    assert found.circuit.series_resistance == approx(1.6, rel=1e-12)
    assert "series_resistance" not in found.intervals
    assert holds(found, series_inductance=3.5e-6)


@mark.parametrize("seed", range(6))
def test_an_ideal_transducer_has_its_branch_alone_and_the_intervals_of_it(seed: int) -> None:
    ideal = noisy(LOW, impedance(LOW, **IDEAL), noise=0.004, seed=seed)  # type: ignore[arg-type]
    found, plain = fit_circuit(ideal, branches=1), fit_circuit(ideal, branches=1, parts=())
    assert parts_of(found) == set()
    assert found.caveats == ()
    for name, interval in plain.intervals.items():
        assert found.intervals[name].lower == approx(interval.lower, rel=1e-9)
        assert found.intervals[name].upper == approx(interval.upper, rel=1e-9)


@mark.parametrize(("lowest", "highest"), [(30.8e3, 31.9e3), (31.05e3, 31.7e3)])
def test_an_ideal_transducer_swept_where_it_is_inductive_has_no_caveat(lowest: float, highest: float) -> None:
    # inductive from 31 000 Hz to the parallel resonance at 31 000/sqrt(1 - 0.22^2) = 31 779 Hz
    f = np.linspace(lowest if lowest < 31e3 else 30.9e3, highest, 161)
    found = fit_circuit(noisy(f, impedance(f, **IDEAL), noise=0.003, seed=1), branches=1)  # type: ignore[arg-type]
    assert found.caveats == ()
    assert parts_of(found) == set()
    assert found.resonances.parallel_frequency == approx([31e3 / np.sqrt(1 - 0.22**2)], rel=1e-4)


def test_beside_a_spurious_mode_each_coupling_factor_is_that_of_its_own_branch() -> None:
    f = np.linspace(28e3, 34e3, 241)
    z = impedance(f, c_0=2.2e-9, modes=((30e3, 700.0, 0.3), (30.8e3, 250.0, 0.04)))
    found = fit_circuit(noisy(f, z, noise=0.003, seed=3), branches=2)
    assert found.resonances.coupling_factor == approx([0.3, 0.04], rel=0.02)
    assert holds(found, coupling_factor_1=0.3, coupling_factor_2=0.04, series_frequency_1=30e3)
    # the parallel resonance of the whole circuit lies between both series resonances, so that k by it is below its own
    assert 30e3 < found.resonances.parallel_frequency[0] < 30.8e3
    assert found.resonances.effective_coupling_factor[0] < 0.24
    assert any("the modes couple" in caveat and "branches 1, 2" in caveat for caveat in found.caveats)


@mark.parametrize(
    ("make", "name", "value"), [(lossy, "loss_tangent", 0.012), (behind_cable, "series_inductance", 3.5e-6)]
)
def test_intervals_of_parts_hold_the_truth_as_often_as_they_say(make: object, name: str, value: float) -> None:
    found = [fit_circuit(make(seed), branches=1) for seed in range(100, 116)]  # type: ignore[operator]
    assert sum(holds(each, **{name: value}) for each in found) >= 12  # of 16 at 95 %: fewer in one of 100 000 series


def test_a_loss_is_told_from_a_resistance_of_the_leads() -> None:
    z = impedance(LOW, **IDEAL, resistance=25.0)  # type: ignore[arg-type]
    found = fit_circuit(noisy(LOW, z, noise=0.004, seed=5), branches=1)
    assert parts_of(found) == {"series_resistance"}
    assert found.circuit.series_resistance == approx(25.0, rel=0.1)


def test_requested_parts_are_fitted_and_others_are_not() -> None:
    found = fit_circuit(lossy(1), branches=1, parts=("loss_tangent", "series_resistance"))
    assert {"loss_tangent", "series_resistance"} <= set(found.intervals)
    assert fit_circuit(lossy(1), branches=1, parts=()).circuit.loss_tangent == approx(0.0, abs=0.0)
    with raises(UnknownName, match="unknown part of a circuit 'loss'; known: loss_tangent, series_inductance"):
        fit_circuit(lossy(1), parts=("loss",))


def test_another_residual_takes_the_parts_as_they_were_found() -> None:
    found = fit_circuit(lossy(4), branches=1, residual="linear-magnitude")
    assert found.circuit.loss_tangent == approx(0.012, rel=0.1)
    assert found.resonances.mechanical_quality_factor == approx([900.0], rel=0.05)
    assert found.residual == "linear-magnitude"


def test_digits_of_a_computed_spectrum_are_nothing_that_the_circuit_lacks() -> None:
    z = impedance(LOW, **IDEAL)  # type: ignore[arg-type]
    magnitude, phase = np.round(np.abs(z), 2), np.round(np.degrees(np.angle(z)), 3)
    written = np.asarray(magnitude * np.exp(1j * np.radians(phase)), dtype=np.complex128)
    rounded = ImpedanceSpectrum(frequency=LOW, impedance=written)
    found = fit_circuit(rounded, branches=1)
    assert 0 < found.residual_rms < 2e-5
    assert not any("does not describe" in caveat for caveat in found.caveats)
    assert parts_of(found) == set()


def test_a_spectrum_whose_phase_has_no_noise_lacks_nothing() -> None:
    z = impedance(LOW, **IDEAL)  # type: ignore[arg-type]
    scatter = np.exp(0.004 * np.random.default_rng(8).standard_normal(LOW.size))
    found = fit_circuit(ImpedanceSpectrum(frequency=LOW, impedance=z * scatter), branches=1)
    assert found.residual_correlation < 3
    assert found.caveats == ()
    assert parts_of(found) == set()
    assert holds(found, mechanical_quality_factor_1=900.0, coupling_factor_1=0.22)


def test_loss_and_resistance_are_both_found_beside_two_modes() -> None:
    f = np.linspace(28e3, 34e3, 201)
    modes = ((30e3, 700.0, 0.3), (30.8e3, 250.0, 0.04))
    z = impedance(f, c_0=2.2e-9, modes=modes, tan_d=0.01, resistance=6.0)
    found = fit_circuit(noisy(f, z, noise=0.003, seed=3), branches=2)
    assert parts_of(found) == {"loss_tangent", "series_resistance"}
    assert found.circuit.loss_tangent == approx(0.01, rel=0.1)
    assert found.circuit.series_resistance == approx(6.0, rel=0.2)
    assert found.resonances.mechanical_quality_factor == approx([700.0, 250.0], rel=0.05)
