"""Estimates of flow stress and drawing stress against integrations over the period."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.facts.published import statement
from sonolube.models.friction import (
    ZINC_STRESS_RATIO,
    acoustic_intensity,
    acoustic_softening_ratio,
    drawing_stress,
    parallel_vibration_ratio,
    reference_intensity_from_test,
    superposed_mean_stress,
    vibrated_drawing_stress,
)


@pytest.mark.parametrize("strain", [0.0, 1e-4, 1e-3, 1.3e-3, 5e-3, 0.1])
def test_the_mean_stress_is_that_of_a_stress_with_yielding_once_a_period(strain: float) -> None:
    # elastic-perfectly plastic, a tool in compression only, 70 GPa and 100 MPa
    theta = (np.arange(200_000) + 0.5) * 2 * np.pi / 200_000
    stress = np.maximum(100e6 - 70e9 * strain * (1 - np.cos(theta)), 0)
    found = superposed_mean_stress(yield_strength=100e6, youngs_modulus=70e9, strain_amplitude=strain)
    assert found == approx(stress.mean(), rel=1e-5)


@given(strain=st.floats(1e-6, 0.1))
def test_the_mean_stress_falls_with_the_amplitude(strain: float) -> None:
    small, large = superposed_mean_stress(
        yield_strength=100e6, youngs_modulus=70e9, strain_amplitude=[strain, 1.1 * strain]
    )
    assert 0 < large < small < 100e6


def test_the_intensity_is_that_of_a_travelling_wave() -> None:
    # 2700 kg/m3, 5000 m/s, 20 kHz and 5 um: 0.628 m/s peak, 13.5 MPa s/m
    found = acoustic_intensity(density=2700.0, wave_speed=5000.0, frequency=20e3, vibration_amplitude=5e-6)
    assert found == approx(2.665e6, rel=1e-3)


def test_the_reference_intensity_of_a_test_reproduces_the_test() -> None:
    reference = reference_intensity_from_test(stress_ratio=0.6, acoustic_intensity=1e4)
    assert acoustic_softening_ratio(acoustic_intensity=1e4, reference_intensity=reference) == approx(0.6)
    assert acoustic_softening_ratio(acoustic_intensity=4e4, reference_intensity=reference) == approx(0.2)
    assert acoustic_softening_ratio(acoustic_intensity=1e9, reference_intensity=reference) == 0


def test_the_stress_ratio_of_zinc_is_that_cited_from_blaha_and_langenecker() -> None:
    assert approx(1 - statement("2.4.1-blaha-force-reduction").number.value) == ZINC_STRESS_RATIO


def test_a_stress_ratio_of_one_gives_no_reference_intensity() -> None:
    with raises(InvalidInput, match="stress_ratio must be positive"):
        reference_intensity_from_test(stress_ratio=1.0, acoustic_intensity=1e4)


def slab_stress(
    *, ratio: float, strain: float = np.log(1.25), sections: int = 200, signs: Floats | float = 1.0
) -> Floats:
    """Drawing stress over flow stress, slab by slab, at B = `ratio`; `signs` of friction by section, then by phase."""
    step = strain / sections
    stress = np.zeros(np.shape(np.atleast_2d(signs))[1:])
    for sign in np.broadcast_to(np.atleast_2d(signs), (sections, stress.size)):
        friction = ratio * sign
        for _ in range(4):  # midpoint steps of d(stress)/d(strain) = 1 + friction (1 - stress)
            half = stress + step / 8 * (1 + friction * (1 - stress))
            stress = stress + step / 4 * (1 + friction * (1 - half))
    return stress


DIE = {"area_reduction": 0.2, "friction_coefficient": 0.09, "die_half_angle": np.radians(6)}
B = 0.09 / np.tan(np.radians(6))


def test_the_drawing_stress_is_that_of_a_worked_example() -> None:
    # G. E. Dieter, Mechanical Metallurgy, example 19.1, by the FOSSEE textbook companion
    flow_stress = 1300e6 * np.log(1 / 0.8) ** 0.3 / 1.3  # K = 1300 MPa, n = 0.3
    assert drawing_stress(yield_strength=flow_stress, **DIE) == approx(240.422e6, rel=2e-6)


@given(r=st.floats(0.01, 0.5), mu=st.floats(0.001, 0.3), degrees=st.floats(3, 30))
def test_the_drawing_stress_is_in_equilibrium_slab_by_slab(r: float, mu: float, degrees: float) -> None:
    found = drawing_stress(
        yield_strength=1.0, area_reduction=r, friction_coefficient=mu, die_half_angle=np.radians(degrees)
    )
    by_slabs = slab_stress(ratio=mu / np.tan(np.radians(degrees)), strain=-np.log(1 - r), sections=100)
    assert found == approx(by_slabs[0], rel=1e-4)


def test_without_friction_the_drawing_stress_is_the_work_of_deformation() -> None:
    die = DIE | {"friction_coefficient": [0.0, 1e-14]}
    assert drawing_stress(yield_strength=3.0, **die) == approx(3 * np.log(1.25), rel=1e-12)


@pytest.mark.parametrize("speed", [0.01, 0.1, 0.5, 0.99, 1.0, 1.3])
def test_the_mean_drawing_stress_is_that_of_a_time_integration_and_bounds_that_of_a_wire_that_gets_faster(
    speed: float,
) -> None:
    die_velocity = np.cos((np.arange(2000) + 0.5) * 2 * np.pi / 2000)
    with_speed = {
        v: float(vibrated_drawing_stress(yield_strength=1.0, drawing_speed=v, vibration_velocity=1.0, **DIE))
        for v in (speed, 0.8 * speed)
    }
    uniform = slab_stress(ratio=B, signs=np.sign(speed - die_velocity)[np.newaxis]).mean()
    assert with_speed[speed] == approx(uniform, rel=5e-4)
    wire = 0.8 * speed * np.exp(np.log(1.25) * (np.arange(200) + 0.5) / 200)  # of constant flow
    faster = slab_stress(ratio=B, signs=np.sign(wire[:, np.newaxis] - die_velocity)).mean()
    assert with_speed[0.8 * speed] - 1e-4 <= faster <= with_speed[speed] + 1e-4


def test_from_the_critical_speed_on_vibration_does_not_change_the_drawing_stress() -> None:
    still = drawing_stress(yield_strength=1.0, **DIE)
    found = vibrated_drawing_stress(
        yield_strength=1.0, drawing_speed=[1.0, 1.01, 3.0, 0.5], vibration_velocity=[1.0, 1.0, 1.0, 0.0], **DIE
    )
    assert found == approx(float(still))


def test_slow_drawing_has_the_limit_of_friction_that_cancels() -> None:
    # half of the time with friction, half against it: 1 + sinh(B L)/B - cosh(B L)
    exponent = B * np.log(1.25)
    found = vibrated_drawing_stress(yield_strength=1.0, drawing_speed=1e-9, vibration_velocity=1.0, **DIE)
    assert found == approx(1 + np.sinh(exponent) / B - np.cosh(exponent), rel=1e-8)


@given(speed=st.floats(0.01, 2))
def test_with_little_friction_the_rise_by_friction_falls_by_the_arcsine(speed: float) -> None:
    die = DIE | {"friction_coefficient": 1e-5}
    still = float(drawing_stress(yield_strength=1.0, **die)) - np.log(1.25)
    moved = float(vibrated_drawing_stress(yield_strength=1.0, drawing_speed=speed, vibration_velocity=1.0, **die))
    ratio = parallel_vibration_ratio(sliding_speed=speed, vibration_velocity=1.0)
    assert (moved - np.log(1.25)) / still == approx(float(ratio), abs=1e-3)


def test_a_die_or_a_reduction_that_cannot_be_is_refused() -> None:
    with raises(InvalidInput, match="area_reduction must lie between 0 and 1, got 1"):
        drawing_stress(yield_strength=1.0, **DIE | {"area_reduction": 1.0})
    with raises(InvalidInput, match="die_half_angle must lie between"):
        drawing_stress(yield_strength=1.0, **DIE | {"die_half_angle": 6.0})
