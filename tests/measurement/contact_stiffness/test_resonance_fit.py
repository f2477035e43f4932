"""Resonances fitted to synthetic spectra against the poles they were made of."""

from pathlib import Path

import numpy as np
from pytest import approx, mark, raises

from reliability import virtual_contact as virtual
from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.contact_stiffness.resonance_fit import fit_resonances
from sonolube.measurement.contact_stiffness.resonance_spectrum import read_resonance_spectrum, vibration_spectrum

SLOW = np.linspace(70, 400, 331)


def pole_frequencies(spring: float) -> Floats:
    mass, damping, stiffness = virtual.TRIBOMETER.matrices()
    stiffness[0, 0] += spring
    n = len(mass)
    upper = np.hstack([np.zeros((n, n)), np.eye(n)])
    lower = np.linalg.solve(mass, np.hstack([-stiffness, -damping]))
    roots = np.linalg.eigvals(np.vstack([upper, lower]))
    return np.sort(np.abs(roots[roots.imag > 0])) / (2 * np.pi)


def measured(spring: float, noise: float, seed: int) -> Complexes:
    return virtual.noisy(np.random.default_rng(seed), virtual.velocity(virtual.TRIBOMETER, SLOW, spring=spring), noise)


@mark.parametrize(("spring", "found"), [(3 / 2e-6, 2), (3 / 0.7e-6, 2)])
def test_two_overlapping_resonances_are_told_apart(spring: float, found: int) -> None:
    fit = fit_resonances(vibration_spectrum(frequency=SLOW, response=measured(spring, 1e-3, 1), quantity="velocity"))
    assert len(fit.resonances) == found
    for resonance, true in zip(fit.resonances, pole_frequencies(spring), strict=False):
        assert abs(resonance.frequency - true) < 4 * resonance.frequency_uncertainty
        assert resonance.frequency_uncertainty < 0.002 * true


def test_magnitudes_alone_give_the_same_resonance() -> None:
    values = np.abs(measured(3 / 0.7e-6, 1e-3, 2))
    fit = fit_resonances(vibration_spectrum(frequency=SLOW, response=values, quantity="velocity"))
    assert fit.nearest(221.7).frequency == approx(pole_frequencies(3 / 0.7e-6)[1], rel=2e-3)


def test_a_constant_phase_error_moves_no_resonance() -> None:
    plain = measured(3 / 0.7e-6, 1e-3, 3)
    straight, turned = (
        fit_resonances(vibration_spectrum(frequency=SLOW, response=values, quantity="velocity"))
        for values in (plain, plain * np.exp(0.7j))
    )
    assert turned.nearest(221.7).frequency == approx(straight.nearest(221.7).frequency, rel=1e-5)


def test_a_spectrum_without_resonance_is_refused() -> None:
    with raises(InvalidInput, match="no resonance found among 331 points from 70 to 400 Hz"):
        fit_resonances(vibration_spectrum(frequency=SLOW, response=(1 / SLOW).astype(np.complex128)))


def test_velocity_and_acceleration_in_any_unit_read_as_the_same_motion(tmp_path: Path) -> None:
    f, x = np.linspace(100, 200, 40), np.exp(0.5j) * np.linspace(1, 2, 40)
    for name, power, scale in (
        ("velocity (mm/s)", 1, 1e3),
        ("acceleration (g)", 2, 0.1),
        ("displacement (um)", 0, 1e6),
    ):
        y = scale * x * (2j * np.pi * f) ** power
        rows = [f"{a / 1e3},{abs(b)},{np.degrees(np.angle(b))}" for a, b in zip(f, y, strict=True)]
        path = tmp_path / "table.csv"
        path.write_text("\n".join([f"frequency (kHz),{name},phase (deg)", *rows]))
        spectrum = read_resonance_spectrum(path)
        ratio = spectrum.response / x
        assert spectrum.frequency == approx(f)
        assert ratio / ratio[0] == approx(np.ones(40), rel=1e-9)
        assert np.angle(ratio[0]) == approx(0, abs=1e-9)


def test_an_impedance_is_read_as_the_charge_that_its_voltage_moves(tmp_path: Path) -> None:
    f = np.linspace(1e3, 2e3, 30)
    path = tmp_path / "capacitor.csv"
    rows = [f"{a},{1 / (2 * np.pi * a * 1e-8)},-90" for a in f]
    path.write_text("\n".join(["frequency (Hz),|Z| (ohm),phase (deg)", *rows]))
    spectrum = read_resonance_spectrum(path)
    assert spectrum.response == approx(np.full(30, 1e-8 + 0j), rel=1e-9)


@mark.parametrize(
    ("text", "message"),
    [
        ("frequency (Hz),velocity (mm/s),phase\n1,2,3\n", "line 1: the phase needs a unit"),
        ("frequency (Hz),velocity (mm/s)\n1,2\n2,x\n", "line 3: 'x' is not a finite number"),
        ("frequency (Hz),velocity (mm/s)\n1,2\n2,3\n", "at least 12 points, got 2"),
        ("frequency (Hz),colour\n1,2\n2,3\n", "names no columns of frequency and impedance"),
    ],
)
def test_a_table_that_is_no_spectrum_is_refused_with_its_reason(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "table.csv"
    path.write_text(text)
    with raises(InvalidInput, match=message):
        read_resonance_spectrum(path)


def test_a_table_of_vibration_with_units_in_a_row_of_their_own_and_decimal_commas_is_read(tmp_path: Path) -> None:
    # 5 um at 100 Hz; phases of 90 degrees turn the response to +i.
    rows = [f"{100 + k},0;5,0;90,0" for k in range(12)]
    path = tmp_path / "table.txt"
    path.write_bytes("\n".join(["Prüfstand A", "Frequency;Displacement;Phase", "Hz;µm;°", *rows]).encode("cp1252"))
    spectrum = read_resonance_spectrum(path)
    assert spectrum.frequency == approx(100 + np.arange(12.0))
    assert spectrum.response == approx(np.full(12, 5j), abs=1e-12)
    assert "read as Windows-1252" in spectrum.caveats[0]
