"""One asperity: Hertz below the onset of yielding, and each law beyond it."""

import math

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises
from tests.same import same

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import (
    ASPERITY_LAWS,
    AsperityLaw,
    ContactPair,
    asperity_area,
    asperity_force,
    critical_interference,
)

STEEL = ContactPair(effective_modulus=110e9, poisson_ratio=0.3, yield_strength=400e6, mindlin_ratio=0.8)
RADIUS = 10e-6
LAWS = list(ASPERITY_LAWS.values())
YIELDING = [law for law in LAWS if law.name != "elastic"]


def pair(*, poisson_ratio: float, yield_strength: float = 400e6) -> ContactPair:
    return ContactPair(
        effective_modulus=110e9, poisson_ratio=poisson_ratio, yield_strength=yield_strength, mindlin_ratio=0.8
    )


def onset(law: AsperityLaw, bodies: ContactPair = STEEL) -> float:
    return critical_interference(law, bodies, summit_radius=RADIUS)


def force(law: AsperityLaw, ratio: float, bodies: ContactPair = STEEL) -> float:
    interference = ratio * onset(law, bodies)
    return float(asperity_force(law, bodies, summit_radius=RADIUS, interference=interference))


def area(law: AsperityLaw, ratio: float, bodies: ContactPair = STEEL) -> float:
    interference = ratio * onset(law, bodies)
    return float(asperity_area(law, bodies, summit_radius=RADIUS, interference=interference))


def jumps(law: AsperityLaw, transition: float, bodies: ContactPair = STEEL) -> tuple[float, float]:
    below, above = transition * (1 - 1e-10), transition * (1 + 1e-10)
    return (
        force(law, above, bodies) / force(law, below, bodies) - 1,
        area(law, above, bodies) / area(law, below, bodies) - 1,
    )


@mark.parametrize("law", YIELDING, ids=lambda law: law.name)
@given(ratio=st.floats(1e-6, 0.999))
def test_below_the_onset_of_yielding_every_law_is_that_of_hertz(law: AsperityLaw, ratio: float) -> None:
    w = ratio * onset(law)
    assert force(law, ratio) == approx(4 / 3 * 110e9 * math.sqrt(RADIUS) * w**1.5, rel=1e-12, abs=0)
    assert area(law, ratio) == approx(math.pi * RADIUS * w, rel=1e-12, abs=0)


def test_the_critical_interference_is_the_hand_computed_one() -> None:
    # C_nu = 1.234 + 1.256 * 0.3 = 1.6108; (pi * 1.6108 * 400 MPa / 220 GPa)^2 * 10 um = 0.84651 nm
    assert onset(ASPERITY_LAWS["chang_etsion_bogy"]) == approx(0.84651e-9, rel=1e-4, abs=0)


NU, Y, E_STAR = 0.3, 400e6, 110e9
PUBLISHED_ONSETS = {
    # over R: Chang, Etsion and Bogy 1987, (pi K H/2E)^2 with K = 0.6 and H = 2.8 Y
    "chang_etsion_bogy_1987": (math.pi * 0.6 * 2.8 * Y / (2 * E_STAR)) ** 2,
    # Kogut and Etsion 2002, the same with K = 0.454 + 0.41 nu
    "kogut_etsion": (math.pi * (0.454 + 0.41 * NU) * 2.8 * Y / (2 * E_STAR)) ** 2,
    # Jackson and Green 2005, (pi C S_y/2E')^2 with C = 1.295 exp(0.736 nu)
    "jackson_green": (math.pi * 1.295 * math.exp(0.736 * NU) * Y / (2 * E_STAR)) ** 2,
    # Brizmer, Kligerman and Etsion 2006, [pi/2 C_nu (1 - nu^2) Y/E]^2 of a sphere of modulus E on a rigid flat
    "chang_etsion_bogy": (math.pi / 2 * (1.234 + 1.256 * NU) * (1 - NU**2) * Y / (E_STAR * (1 - NU**2))) ** 2,
    # D 3.1 as printed, the same over E* of both bodies
    "dong_2015": (math.pi / 2 * (1.234 + 1.256 * NU) * (1 - NU**2) * Y / E_STAR) ** 2,
}


@mark.parametrize("law", YIELDING, ids=lambda law: law.name)
def test_the_critical_interference_of_each_law_is_that_of_its_own_publication(law: AsperityLaw) -> None:
    assert onset(law) == approx(PUBLISHED_ONSETS[law.name] * RADIUS, rel=1e-12, abs=0)


@given(poisson_ratio=st.floats(0.2, 0.45))
def test_onsets_that_depend_on_poissons_ratio_are_those_of_von_mises_on_the_axis_of_hertz(poisson_ratio: float) -> None:
    # stresses on the axis at the depth z a over the peak pressure, Johnson, Contact Mechanics (1985), 3.45
    z = np.linspace(0.05, 1.5, 3000)
    radial = -(1 + poisson_ratio) * (1 - z * np.arctan(1 / z)) + 1 / (2 * (1 + z**2))
    axial = -1 / (1 + z**2)
    coefficient = 1 / np.max(np.abs(radial - axial))
    bodies = pair(poisson_ratio=poisson_ratio)
    for name, error in (("jackson_green", 0.01), ("chang_etsion_bogy", 0.01), ("kogut_etsion", 0.025)):
        assert ASPERITY_LAWS[name].yield_pressure(bodies) == approx(coefficient * Y, rel=error), name


def test_the_onset_of_1987_has_no_poisson_ratio_and_meets_the_later_ones_at_0_356() -> None:
    early = ASPERITY_LAWS["chang_etsion_bogy_1987"]
    same(early.yield_pressure(pair(poisson_ratio=0.1)), early.yield_pressure(pair(poisson_ratio=0.45)))
    met = pair(poisson_ratio=0.356)
    for name in ("kogut_etsion", "chang_etsion_bogy"):
        assert ASPERITY_LAWS[name].yield_pressure(met) == approx(early.yield_pressure(met), rel=1e-3), name


def test_the_law_of_dong_2015_counts_the_poisson_factor_twice() -> None:
    published, corrected = ASPERITY_LAWS["dong_2015"], ASPERITY_LAWS["chang_etsion_bogy"]
    assert onset(published) == approx((1 - 0.3**2) ** 2 * onset(corrected), rel=1e-9, abs=0)
    assert published.yield_pressure(STEEL) == approx((1 - 0.3**2) * corrected.yield_pressure(STEEL))


@given(poisson_ratio=st.floats(0.2, 0.45))
def test_the_laws_agree_on_the_onset_of_yielding_within_six_percent(poisson_ratio: float) -> None:
    # three independent fits to the same von Mises calculation
    bodies = pair(poisson_ratio=poisson_ratio)
    onsets = [onset(ASPERITY_LAWS[name], bodies) for name in ("chang_etsion_bogy", "kogut_etsion", "jackson_green")]
    assert max(onsets) / min(onsets) < 1.06


@mark.parametrize("name", ["dong_2015", "chang_etsion_bogy", "chang_etsion_bogy_1987"])
def test_at_the_onset_of_yielding_the_mean_pressure_jumps_from_two_thirds_to_the_whole(name: str) -> None:
    law = ASPERITY_LAWS[name]
    pressure = law.yield_pressure(STEEL)
    assert force(law, 1 - 1e-10) / area(law, 1 - 1e-10) == approx(2 / 3 * pressure)
    assert force(law, 1 + 1e-10) / area(law, 1 + 1e-10) == approx(pressure)
    assert jumps(law, 1.0) == approx((0.5, 0.0), abs=1e-9)


@mark.parametrize("name", ["dong_2015", "chang_etsion_bogy", "chang_etsion_bogy_1987"])
def test_a_yielded_asperity_of_constant_volume_spreads_to_twice_the_geometric_section(name: str) -> None:
    law = ASPERITY_LAWS[name]
    w = 1e6 * onset(law)
    assert area(law, 1e6) == approx(2 * math.pi * RADIUS * w, rel=1e-6, abs=0)


@mark.parametrize(("transition", "in_force", "in_area"), [(1, 0.030, -0.070), (6, 0.017, 0.029), (110, 0.079, 0.071)])
def test_the_fits_of_kogut_and_etsion_are_discontinuous_at_their_breakpoints(
    transition: int, in_force: float, in_area: float
) -> None:
    assert jumps(ASPERITY_LAWS["kogut_etsion"], transition) == approx((in_force, in_area), abs=5e-4)


def test_kogut_and_etsion_end_in_full_plasticity_at_a_hardness_of_2_8_yield_strengths() -> None:
    law = ASPERITY_LAWS["kogut_etsion"]
    assert force(law, 500) / area(law, 500) == approx(2.8 * 400e6)
    assert area(law, 500) == approx(2 * math.pi * RADIUS * 500 * onset(law), rel=1e-9, abs=0)


@mark.parametrize(("poisson_ratio", "in_force"), [(0.2, 0.026), (0.3, 0.005), (0.45, -0.025)])
def test_the_fit_of_jackson_and_green_is_nearly_continuous_with_hertz(poisson_ratio: float, in_force: float) -> None:
    law = ASPERITY_LAWS["jackson_green"]
    assert jumps(law, 1.9, pair(poisson_ratio=poisson_ratio)) == approx((in_force, 0.0), abs=5e-4)


def test_the_hardness_of_jackson_and_green_falls_as_the_contact_grows() -> None:
    law = ASPERITY_LAWS["jackson_green"]
    pressures = [force(law, ratio) / area(law, ratio) for ratio in (200, 1000, 5000)]
    assert 2.84 * 400e6 > pressures[0] > pressures[1] > pressures[2]


def test_jackson_green_and_kogut_etsion_agree_within_a_tenth_where_both_were_fitted() -> None:
    # two independent finite-element studies of the same sphere, compared at one interference
    green, kogut = ASPERITY_LAWS["jackson_green"], ASPERITY_LAWS["kogut_etsion"]
    w = np.geomspace(1, 100, 20) * onset(kogut)
    for quantity in (asperity_force, asperity_area):
        values = [quantity(law, STEEL, summit_radius=RADIUS, interference=w) for law in (green, kogut)]
        assert values[0] == approx(values[1], rel=0.1, abs=0)


@mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_bodies_without_yielding_follow_hertz_at_any_interference(law: AsperityLaw) -> None:
    bodies = pair(poisson_ratio=0.3, yield_strength=math.inf)
    w = np.array([0.0, 1e-9, 1e-3])
    assert critical_interference(law, bodies, summit_radius=RADIUS) == math.inf
    assert asperity_force(law, bodies, summit_radius=RADIUS, interference=w) == approx(
        4 / 3 * 110e9 * math.sqrt(RADIUS) * w**1.5, rel=1e-9, abs=0
    )
    assert asperity_area(law, bodies, summit_radius=RADIUS, interference=w) == approx(
        math.pi * RADIUS * w, rel=1e-9, abs=0
    )


@mark.parametrize("name", ASPERITY_LAWS)
def test_the_table_names_each_law_by_its_own_name(name: str) -> None:
    assert ASPERITY_LAWS[name].name == name


def test_a_negative_interference_is_refused() -> None:
    with raises(InvalidInput, match=r"interference must not be negative, got -1e-09 m"):
        asperity_force(ASPERITY_LAWS["elastic"], STEEL, summit_radius=RADIUS, interference=-1e-9)


def test_a_summit_radius_of_zero_is_refused() -> None:
    with raises(InvalidInput, match=r"summit_radius must be positive, got 0\.0 m"):
        critical_interference(ASPERITY_LAWS["chang_etsion_bogy"], STEEL, summit_radius=0.0)


def test_jackson_green_refuses_yield_strengths_above_0_05_of_the_modulus() -> None:
    with raises(OutsideRange, match=r"up to 0\.05 E\*, got 0\.0909 E\*"):
        force(ASPERITY_LAWS["jackson_green"], 10.0, pair(poisson_ratio=0.3, yield_strength=10e9))
