"""Residuals of admittances, caveats of spectra, and the phase of minimum phase, against values by hand."""

from typing import Any

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.identification.circuit_fit import fit_circuit
from sonolube.identification.stack_fit import (
    admittance_with_phase,
    caveats_of_spectrum,
    fit_stack,
    hardly_determined,
    inductive_caveats,
    minimum_phase_admittance,
    residual_for,
    residual_named,
)
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.measurement.statistics.log_parameter_fit import ConfidenceInterval
from sonolube.models.actuator import PiezoStack

MEASURED = np.array([1.0 + 1.0j, 2.0j, -4.0 + 0.0j])
CAPACITIVE, INDUCTIVE = np.full(40, 1j), np.full(40, -1j)
MODEL = np.array([2.0 + 2.0j, -2.0, -2.0])


def test_residuals_are_logarithms_of_magnitude_with_phases_or_differences_over_the_largest() -> None:
    # magnitudes 2 sqrt(2), 2, 2 over sqrt(2), 2, 4: factors 2, 1, 1/2; phases 0, +90 degrees, 0
    factors = np.log([2.0, 1.0, 0.5])
    assert residual_named("log-complex")(MODEL, MEASURED) == approx([*factors, 0.0, np.pi / 2, 0.0])
    assert residual_named("log-magnitude")(MODEL, MEASURED) == approx(factors)
    assert residual_named("linear-magnitude")(MODEL, MEASURED) == approx([2**0.5 / 4, 0.0, -0.5])
    with raises(UnknownName, match="linear-magnitude"):
        residual_named("linear-magnitud")


def spectrum(*, impedance: Any = None, has_phase: bool = True, frequency: Any = None) -> ImpedanceSpectrum:
    f = np.linspace(1e3, 1e4, 40) if frequency is None else np.asarray(frequency, float)
    return ImpedanceSpectrum(
        frequency=f,
        impedance=np.asarray(1 / (2j * np.pi * f * 1e-8) if impedance is None else impedance, complex),
        has_phase=has_phase,
    )


def test_without_a_phase_the_logarithm_of_the_magnitude_takes_the_place_of_the_complex_one_alone() -> None:
    silent = spectrum(has_phase=False)
    assert residual_for(silent, "log-complex") == "log-magnitude"
    assert residual_for(silent, "linear-magnitude") == "linear-magnitude"
    assert residual_for(spectrum(), "log-complex") == "log-complex"


def intervals(**uppers: float) -> dict[str, ConfidenceInterval]:
    return {name: ConfidenceInterval(value=1.5, lower=1.0, upper=upper) for name, upper in uppers.items()}


def test_a_parameter_is_hardly_determined_from_a_factor_of_four_between_its_ends_on() -> None:
    found = intervals(sure=3.99, open=4.0, unknown=float("nan"), vague=9.0)
    assert hardly_determined(found) == ["open", "unknown", "vague"]
    assert caveats_of_spectrum(spectrum(), intervals(sure=2.0)) == ()
    (loose,) = caveats_of_spectrum(spectrum(), found)
    assert loose == "hardly determined: open, unknown, vague; the spectrum is not that of the model"
    (silent,) = caveats_of_spectrum(spectrum(has_phase=False), found)
    assert silent.endswith(
        "so the fit is to the magnitude of the admittance alone; hardly determined: open, unknown, vague"
    )
    assert caveats_of_spectrum(spectrum(has_phase=False), intervals(sure=2.0))[0].endswith(
        "alone; it determines every parameter"
    )


@mark.parametrize(("count", "is_said"), [(2, False), (3, True)])
def test_an_inductive_part_above_a_twentieth_of_the_points_is_named(count: int, is_said: bool) -> None:
    # of 40 points two are a twentieth; inductive is a positive reactance
    f = np.linspace(1e3, 1e4, 40)
    reactance = np.where(np.arange(40) >= 40 - count, 1.0, -1.0)
    found = inductive_caveats(spectrum(impedance=10 + 1j * reactance), CAPACITIVE)
    assert bool(found) is is_said
    if is_said:
        assert f"inductive at 8% of the points, from {f[37]:.6g} to 10000 Hz" in found[0]
    # where the fit is inductive as well there is nothing to say, however many points are
    for inductive in (count, 21, 40):
        reactance = np.where(np.arange(40) >= 40 - inductive, 1.0, -1.0)
        assert inductive_caveats(spectrum(impedance=10 + 1j * reactance), INDUCTIVE) == ()


@mark.parametrize("points", [301, 9001])
def test_a_magnitude_has_the_phase_of_the_only_circuit_without_delay_that_has_it(points: int) -> None:
    # one branch beside a capacitance; more than 5000 points are thinned and interpolated between
    f = np.linspace(8e3, 60e3, points)
    s = 2j * np.pi * f
    admittance = s * (1e-8 + 4e-9 / (1 - (f / 25e3) ** 2 + 1j * f / (25e3 * 12)))
    found = minimum_phase_admittance(np.abs(admittance), frequency=f)
    assert np.abs(found) == approx(np.abs(admittance))
    inner = (f > 12e3) & (f < 45e3)
    assert np.max(np.abs(np.angle(found[inner] / admittance[inner]))) < 0.04
    assert np.max(np.abs(np.angle(found))) <= np.pi / 2 + 1e-12
    silent = spectrum(frequency=f, impedance=np.abs(1 / admittance), has_phase=False)
    assert admittance_with_phase(silent) == approx(found)
    told = spectrum(frequency=f, impedance=1 / admittance)
    assert admittance_with_phase(told) == approx(admittance)


def test_a_capacitance_has_a_phase_of_ninety_degrees_at_every_point() -> None:
    f = np.geomspace(1e3, 1e5, 60)
    found = minimum_phase_admittance(2 * np.pi * f * 3e-9, frequency=f)
    assert np.angle(found) == approx(np.full(60, np.pi / 2), abs=1e-6)


@mark.parametrize(("power", "phase"), [(2.5, np.pi / 2), (-2.5, -np.pi / 2), (0.0, 0.0)])
def test_a_phase_is_that_of_the_slope_of_the_magnitude_within_a_quarter_turn(power: float, phase: float) -> None:
    # half of pi for each power of the frequency; passive parts turn by no more than half of pi
    f = np.geomspace(10, 1e7, 2001)
    found = minimum_phase_admittance(1e-6 * f**power, frequency=f)
    assert np.angle(found[1000]) == approx(phase, abs=0.02)
    assert np.max(np.abs(np.angle(found))) <= np.pi / 2 + 1e-12


def test_spectra_of_too_few_points_and_impossible_levels_are_refused() -> None:
    seven, eight = (spectrum(frequency=np.linspace(1e3, 2e3, count)) for count in (7, 8))
    stack = PiezoStack(free_capacitance=360e-9, free_stroke_per_volt=6e-9, stack_stiffness=2e9, stack_damping=300.0)

    def nowhere(_: PiezoStack) -> Any:
        raise LookupError("reached")

    with raises(InvalidInput, match="spectrum must have at least 8 points, got 7"):
        fit_stack(seven, stack, in_structure=nowhere)
    with raises(LookupError, match="reached"):
        fit_stack(eight, stack, in_structure=nowhere)
    with raises(InvalidInput, match="at least 8 points, got 7"):
        fit_circuit(seven)
    with raises(InvalidInput, match="branches must lie between 1 and 1 for 8 points, got 2"):
        fit_circuit(eight, branches=2)
    with raises(InvalidInput, match="branches must lie between 1 and 8 for 400 points, got 9"):
        fit_circuit(spectrum(frequency=np.linspace(1e3, 2e3, 400)), branches=9)
    for level in (0.49, 0.99995):
        with raises(InvalidInput, match="confidence_level"):
            fit_circuit(eight, confidence_level=level)
        with raises(InvalidInput, match="confidence_level"):
            fit_stack(eight, stack, in_structure=nowhere, confidence_level=level)
    with raises(InvalidInput, match="no resonance of a transducer found among 40 points from 1000 to 10000 Hz"):
        fit_circuit(spectrum())
