"""Equivalent circuits fitted to spectra of known ones: values, numbers of branches and coverage of the intervals."""

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
from pytest import approx, fixture, mark, raises, skip

from sonolube.errors import InvalidInput, UnknownName
from sonolube.identification.circuit_fit import fit_circuit
from sonolube.identification.stack_fit import RESIDUALS
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum, read_impedance
from sonolube.models.actuator import ButterworthVanDyke, MotionalBranch, circuit_admittance

RB5100 = Path(__file__).parents[3] / "shared" / "data" / "impedance" / "RB5100.txt"


def branch(frequency: float, quality: float, capacitance: float) -> MotionalBranch:
    omega = 2 * np.pi * frequency
    return MotionalBranch(
        resistance=1 / (omega * capacitance * quality), inductance=1 / (omega**2 * capacitance), capacitance=capacitance
    )


ONE = ButterworthVanDyke(parallel_capacitance=2e-9, branches=(branch(22e3, 150, 3e-10),))
THREE = ButterworthVanDyke(
    parallel_capacitance=5e-9, branches=(branch(19e3, 90, 4e-10), branch(22e3, 300, 5e-11), branch(27e3, 60, 3e-10))
)


def spectrum(
    circuit: ButterworthVanDyke, *, noise: float = 0.0, seed: int = 0, points: int = 401, to: float = 32e3
) -> ImpedanceSpectrum:
    f = np.linspace(16e3, to, points)
    rng = np.random.default_rng(seed)
    scatter = noise * (rng.standard_normal(points) + 1j * rng.standard_normal(points))
    return ImpedanceSpectrum(frequency=f, impedance=np.exp(scatter) / circuit_admittance(circuit, frequency=f))


@mark.parametrize("residual", ["log-complex", "linear-magnitude"])
def test_a_circuit_is_recovered_from_its_spectrum_without_noise(residual: str) -> None:
    found = fit_circuit(spectrum(ONE), residual=residual)
    assert len(found.circuit.branches) == 1
    assert found.circuit.parallel_capacitance == approx(2e-9, rel=1e-4)
    assert found.circuit.branches[0].resistance == approx(ONE.branches[0].resistance, rel=1e-4)
    # closed forms of one branch
    assert found.resonances.series_frequency[0] == approx(22e3, rel=1e-6)
    assert found.resonances.parallel_frequency[0] == approx(22e3 * np.sqrt(1 + 3e-10 / 2e-9), rel=1e-5)
    assert found.resonances.coupling_factor[0] == approx(np.sqrt(3e-10 / 2.3e-9), rel=1e-4)
    assert found.resonances.mechanical_quality_factor[0] == approx(150, rel=1e-4)
    assert found.residual == residual


@mark.parametrize("noise", [0.0, 0.003, 0.02])
def test_the_number_of_branches_is_recovered(noise: float) -> None:
    for circuit, count in ((ONE, 1), (THREE, 3)):
        found = fit_circuit(spectrum(circuit, noise=noise, seed=3))
        assert len(found.circuit.branches) == count
        for made, known in zip(found.circuit.branches, circuit.branches, strict=True):
            assert made.capacitance == approx(known.capacitance, rel=1e-3 + 5 * noise)


def test_a_known_resistance_of_the_leads_is_accounted_for() -> None:
    behind = replace(ONE, series_resistance=25.0)
    found = fit_circuit(spectrum(behind), series_resistance=25.0)
    assert found.circuit.branches[0].resistance == approx(ONE.branches[0].resistance, rel=1e-3)


def test_confidence_intervals_have_their_nominal_coverage() -> None:
    truth = {"parallel_capacitance": 2e-9, "mechanical_quality_factor_1": 150.0, "series_frequency_1": 22e3}
    held = dict.fromkeys(truth, 0)
    runs = 80
    for seed in range(runs):
        known = fit_circuit(
            spectrum(ONE, noise=0.02, seed=seed, points=161), branches=1, confidence_level=0.9
        ).intervals
        for name, value in truth.items():
            held[name] += known[name].lower <= value <= known[name].upper
    # 72 expected, 64 three binomial deviations below
    assert all(count >= 64 for count in held.values()), held
    assert any(count < runs for count in held.values()), held


def test_a_mode_buried_in_noise_is_not_fitted_and_no_spurious_branch_is_added() -> None:
    buried = replace(ONE, branches=(*ONE.branches, branch(28e3, 20, 2e-13)))
    found = fit_circuit(spectrum(buried, noise=0.01))
    assert len(found.circuit.branches) == 1
    requested = fit_circuit(spectrum(ONE), branches=3)
    assert len(requested.circuit.branches) < 3
    assert "3 branches were requested" in requested.caveats[0]


def test_losses_that_rise_with_the_frequency_raise_a_caveat_and_widen_the_intervals() -> None:
    f = np.linspace(16e3, 32e3, 201)
    lossy = circuit_admittance(ONE, frequency=f) + 2 * np.pi * f * 2e-9 * 0.05 * (f / 24e3) ** 6
    found = fit_circuit(ImpedanceSpectrum(frequency=f, impedance=1 / lossy), branches=1)
    assert found.residual_correlation > 3
    assert "the circuit does not describe the spectrum fully" in found.caveats[0]
    interval = found.intervals["mechanical_quality_factor_1"]
    assert interval.lower < 150 < interval.upper


@mark.parametrize(("wrong", "message"), [
    (lambda s: replace(s, impedance=s.impedance.conj()), "inductive at .* opposite sign"),
    (lambda s: replace(s, impedance=2j * np.pi * s.frequency * 1e-3), "inductive at 100% of them"),
    (lambda s: replace(s, frequency=s.frequency[:6], impedance=s.impedance[:6]), "at least 8 points, got 6"),
    (lambda s: replace(s, impedance=1 / (2j * np.pi * s.frequency * 1e-9)), "that of a capacitance"),
])  # fmt: skip
def test_a_spectrum_without_a_resonance_is_refused(wrong: object, message: str) -> None:
    with raises(InvalidInput, match=message):
        fit_circuit(wrong(spectrum(ONE)))  # type: ignore[operator]


def test_unknown_residuals_and_impossible_numbers_are_refused() -> None:
    with raises(UnknownName, match=r"unknown residual 'log'; did you mean log-complex\?|unknown residual 'log'"):
        fit_circuit(spectrum(ONE), residual="log")
    with raises(InvalidInput, match="branches must lie between 1 and 8 for 401 points, got 9"):
        fit_circuit(spectrum(ONE), branches=9)


@fixture(scope="module")
def rb5100() -> ImpedanceSpectrum:
    if not RB5100.is_file():
        skip(f"{RB5100.name} is not available")
    return read_impedance(RB5100)


def test_the_linear_fit_of_a_transducer_gives_its_published_values(rb5100: ImpedanceSpectrum) -> None:
    found = fit_circuit(rb5100, residual="linear-magnitude", parts=())
    assert found.circuit.parallel_capacitance == approx(1.574e-9, rel=1e-3)
    assert found.circuit.branches[0].resistance == approx(22.2, abs=0.05)
    assert found.resonances.series_frequency == approx([154_397], abs=2)
    assert found.resonances.parallel_frequency == approx([182_966], abs=5)
    assert found.resonances.mechanical_quality_factor == approx([73], abs=0.2)


def test_the_logarithmic_fit_of_the_same_transducer_has_a_higher_quality_factor(rb5100: ImpedanceSpectrum) -> None:
    found = fit_circuit(rb5100, parts=())
    assert found.residual == "log-complex"
    assert found.resonances.mechanical_quality_factor == approx([91.6], abs=0.5)
    assert any("does not describe the spectrum fully" in caveat for caveat in found.caveats)


def test_a_measured_transducer_has_leads_that_explain_most_of_what_branches_leave(rb5100: ImpedanceSpectrum) -> None:
    plain, found = fit_circuit(rb5100, parts=()), fit_circuit(rb5100)
    assert found.circuit.series_inductance > 0
    assert found.circuit.series_resistance > 0
    assert found.residual_rms < plain.residual_rms / 3


def test_where_the_circuit_lacks_something_intervals_contain_what_every_residual_gives(
    rb5100: ImpedanceSpectrum,
) -> None:
    # quality factors of 73 and 91.6 for one spectrum: each fit is certain to 2 %, and they exclude each other
    fits = [fit_circuit(rb5100, residual=residual, parts=()) for residual in RESIDUALS]
    for found in fits:
        for other in fits:
            value = other.resonances.mechanical_quality_factor[0]
            interval = found.intervals["mechanical_quality_factor_1"]
            assert interval.lower < value < interval.upper


def test_intervals_of_a_spectrum_that_the_circuit_describes_are_those_of_one_residual() -> None:
    found = fit_circuit(spectrum(ONE, noise=0.02, seed=1))
    assert found.residual_correlation < 3
    # Q of one branch is known to about noise sqrt(2/points within the resonance)
    interval = found.intervals["mechanical_quality_factor_1"]
    assert interval.upper / interval.lower < 1.1


def test_the_residual_is_the_scatter_of_the_spectrum() -> None:
    f = np.linspace(16e3, 32e3, 401)
    one, other = np.random.default_rng(4).normal(scale=0.01, size=(2, f.size))
    impedance = (1 + one + 1j * other) / circuit_admittance(ONE, frequency=f)
    found = fit_circuit(ImpedanceSpectrum(frequency=f, impedance=impedance), branches=1)
    assert found.residual_rms == approx(0.01 * 2**0.5, rel=0.1)  # of both parts together


def test_the_curve_that_the_analyser_computed_is_one_branch_to_its_last_digit(rb5100: ImpedanceSpectrum) -> None:
    found = fit_circuit(read_impedance(RB5100, sweep="memory"))
    assert len(found.circuit.branches) == 1
    assert found.residual_rms < 1e-6
    assert found.caveats == ()


@mark.parametrize("factor", [1e-6, 10.0, 1e3, 1e12, 1e100, -1e5])
def test_a_point_without_its_decimal_point_ends_in_a_fit_or_one_line(factor: float) -> None:
    clean = spectrum(ONE, noise=1e-3, points=81)
    for point in range(0, 81, 8):
        impedance = clean.impedance.copy()
        impedance[point] *= factor
        with suppress(InvalidInput):
            assert fit_circuit(replace(clean, impedance=impedance)).circuit.branches
