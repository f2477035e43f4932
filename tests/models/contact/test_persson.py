"""Persson's theory against independent quadrature, its limits and the first law of thermodynamics."""

import math

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.integrate import quad
from tests.models.surfaces.spectral_moments import moments

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import (
    PerssonContact,
    persson_area,
    persson_area_fraction,
    persson_load,
    persson_separation,
    persson_stiffness,
)
from sonolube.models.surfaces import RadialSpectrum, SelfAffineSpectrum

E_STAR = 100e9
AREA = 1e-6
SELF_AFFINE = SelfAffineSpectrum(
    longest_wavelength=1e-3, rolloff_wavelength=2.5e-4, shortest_wavelength=1e-5, hurst_exponent=0.8
)

RMS_HEIGHT = 1e-6


def spectrum(points: int = 4000) -> RadialSpectrum:
    k = np.geomspace(1e3, 1e5, points)
    relative = SELF_AFFINE.relative_spectral_density(wavenumber=np.clip(k, 1e3 * (1 + 1e-12), 1e5 * (1 - 1e-12)))
    # scaled so that the integral of 2 pi k C over k is the variance
    scale = RMS_HEIGHT**2 / np.trapezoid(2 * math.pi * k * relative, k)
    return RadialSpectrum(wavenumber=k, areal_spectral_density=scale * relative)


SPECTRUM = spectrum()
CONTACT = PerssonContact(spectrum=SPECTRUM, effective_modulus=E_STAR, nominal_area=AREA)
loads = st.floats(1e-3, 1e3)


def angular_density(q: float) -> float:
    """Density over angular wavenumbers, by the closed form and its closed variance."""
    k = q / (2 * math.pi)
    knee = 4e3
    plateau = math.pi * (knee**2 - 1e6)
    fall = 2 * math.pi * knee**3.6 * (knee**-1.6 - 1e5**-1.6) / 1.6
    shape = float(max(k / knee, 1.0) ** -3.6)
    return RMS_HEIGHT**2 * shape / float(plateau + fall) / (2 * math.pi) ** 2


def gap_by_the_double_integral(pressure: float, gamma: float) -> float:
    """Yang and Persson's double integral, by quadrature on both variables."""
    q_0, q_1 = 2 * math.pi * 1e3, 2 * math.pi * 1e5

    def over_pressure(w: float) -> float:
        low = w * pressure / E_STAR
        return float(
            quad(
                lambda s: (gamma + 3 * (1 - gamma) * math.erf(s) ** 2) * math.exp(-(s**2)) / s, low, max(low, 1.0) + 7
            )[0]
        )

    q = np.geomspace(q_0, q_1, 4001)
    C = np.array([angular_density(each) for each in q])
    slopes = np.concatenate([[0.0], np.cumsum((q[1:] ** 3 * C[1:] + q[:-1] ** 3 * C[:-1]) / 2 * np.diff(q))])
    w = 1 / np.sqrt(math.pi * np.maximum(slopes, 1e-300))
    integrand = [
        0.0 if w_q * pressure / E_STAR > 6 else q_i**2 * c * w_q * over_pressure(w_q)
        for q_i, c, w_q in zip(q[1:], C[1:], w[1:], strict=True)
    ]
    return float(math.sqrt(math.pi) * np.trapezoid(integrand, q[1:]))


def test_the_slope_is_that_of_the_closed_moments() -> None:
    found = moments(SELF_AFFINE, rms_height=RMS_HEIGHT)
    assert CONTACT.rms_gradient == approx(math.sqrt(2 * found.slope_variance), rel=1e-4)


def test_the_area_has_its_limits_of_low_and_high_pressure() -> None:
    low = persson_area_fraction(nominal_pressure=1e5, effective_modulus=E_STAR, rms_gradient=0.1)
    assert low == approx(math.sqrt(8 / math.pi) * 1e5 / (E_STAR * 0.1), rel=1e-9)
    assert persson_area(CONTACT, normal_load=1e9) == approx(AREA)


def test_the_gap_is_the_double_integral_of_yang_and_persson() -> None:
    for share in (1e-3, 0.03, 0.3):
        pressure = share * E_STAR * CONTACT.rms_gradient
        for gamma in (0.45, 1.0):
            contact = PerssonContact(
                spectrum=SPECTRUM, effective_modulus=E_STAR, nominal_area=AREA, energy_fraction=gamma
            )
            computed = persson_separation(contact, normal_load=pressure * AREA)
            assert computed == approx(gap_by_the_double_integral(pressure, gamma), rel=3e-3)


def test_the_work_of_closing_the_gap_is_the_elastic_energy_of_the_flattened_waves() -> None:
    # all waves pressed flat: E*/4 times the mean of q h^2, over the plane of wavenumbers
    load = np.geomspace(1e-8, 100, 4000) * AREA * E_STAR * CONTACT.rms_gradient
    gap = persson_separation(CONTACT, normal_load=load)
    work = -np.trapezoid(load, gap) / AREA
    k = SPECTRUM.wavenumber
    stored = E_STAR / 4 * np.trapezoid(2 * math.pi * k * SPECTRUM.areal_spectral_density * 2 * math.pi * k, k)
    assert work == approx(stored, rel=2e-3)


@given(load=loads)
def test_the_stiffness_is_the_slope_of_the_load(load: float) -> None:
    step = 1e-4
    gaps = persson_separation(CONTACT, normal_load=load * np.array([1 - step, 1 + step]))
    assert persson_stiffness(CONTACT, normal_load=load) == approx(2 * step * load / (gaps[0] - gaps[1]), rel=1e-4)


def test_a_low_load_falls_exponentially_with_the_gap() -> None:
    low = 1e-5 * AREA * E_STAR * CONTACT.rms_gradient
    lengths = [load / persson_stiffness(CONTACT, normal_load=load) for load in (low, low / 100)]
    assert lengths[0] == approx(lengths[1], rel=1e-3)
    assert 0.3 * RMS_HEIGHT < lengths[0] < 0.6 * RMS_HEIGHT  # u0 is about half the rms height for H = 0.8


@given(load=st.floats(1e-2, 1e2))
def test_the_load_at_a_gap_is_the_inverse_of_the_gap_at_a_load(load: float) -> None:
    gap = persson_separation(CONTACT, normal_load=load)
    assert persson_load(CONTACT, separation=gap) == approx(load, rel=1e-8)


def test_a_spectrum_with_unsorted_wavenumbers_is_refused() -> None:
    with raises(InvalidInput, match="rising order"):
        PerssonContact(
            spectrum=RadialSpectrum(wavenumber=np.array([2.0, 1.0]), areal_spectral_density=np.ones(2)),
            effective_modulus=E_STAR,
            nominal_area=AREA,
        )


def test_a_load_that_closes_the_gap_completely_is_refused() -> None:
    with raises(OutsideRange, match="closes the gap"):
        persson_stiffness(CONTACT, normal_load=1e9)


def test_a_spectrum_that_is_zero_at_some_wavenumbers_is_taken_and_one_that_is_zero_at_all_refused() -> None:
    k = np.geomspace(1e3, 1e5, 50)
    somewhere = RadialSpectrum(wavenumber=k, areal_spectral_density=np.where(k > 5e3, 1e-20, 0.0))
    assert PerssonContact(spectrum=somewhere, effective_modulus=E_STAR, nominal_area=AREA).rms_gradient > 0
    with raises(InvalidInput, match="somewhere positive"):
        PerssonContact(
            spectrum=RadialSpectrum(wavenumber=k, areal_spectral_density=np.zeros(50)),
            effective_modulus=E_STAR,
            nominal_area=AREA,
        )
