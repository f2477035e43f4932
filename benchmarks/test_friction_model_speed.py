"""Speed of the friction closures at 16 sliding speeds, beside elements stepped through one by one."""

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactMotion,
    ContactPair,
    RoughContact,
    load_balanced_motion,
    sinusoidal_motion,
)
from sonolube.models.friction import FRICTION_MODELS, AsperityStickSlip, sine_stick_slip_ratio
from sonolube.models.surfaces import Roughness

CONTACT = RoughContact(
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
SPEEDS = np.geomspace(1e-3, 1.0, 16)
POINTS = 10_000


def motion(amplitude: float = 2.5e-6) -> ContactMotion:
    return load_balanced_motion(
        CONTACT, sinusoidal_motion(CONTACT, normal_load=3.0, vibration_amplitude=amplitude, frequency=22e3)
    )


def stepped(gap: np.ndarray, *, elements: int = 500, periods: int = 2) -> np.ndarray:
    """Return what the sampled stick-slip closure does, by first-order steps of numpy vectors: error about 1e-2."""
    touch = np.linspace(gap.min(), gap.max() + 20, elements)
    number = np.exp(-(touch - gap.min()))
    grown = SPEEDS[:, np.newaxis] / (22e3 * gap.size * 1.5e-6)
    force = np.maximum(touch - gap.max(), 0) * np.ones((SPEEDS.size, 1))
    friction, limits = np.zeros_like(force), np.zeros(elements)
    for period in range(periods):
        for x in gap:
            limit = np.maximum(touch - x, 0)
            force = np.minimum(force + grown, limit)
            if period == periods - 1:
                friction += force
                limits += limit
    return np.asarray(np.trapezoid(number * friction, touch) / np.trapezoid(number * limits, touch))


@pytest.mark.parametrize("name", [name for name in FRICTION_MODELS if not FRICTION_MODELS[name].for_soft_bodies])
def test_a_friction_model_at_sixteen_speeds(benchmark: BenchmarkFixture, name: str) -> None:
    model, one = FRICTION_MODELS[name](), motion()
    model.ratio(CONTACT, one, sliding_speed=SPEEDS, friction_coefficient=0.3)  # compiled outside the measurement
    benchmark(lambda: model.ratio(CONTACT, one, sliding_speed=SPEEDS, friction_coefficient=0.3))


def test_stick_slip_beside_elements_stepped_one_by_one(benchmark: BenchmarkFixture) -> None:
    gap = motion().displacement / 2e-6
    result = benchmark(lambda: stepped(gap))
    exact = AsperityStickSlip().ratio(CONTACT, motion(), sliding_speed=SPEEDS)
    assert np.max(np.abs(result - exact)) < 0.02


def test_stick_slip_of_sines_in_closed_form(benchmark: BenchmarkFixture) -> None:
    random = np.random.default_rng(1)
    drawn = {
        "vibration_amplitude": random.uniform(0.1e-6, 14e-6, POINTS),
        "sliding_speed": random.uniform(1e-3, 1.0, POINTS),
    }
    sine_stick_slip_ratio(decay_length=2e-6, frequency=22e3, vibration_amplitude=1e-6, sliding_speed=0.1)
    benchmark(lambda: sine_stick_slip_ratio(decay_length=2e-6, frequency=22e3, **drawn))
    benchmark.extra_info["points"] = POINTS
