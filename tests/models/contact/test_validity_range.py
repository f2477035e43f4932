"""Validity range of exponential heights, and caveats of rough contacts."""

from dataclasses import replace

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactPair,
    ExponentialHeights,
    GaussianHeights,
    RoughContact,
    contact_caveats,
    exponential_validity_range,
    normal_force,
    separation,
)
from sonolube.models.surfaces import Roughness

PAIR = ContactPair(effective_modulus=59.57e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8)
TYPICAL = RoughContact(
    roughness=Roughness(rms_height=0.5e-6, summit_radius=20e-6, summit_density=5e9),
    pair=PAIR,
    nominal_area=1e-4,
    asperity=ASPERITY_LAWS["dong_2015"],
)
PUBLISHED = RoughContact(
    roughness=Roughness(rms_height=6e-6, summit_radius=1.7e-6, summit_density=47e9),
    pair=PAIR,
    nominal_area=1e-4,
    asperity=ASPERITY_LAWS["dong_2015"],
)


def with_roughness_parameter(beta: float) -> RoughContact:
    return replace(TYPICAL, roughness=replace(TYPICAL.roughness, summit_density=beta / (0.5e-6 * 20e-6)))


@given(beta=st.floats(0.04, 0.6), factor=st.floats(1.1, 4), fraction=st.floats(0, 1))
def test_within_the_validity_range_both_height_distributions_give_similar_loads(
    beta: float, factor: float, fraction: float
) -> None:
    contact = with_roughness_parameter(beta)
    valid = exponential_validity_range(contact, factor=factor)
    if valid is None:
        return
    d = (valid[0] + fraction * (valid[1] - valid[0])) * 0.5e-6
    gaussian = replace(contact, heights=GaussianHeights.from_roughness_parameter(roughness_parameter=beta))
    ratio = float(normal_force(gaussian, separation=d) / normal_force(contact, separation=d))
    assert 1 / factor * (1 - 1e-9) <= ratio <= factor * (1 + 1e-9)


@mark.parametrize("beta", [0.05, 0.1, 0.48])
def test_the_validity_range_ends_where_the_loads_differ_by_the_factor(beta: float) -> None:
    contact = with_roughness_parameter(beta)
    valid = exponential_validity_range(contact)
    assert valid is not None
    gaussian = replace(contact, heights=GaussianHeights.from_roughness_parameter(roughness_parameter=beta))
    d = np.array(valid) * 0.5e-6
    ratios = normal_force(gaussian, separation=d) / normal_force(contact, separation=d)
    assert ratios == approx([0.5, 0.5], rel=1e-6)


def test_the_validity_range_of_exponential_heights_widens_with_the_roughness_parameter() -> None:
    ranges = [exponential_validity_range(with_roughness_parameter(beta)) for beta in (0.04, 0.05, 0.1)]
    widths = [valid[1] - valid[0] for valid in ranges if valid]
    assert len(widths) == 3
    assert widths == sorted(widths)


def test_a_larger_factor_never_narrows_the_validity_range() -> None:
    ranges = [exponential_validity_range(TYPICAL, factor=factor) for factor in (2.0, 30.0, 1e4, 1e12, 1e80)]
    found = np.array([valid for valid in ranges if valid is not None])
    assert len(found) == 5
    assert np.all(np.diff(found[:, 0]) <= 0)
    assert np.all(np.diff(found[:, 1]) >= 0)
    beta = TYPICAL.roughness.roughness_parameter
    deviation = GaussianHeights.from_roughness_parameter(roughness_parameter=beta).standard_deviation
    assert found[-1] / deviation == approx([-6.0, 20.0], rel=0.01)  # all that is compared


@mark.parametrize("beta", [0.015, 0.03])
def test_smooth_surfaces_have_no_validity_range(beta: float) -> None:
    assert exponential_validity_range(with_roughness_parameter(beta)) is None


def test_a_contact_with_gaussian_heights_is_compared_with_the_default_exponential_heights() -> None:
    same(exponential_validity_range(replace(TYPICAL, heights=GaussianHeights())), exponential_validity_range(TYPICAL))


def test_a_factor_of_one_is_refused() -> None:
    with raises(InvalidInput, match=r"factor must exceed 1, got 1\.0"):
        exponential_validity_range(TYPICAL, factor=1.0)


def test_a_typical_surface_under_a_typical_load_has_no_caveats() -> None:
    assert contact_caveats(TYPICAL, separation=separation(TYPICAL, normal_load=[5.0, 40.0])) == ()


def test_the_published_surface_raises_a_caveat_for_its_roughness_parameter_alone() -> None:
    (caveat,) = contact_caveats(PUBLISHED, separation=separation(PUBLISHED, normal_load=40.0))
    assert caveat.startswith("roughness parameter 0.479 lies outside the typical range 0.02 to 0.1")


def test_mean_planes_that_touch_raise_a_caveat() -> None:
    # the published model at 200 V peak to peak moves by more than its separation
    d = separation(PUBLISHED, normal_load=40.0).item() - 18.2e-6
    caveats = contact_caveats(PUBLISHED, separation=[d, 20e-6])
    assert any("is not positive: the mean planes touch" in caveat for caveat in caveats)
    assert any("real area is" in caveat for caveat in caveats)


def test_separations_outside_the_validity_range_recommend_gaussian_heights() -> None:
    caveats = contact_caveats(TYPICAL, separation=[1e-6, 3e-6])
    (caveat,) = (caveat for caveat in caveats if "height" in caveat)
    assert caveat.startswith("separation over rms height is 2.00 to 6.00;")
    assert caveat.endswith("use gaussian heights")
    gaussian = replace(TYPICAL, heights=GaussianHeights())
    assert not any("gaussian" in caveat for caveat in contact_caveats(gaussian, separation=[1e-6, 3e-6]))


def test_a_surface_without_a_validity_range_raises_a_caveat_at_every_separation() -> None:
    caveats = contact_caveats(with_roughness_parameter(0.03), separation=1e-6)
    assert any("at no separation within a factor of 2" in caveat for caveat in caveats)


def test_too_few_contacts_for_a_mean_raise_a_caveat() -> None:
    (caveat,) = contact_caveats(replace(TYPICAL, nominal_area=1e-9), separation=1e-6)
    assert caveat.startswith("less than one asperity, 0.07 in the mean, is in contact on the nominal 0.001 mm2")
    (few,) = contact_caveats(replace(TYPICAL, nominal_area=1e-7), separation=1e-6)  # of a hundred times the area
    assert few.startswith("only 7 asperities are in contact on the nominal 0.1 mm2")


def test_a_steeper_exponential_distribution_has_its_own_validity_range() -> None:
    steep = replace(PUBLISHED, heights=ExponentialHeights(amplitude=1e3, decay=5.0))
    valid, typical = exponential_validity_range(steep), exponential_validity_range(PUBLISHED)
    assert valid is not None
    assert typical is not None
    assert valid[0] > typical[0]


def test_a_decay_length_that_is_known_itself_is_no_fit_to_gaussian_heights() -> None:
    smooth = replace(TYPICAL, decay_length=0.05e-6)
    far = separation(smooth, normal_load=1e-6)
    assert [each for each in contact_caveats(smooth, separation=far) if "gaussian" in each] == []
    same(exponential_validity_range(smooth), exponential_validity_range(TYPICAL))
