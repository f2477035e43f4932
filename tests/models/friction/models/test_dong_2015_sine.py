"""The cube model under a sine against quadrature, and the printed form with in-plane motion."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from pytest import approx, raises
from scipy.integrate import quad
from tests.tiers import examples

from sonolube.errors import InvalidInput, ModelRangeWarning
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactPair,
    ElasticBody,
    GaussianHeights,
    RoughContact,
    contact_pair,
    cube_tangential_stiffness,
    separation,
)
from sonolube.models.friction import dong_2015_deformation_ratio, dong_2015_half_period_ratio
from sonolube.models.surfaces import Roughness

ALUMINIUM = ElasticBody(youngs_modulus=73e9, poisson_ratio=0.33)
STEEL = ElasticBody(youngs_modulus=200e9, poisson_ratio=0.29)
ROUGHNESS = Roughness(rms_height=6e-6, summit_radius=1.7e-6, summit_density=47e9)  # D Table 3.1


def welder(pair: ContactPair) -> RoughContact:
    return RoughContact(roughness=ROUGHNESS, pair=pair, nominal_area=1e-4, asperity=ASPERITY_LAWS["dong_2015"])


ALUMINIUM_ON_STEEL = welder(contact_pair(softer=ALUMINIUM, harder=STEEL, yield_strength=410e6))
STEEL_ON_STEEL = welder(contact_pair(softer=STEEL, harder=STEEL, yield_strength=250e6))
LOADS = np.arange(40.0, 241.0, 20.0)


def ratio_by_hand(d: float, a: float) -> float:
    """Return the half-period mean of k_t, in proportion to exp(-2 lambda x/Rq) (d/(d + x))^3 with lambda = 3."""

    def stiffness(theta: mpmath.mpf) -> mpmath.mpf:
        x = a * mpmath.sin(theta)
        return mpmath.exp(-6 * x / mpmath.mpf(6e-6)) * (d / (d + x)) ** 3

    return float(mpmath.quad(stiffness, [0, mpmath.pi / 8, mpmath.pi / 2]) / (mpmath.pi / 2))


@pytest.mark.parametrize("load", [1e-3, 3.0, 40.0, 240.0])
@pytest.mark.parametrize("fraction", [0.0, 0.01, 0.3, 0.999])
def test_the_ratio_is_the_mean_of_the_stiffness_over_the_separating_half(load: float, fraction: float) -> None:
    d = float(separation(ALUMINIUM_ON_STEEL, normal_load=load))
    ratio = dong_2015_half_period_ratio(ALUMINIUM_ON_STEEL, normal_load=load, vibration_amplitude=fraction * d)
    assert ratio == approx(ratio_by_hand(d, fraction * d), rel=1e-10)


def test_gaussian_heights_are_averaged_as_well() -> None:
    roughness = Roughness(rms_height=1e-6, summit_radius=5e-6, summit_density=1e10)
    contact = RoughContact(
        roughness=roughness,
        pair=ALUMINIUM_ON_STEEL.pair,
        nominal_area=1e-4,
        heights=GaussianHeights.from_roughness_parameter(roughness_parameter=roughness.roughness_parameter),
        asperity=ASPERITY_LAWS["dong_2015"],
    )
    d = float(separation(contact, normal_load=1.0))

    def stiffness(theta: float) -> float:
        return float(cube_tangential_stiffness(contact, separation=d + 0.5e-6 * np.sin(theta)))

    by_hand = quad(stiffness, 0, np.pi / 2, epsrel=1e-9)[0] / (np.pi / 2) / stiffness(0.0)
    assert dong_2015_half_period_ratio(contact, normal_load=1.0, vibration_amplitude=0.5e-6) == approx(
        by_hand, rel=1e-6
    )


@pytest.mark.parametrize(
    ("contact", "axial_amplitude", "poisson_ratio", "lowest", "highest"),
    [
        (ALUMINIUM_ON_STEEL, 8.5e-6, 0.33, 0.45, 0.465),
        (ALUMINIUM_ON_STEEL, 11.24e-6, 0.33, 0.535, 0.55),
        (STEEL_ON_STEEL, 8.5e-6, 0.29, 0.415, 0.43),
        (STEEL_ON_STEEL, 11.24e-6, 0.29, 0.495, 0.515),
    ],
)
def test_vibration_halves_the_friction_of_the_poisson_rig(
    contact: RoughContact, axial_amplitude: float, poisson_ratio: float, lowest: float, highest: float
) -> None:
    # D 3.1.4 measured 30 to 50 and 50 to 56 %
    b = 25.4e-3 * axial_amplitude * np.pi * poisson_ratio / (2 * 127e-3)
    reduction = 1 - dong_2015_half_period_ratio(contact, normal_load=LOADS, vibration_amplitude=b)
    assert np.all((reduction > lowest) & (reduction < highest))


@examples(50)
@given(load=st.floats(1, 300), amplitude=st.floats(0, 5e-6), more=st.floats(1e-9, 5e-6))
def test_friction_falls_with_the_amplitude(load: float, amplitude: float, more: float) -> None:
    weak, strong = dong_2015_half_period_ratio(
        ALUMINIUM_ON_STEEL, normal_load=load, vibration_amplitude=[amplitude, amplitude + more]
    )
    assert 0 < strong < weak <= 1 + 1e-14


def test_loads_and_amplitudes_broadcast_over_more_points_than_a_block() -> None:
    amplitudes = np.linspace(0, 3e-6, 1001)
    ratios = dong_2015_half_period_ratio(
        ALUMINIUM_ON_STEEL, normal_load=LOADS[:, np.newaxis], vibration_amplitude=amplitudes
    )
    assert ratios.shape == (11, 1001)
    one = dong_2015_half_period_ratio(ALUMINIUM_ON_STEEL, normal_load=LOADS[7], vibration_amplitude=amplitudes[700])
    assert ratios[7, 700] == approx(float(one), rel=1e-14)


def test_friction_falls_with_the_amplitude_even_beyond_the_separation() -> None:
    amplitudes = np.linspace(0, 60e-6, 100)  # the separation is 18.1 um
    ratios = dong_2015_half_period_ratio(ALUMINIUM_ON_STEEL, normal_load=40.0, vibration_amplitude=amplitudes)
    assert ratios[0] == approx(1.0)
    assert np.all(np.diff(ratios) < 0)
    assert ratios[-1] > 0


def test_a_negative_amplitude_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"vibration_amplitude must not be negative, got -1e-06 m"):
        dong_2015_half_period_ratio(ALUMINIUM_ON_STEEL, normal_load=40.0, vibration_amplitude=-1e-6)


def half_period_mean(value: NDArray[np.float64]) -> float:
    return float(np.mean((value[1:] + value[:-1]) / 2))


@pytest.mark.parametrize("phase", [0.0, 0.7, np.pi / 2, 2.5])
def test_the_printed_form_is_the_mean_of_stiffness_times_deformation(phase: float) -> None:
    load, b, u, delta = 40.0, 0.88e-6, 0.3e-9, 0.5e-9
    theta = np.linspace(0, np.pi, 20001)
    d = float(separation(ALUMINIUM_ON_STEEL, normal_load=load))
    k = cube_tangential_stiffness(ALUMINIUM_ON_STEEL, separation=d + b * np.sin(theta))
    by_hand = half_period_mean(k / k[0] * (delta + u * np.sin(theta + phase)) / delta)
    ratio = dong_2015_deformation_ratio(
        ALUMINIUM_ON_STEEL, normal_load=load, normal_amplitude=b, in_plane_amplitude=u, deformation=delta, phase=phase
    )
    assert ratio == approx(by_hand, rel=1e-7)


def test_without_in_plane_motion_the_printed_form_is_the_half_period_ratio() -> None:
    printed = dong_2015_deformation_ratio(
        ALUMINIUM_ON_STEEL, normal_load=LOADS, normal_amplitude=1e-6, in_plane_amplitude=0.0, deformation=5e-10
    )
    plain = dong_2015_half_period_ratio(ALUMINIUM_ON_STEEL, normal_load=LOADS, vibration_amplitude=1e-6)
    assert printed == approx(plain, rel=1e-13)


def test_an_in_plane_amplitude_beyond_the_deformation_warns() -> None:
    # 2 mm off the node of D's waveguide the surface moves 0.42 um along
    with pytest.warns(
        ModelRangeWarning, match=r"in_plane_amplitude of up to 4\.2e-07 m is added to a deformation of 5e-10"
    ):
        dong_2015_deformation_ratio(
            ALUMINIUM_ON_STEEL,
            normal_load=40.0,
            normal_amplitude=0.88e-6,
            in_plane_amplitude=0.42e-6,
            deformation=0.5e-9,
        )
