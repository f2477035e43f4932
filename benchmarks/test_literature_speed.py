"""A million evaluations of each closed form of the literature's friction under vibration."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from sonolube.models.friction import (
    Holder,
    SpringContact,
    approximate_guided_ratio,
    approximate_longitudinal_ratio,
    approximate_normal_ratio,
    approximate_transverse_ratio,
    critical_speed,
    elliptical_traction_ratio,
    longitudinal_oscillation_ratio,
    longitudinal_static_ratio,
    normal_oscillation_ratio,
    normal_static_ratio,
    oblique_vibration_ratio,
    parallel_vibration_ratio,
    transverse_static_ratio,
    transverse_vibration_ratio,
)

POINTS = 1_000_000
CONTACT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
HEAVY = Holder(holder_stiffness=1e5, holder_mass=0.01)
RANDOM = np.random.default_rng(1)
SPEED = RANDOM.uniform(1e-3, 0.2, POINTS)
AMPLITUDE = RANDOM.uniform(0.05e-6, 2e-6, POINTS)
VELOCITY = RANDOM.uniform(0.01, 0.5, POINTS)
ANGLE = RANDOM.uniform(0, np.pi, POINTS)
PARALLEL: dict[str, Any] = {"sliding_speed": SPEED, "vibration_velocity": VELOCITY}
SPRINGS: dict[str, Any] = {"approach": 1e-6, "frequency": 20e3, "sliding_speed": SPEED}
NORMAL: dict[str, Any] = {"approach": 1e-6, "normal_amplitude": AMPLITUDE / 2}

MODELS: dict[str, Callable[[], object]] = {
    "parallel": lambda: parallel_vibration_ratio(**PARALLEL),
    "transverse": lambda: transverse_vibration_ratio(**PARALLEL),
    "oblique": lambda: oblique_vibration_ratio(**PARALLEL, vibration_direction=ANGLE),
    "longitudinal approximation": lambda: approximate_longitudinal_ratio(
        CONTACT, **SPRINGS, in_plane_amplitude=AMPLITUDE / 4
    ),
    "transverse approximation": lambda: approximate_transverse_ratio(
        CONTACT, approach=1e-6, frequency=20e3, sliding_speed=0.1 + SPEED, transverse_amplitude=AMPLITUDE
    ),
    "longitudinal static": lambda: longitudinal_static_ratio(CONTACT, approach=1e-6, in_plane_amplitude=AMPLITUDE),
    "transverse static": lambda: transverse_static_ratio(CONTACT, approach=1e-6, transverse_amplitude=AMPLITUDE),
    "guided approximation": lambda: approximate_guided_ratio(
        CONTACT, HEAVY, **SPRINGS, normal_stiffness=1e6, normal_amplitude=AMPLITUDE / 2
    ),
    "critical_speed": lambda: critical_speed(CONTACT, frequency=20e3, normal_amplitude=AMPLITUDE),
    "normal_static_ratio": lambda: normal_static_ratio(CONTACT, **NORMAL),
    "approximation": lambda: approximate_normal_ratio(CONTACT, **NORMAL, velocity_ratio=VELOCITY),
    "normal": lambda: normal_oscillation_ratio(CONTACT, **SPRINGS, normal_amplitude=AMPLITUDE),
    "longitudinal": lambda: longitudinal_oscillation_ratio(CONTACT, **SPRINGS, in_plane_amplitude=AMPLITUDE),
    "elliptical": lambda: elliptical_traction_ratio(
        normal_load=VELOCITY,
        normal_stiffness=1e6,
        normal_amplitude=AMPLITUDE,
        in_plane_amplitude=1e-6,
        frequency=20e3,
        relative_velocity=SPEED,
    ),
}


@pytest.mark.parametrize("name", MODELS)
def test_a_million_points_of_a_closed_form(benchmark: BenchmarkFixture, name: str) -> None:
    MODELS[name]()  # compiled outside the measurement
    benchmark(MODELS[name])
    benchmark.extra_info["points"] = POINTS
