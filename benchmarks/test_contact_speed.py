"""A million separations, areas and stiffnesses, beside adaptive quadrature and bracketing per point."""

from dataclasses import replace

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture
from scipy.integrate import quad
from scipy.optimize import brentq

from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactPair,
    ExponentialHeights,
    GaussianHeights,
    HeightDistribution,
    RoughContact,
    asperity_force,
    normal_force,
    normal_stiffness,
    real_contact_area,
    separation,
)
from sonolube.models.surfaces import Roughness

CONTACT = RoughContact(
    roughness=Roughness(rms_height=0.1e-6, summit_radius=100e-6, summit_density=4.76e9),
    pair=ContactPair(effective_modulus=59.57e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=1e-4,
    asperity=ASPERITY_LAWS["dong_2015"],
)
LOADS = np.random.default_rng(1).uniform(1.0, 240.0, 1_000_000)
SAMPLE = LOADS[:5]


def solve_all(contact: RoughContact, loads: np.ndarray) -> None:
    d = separation(contact, normal_load=loads)
    real_contact_area(contact, separation=d)
    normal_stiffness(contact, separation=d)


def solve_one_by_one(contact: RoughContact, loads: np.ndarray) -> None:
    deviation, radius = contact.roughness.rms_height, contact.roughness.summit_radius
    summits = contact.roughness.summit_density * contact.nominal_area

    def force(h: float) -> float:
        def integrand(w: float) -> float:
            one = asperity_force(contact.asperity, contact.pair, summit_radius=radius, interference=w * deviation)
            return float(one * np.exp(contact.heights.log_density(np.asarray(h + w))))

        return float(summits * quad(integrand, 0, 10, epsrel=1e-8, limit=200)[0])

    for load in loads:
        brentq(lambda h, wanted=load: np.log(force(h) / wanted), -1, 6, xtol=1e-8)


def record_per_point(benchmark: BenchmarkFixture, points: int) -> None:
    if benchmark.stats:
        benchmark.extra_info["seconds_per_point"] = benchmark.stats.stats.median / points


@pytest.mark.parametrize("heights", [ExponentialHeights(), GaussianHeights()], ids=lambda heights: heights.name)
@pytest.mark.parametrize("law", ["dong_2015", "jackson_green"])
def test_a_million_loads_at_once(benchmark: BenchmarkFixture, law: str, heights: HeightDistribution) -> None:
    contact = replace(CONTACT, heights=heights, asperity=ASPERITY_LAWS[law])
    normal_force(contact, separation=1e-7)
    benchmark.group = f"rough contact, {law}, {heights.name}"
    benchmark.pedantic(  # type: ignore[no-untyped-call]
        solve_all, args=(contact, LOADS), rounds=5, warmup_rounds=1
    )
    record_per_point(benchmark, LOADS.size)


@pytest.mark.filterwarnings("ignore::scipy.integrate.IntegrationWarning")
@pytest.mark.parametrize("heights", [ExponentialHeights(), GaussianHeights()], ids=lambda heights: heights.name)
@pytest.mark.parametrize("law", ["dong_2015", "jackson_green"])
def test_rival_quad_and_brentq(benchmark: BenchmarkFixture, law: str, heights: HeightDistribution) -> None:
    contact = replace(CONTACT, heights=heights, asperity=ASPERITY_LAWS[law])
    benchmark.group = f"rough contact, {law}, {heights.name}"
    benchmark.pedantic(  # type: ignore[no-untyped-call]
        solve_one_by_one, args=(contact, SAMPLE), rounds=1
    )
    record_per_point(benchmark, SAMPLE.size)


@pytest.mark.parametrize("law", ASPERITY_LAWS)
def test_the_first_gaussian_load_of_a_new_contact(benchmark: BenchmarkFixture, law: str) -> None:
    areas = iter(np.linspace(1.1e-4, 2e-4, 1000))
    benchmark.group = "rough contact, building the table"

    def first() -> None:
        contact = replace(
            CONTACT, nominal_area=float(next(areas)), heights=GaussianHeights(), asperity=ASPERITY_LAWS[law]
        )
        separation(contact, normal_load=40.0)

    benchmark.pedantic(  # type: ignore[no-untyped-call]
        first, rounds=20
    )
