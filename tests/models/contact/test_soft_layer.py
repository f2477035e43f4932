"""Soft layers: limits of a thin and a thick layer, of a Prony series, Kramers-Kronig, and waves in the layer."""

import math

import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import solve_ivp

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import (
    ElasticBody,
    PronySeries,
    SoftLayer,
    SphereOnFlat,
    complex_modulus,
    dynamic_stiffness_ratio,
    hertz_contact_radius,
    layer_loss_power,
    layer_normal_stiffness,
    layer_tangential_stiffness,
    oedometric_modulus,
)

FELT = ElasticBody(youngs_modulus=1e6, poisson_ratio=0.4)
RUBBER = PronySeries(relaxed_modulus=2e6, relaxation_modulus=(5e6, 3e6), relaxation_time=(1e-4, 3e-6))


def test_a_prony_series_has_its_own_limits_at_zero_and_infinite_frequency() -> None:
    assert complex_modulus(RUBBER, frequency=0.0) == 2e6
    at_high = complex_modulus(RUBBER, frequency=1e12)
    assert at_high.real == approx(RUBBER.instantaneous_modulus, rel=1e-9)
    assert at_high.imag == approx(0.0, abs=1e3)


def test_storage_and_loss_modulus_meet_kramers_and_kronig() -> None:
    # E'(w) - E(0) = (2 w^2/pi) P int E''(s)/(s (w^2 - s^2)) ds; the pole is taken out, as int ds/(w^2 - s^2) = 0
    s = np.geomspace(1e-2, 1e12, 400_001)
    for frequency in (300.0, 20e3, 4e5):
        omega = 2 * np.pi * frequency
        loss = complex_modulus(RUBBER, frequency=s / (2 * np.pi)).imag
        own = complex_modulus(RUBBER, frequency=frequency)
        integrand = np.divide(loss / s - own.imag / omega, omega**2 - s**2, where=s != omega, out=np.zeros_like(s))
        storage = 2e6 + 2 * omega**2 / np.pi * np.trapezoid(integrand, s)
        assert storage == approx(own.real, rel=1e-4)


def test_the_complex_modulus_is_the_response_of_the_relaxing_stress_to_a_sine() -> None:
    frequency = 20e3
    omega = 2 * np.pi * frequency
    tau, moduli = np.array(RUBBER.relaxation_time), np.array(RUBBER.relaxation_modulus)
    periods = 40
    steps = solve_ivp(
        lambda t, q: moduli * omega * np.cos(omega * t) - q / tau,
        (0, periods / frequency),
        np.zeros(2),
        rtol=1e-9,
        atol=1e-3,
        max_step=0.02 / frequency,
        t_eval=np.linspace((periods - 1) / frequency, periods / frequency, 400, endpoint=False),
    )
    stress = 2e6 * np.sin(omega * steps.t) + steps.y.sum(axis=0)
    by_sine = 2 * np.mean(stress * np.exp(-1j * omega * steps.t)) * 1j
    assert by_sine == approx(complex(complex_modulus(RUBBER, frequency=frequency)), rel=1e-4)


@pytest.mark.parametrize("ratio", [0.0, 0.2, 0.4])
def test_a_thin_layer_is_a_winkler_bed_of_the_oedometric_modulus(ratio: float) -> None:
    body = ElasticBody(youngs_modulus=1e6, poisson_ratio=ratio)
    layer = SoftLayer(body=body, layer_thickness=1e-3)
    for radius, error in ((0.05, 0.01), (0.19, 0.003), (0.5, 1e-12)):
        bed = oedometric_modulus(body) * math.pi * radius**2 / 1e-3
        assert layer_normal_stiffness(layer, face_radius=radius) == approx(bed, rel=error)


def test_the_oedometric_modulus_is_that_of_lame_constants() -> None:
    E, nu = 1e6, 0.4
    lame, G = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    assert oedometric_modulus(FELT) == approx(lame + 2 * G)
    assert oedometric_modulus(ElasticBody(youngs_modulus=1e6, poisson_ratio=0.0)) == approx(1e6)


def test_a_thick_layer_is_a_half_space_and_a_sphere_on_it_that_of_hertz() -> None:
    layer, radius = SoftLayer(body=FELT, layer_thickness=1.0), 1e-3
    modulus = 1e6 / (1 - 0.4**2)
    assert layer_normal_stiffness(layer, face_radius=radius) == approx(2 * radius * modulus, rel=2e-3)
    # Hertz: the stiffness at a load is that of a flat punch of the radius of contact
    ball, load = SphereOnFlat(tip_radius=0.02, effective_modulus=modulus), 0.05
    approach = [
        float(hertz_contact_radius(ball, normal_load=each)) ** 2 / 0.02 for each in (0.999 * load, 1.001 * load)
    ]
    contact = float(hertz_contact_radius(ball, normal_load=load))
    assert layer_normal_stiffness(layer, face_radius=contact) == approx(
        0.002 * load / (approach[1] - approach[0]), rel=5e-3
    )


def test_tangential_over_normal_stiffness_has_the_limits_of_shear_over_compression_and_of_mindlin() -> None:
    for thickness, ratio in ((1e-4, (1 - 0.8) / (2 * 0.6)), (10.0, 2 * 0.6 / 1.6)):
        layer = SoftLayer(body=FELT, layer_thickness=thickness)
        found = layer_tangential_stiffness(layer, face_radius=0.015) / layer_normal_stiffness(layer, face_radius=0.015)
        assert found == approx(ratio, rel=5e-3)


def test_an_incompressible_thin_layer_is_refused_with_a_remedy() -> None:
    layer = SoftLayer(body=ElasticBody(youngs_modulus=1e6, poisson_ratio=0.5), layer_thickness=1e-5)
    with raises(OutsideRange, match=r"below 0\.5, such as 0\.49"):
        layer_normal_stiffness(layer, face_radius=0.1)
    waving = SoftLayer(body=ElasticBody(youngs_modulus=1e6, poisson_ratio=0.5), layer_thickness=1e-3, layer_density=1e3)
    with raises(InvalidInput, match="needs a compressible layer"):
        dynamic_stiffness_ratio(waving, frequency=20e3)


def test_stiffening_and_loss_multiply_the_stiffness_of_a_layer_without_mass() -> None:
    layer = SoftLayer(body=FELT, layer_thickness=2e-3, dynamic_modulus_ratio=3.0, layer_loss=0.2)
    assert dynamic_stiffness_ratio(layer, frequency=[1.0, 20e3]) == approx(np.array([3 + 0.6j, 3 + 0.6j]))


def test_waves_make_a_slow_layer_static_and_a_thick_one_endless() -> None:
    slow = SoftLayer(body=FELT, layer_thickness=2e-3, layer_loss=0.3, layer_density=250.0)
    assert complex(dynamic_stiffness_ratio(slow, frequency=0.01)) == approx(1 + 0.3j, rel=1e-6)
    thick = SoftLayer(body=FELT, layer_thickness=0.2, layer_loss=0.3, layer_density=250.0)
    omega, modulus = 2 * np.pi * 20e3, oedometric_modulus(FELT)
    endless = 1j * omega * np.sqrt(250.0 * modulus * (1 + 0.3j)) * 0.2 / modulus
    assert complex(dynamic_stiffness_ratio(thick, frequency=20e3)) == approx(complex(endless), rel=1e-6)


def test_waves_between_face_and_base_are_those_of_a_chain_of_masses_and_springs() -> None:
    layer = SoftLayer(body=FELT, layer_thickness=2e-3, layer_loss=0.3, layer_density=250.0)
    omega, modulus, n = 2 * np.pi * 20e3, oedometric_modulus(FELT) * (1 + 0.3j), 2000
    k, m = modulus * n / 2e-3, 250.0 * 2e-3 / n
    stiffness = k  # of the last spring on the base; masses are added from there to the face
    for _ in range(n - 1):
        stiffness = 1 / (1 / k + 1 / (stiffness - m * omega**2))
    chain = (stiffness - m * omega**2 / 2) * 2e-3 / oedometric_modulus(FELT)
    assert complex(dynamic_stiffness_ratio(layer, frequency=20e3)) == approx(complex(chain), rel=1e-4)


def test_the_heat_of_the_loss_is_the_area_of_the_loop_of_force_and_deformation() -> None:
    layer = SoftLayer(body=FELT, layer_thickness=2e-3, dynamic_modulus_ratio=2.0, layer_loss=0.3)
    k, a = layer_normal_stiffness(layer, face_radius=5e-3), 2e-6
    t = np.linspace(0, 2 * np.pi, 4001)
    force = np.real(2 * (1 + 0.3j) * k * a * np.exp(1j * t))
    loop = -np.trapezoid(force, a * np.cos(t)) * -1
    power = layer_loss_power(layer, face_radius=5e-3, vibration_amplitude=a, frequency=20e3)
    assert power == approx(abs(loop) * 20e3, rel=1e-6)


def test_as_many_moduli_as_times_are_required() -> None:
    with raises(InvalidInput, match="one entry per element, got 1 and 0"):
        PronySeries(relaxed_modulus=1e6, relaxation_modulus=(1e6,), relaxation_time=())
