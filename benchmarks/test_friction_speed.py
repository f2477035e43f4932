"""Speed of the vibrating cube, beside a quadrature of every point by itself."""

import timeit

import numpy as np
from pytest_benchmark.fixture import BenchmarkFixture
from scipy.integrate import quad

from sonolube.models.contact import ASPERITY_LAWS, ContactPair, RoughContact, separation
from sonolube.models.friction import (
    DahlFriction,
    dahl_friction_history,
    dahl_under_vibration,
    dong_2015_half_period_ratio,
)
from sonolube.models.surfaces import Roughness
from sonolube.models.wear import vibrating_cube_wear_rate

POINTS = 1_000_000
CONTACT = RoughContact(
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
DECAY_LENGTH = 2e-6


def loads_and_amplitudes(points: int) -> dict[str, np.ndarray]:
    random = np.random.default_rng(1)
    return {"normal_load": random.uniform(1.0, 10.0, points), "vibration_amplitude": random.uniform(0.0, 5e-6, points)}


def seconds_a_point(benchmark: BenchmarkFixture, points: int) -> float:
    # without statistics, as under --benchmark-disable, there is nothing to report
    return benchmark.stats.stats.median / points if benchmark.stats else float("nan")


def quad_seconds_a_point(power: float, sample: int = 200) -> float:
    """Time scipy's adaptive quadrature of the same mean, its integrand in plain floats, as favourable as can be."""
    from math import exp, sin

    drawn = loads_and_amplitudes(sample)
    gaps = separation(CONTACT, normal_load=drawn["normal_load"]).tolist()

    def each() -> None:
        for d, a in zip(gaps, drawn["vibration_amplitude"].tolist(), strict=True):

            def value(theta: float, d: float = d, a: float = a) -> float:
                x = a * sin(theta)
                return exp(-power * x / DECAY_LENGTH) * (1 + x / d) ** -3

            quad(value, 0, np.pi, epsrel=1e-10)

    return min(timeit.repeat(each, number=1, repeat=3)) / sample


def test_a_million_friction_ratios(benchmark: BenchmarkFixture) -> None:
    points = loads_and_amplitudes(POINTS)
    ratios = benchmark(dong_2015_half_period_ratio, CONTACT, **points)
    assert ratios.shape == (POINTS,)
    ours, rival = seconds_a_point(benchmark, POINTS), quad_seconds_a_point(2.0)
    benchmark.extra_info |= {
        "us_a_point": 1e6 * ours,
        "scipy_quad_us_a_point": 1e6 * rival,
        "speed_ratio": rival / ours,
    }


def test_a_million_wear_rates(benchmark: BenchmarkFixture) -> None:
    points = loads_and_amplitudes(POINTS)
    rates = benchmark(vibrating_cube_wear_rate, CONTACT, **points)
    assert rates.shape == (POINTS,)
    ours, rival = seconds_a_point(benchmark, POINTS), quad_seconds_a_point(1.0)
    benchmark.extra_info |= {
        "us_a_point": 1e6 * ours,
        "scipy_quad_us_a_point": 1e6 * rival,
        "speed_ratio": rival / ours,
    }


def test_one_friction_ratio(benchmark: BenchmarkFixture) -> None:
    benchmark(dong_2015_half_period_ratio, CONTACT, normal_load=3.0, vibration_amplitude=2.5e-6)


def test_ten_thousand_steady_periods_of_dahls_law(benchmark: BenchmarkFixture) -> None:
    def sweep() -> np.ndarray:
        return dahl_under_vibration(
            CONTACT,
            separation=separation(CONTACT, normal_load=3.0),
            friction_coefficient=0.3,
            sliding_speed=np.linspace(0.01, 0.3, 10_000),
            frequency=22e3,
            in_plane_amplitude=1e-6,
            normal_amplitude=1e-6,
        )

    sweep()
    assert benchmark(sweep).shape == (10_000,)
    benchmark.extra_info["us_a_point"] = 1e6 * seconds_a_point(benchmark, 10_000)


def test_a_million_samples_of_a_history(benchmark: BenchmarkFixture) -> None:
    t = np.linspace(0, 1, POINTS)
    motion = {"time": t, "relative_velocity": 0.01 + 0.1 * np.cos(2 * np.pi * 1000 * t)}
    dahl = DahlFriction(contact_stiffness=1e6, coulomb_friction_force=1.0)

    def run() -> object:
        return dahl_friction_history(dahl, **motion)

    run()
    benchmark(run)
    benchmark.extra_info["ns_a_sample"] = 1e9 * seconds_a_point(benchmark, POINTS)
