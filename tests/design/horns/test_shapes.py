"""Default sizes of horns by the wavelength, ends by the gain, and what is refused, by hand."""

from math import atan, hypot, log, pi, tan
from typing import Any

import pytest
from pytest import approx, raises

from sonolube.design.horns.shapes import TunableBody, body_from_geometry, horn_body
from sonolube.errors import InvalidInput, UnknownName

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

# 5 km/s at 20 kHz: a wavelength of 250 mm, a radius of 8 % of it, 20 mm
WAVE = {"frequency": 20e3, "wave_speed": 5e3}


def made(shape: str, *, tune: str = "length", gain: float | None = None, **sizes: float) -> TunableBody:
    return horn_body(shape, sizes=sizes, tune=tune, gain=gain, **WAVE)


@pytest.mark.parametrize(
    ("shape", "axis", "expected"),
    [
        ("block", "x", {"width": 60.96e-3, "thickness": 25.4e-3}),  # D 2.1.3
        ("cylinder", "z", {"radius": 20e-3}),
        ("conical_horn", "z", {"radius": 20e-3, "end_radius": 10e-3}),
        ("exponential_horn", "z", {"radius": 20e-3, "end_radius": 10e-3}),
        # a step at a quarter of the wavelength, its fillet half of its 10 mm
        ("stepped_horn", "z", {"radius": 20e-3, "end_radius": 10e-3, "end_length": 62.5e-3, "edge_radius": 5e-3}),
        (
            "booster",
            "z",
            {
                **{"radius": 20e-3, "end_radius": 16e-3, "end_length": 62.5e-3},
                **{"flange_radius": 26e-3, "flange_thickness": 5e-3},
            },
        ),
    ],
)
def test_sizes_that_nobody_gives_follow_from_the_wavelength(shape: str, axis: str, expected: dict[str, float]) -> None:
    body = made(shape)
    assert body.sizes == approx(expected)
    assert (body.name, body.axis, body.tuned_size) == (shape, axis, "length")
    assert body.thin is not None
    assert body.length == approx(body.thin.length)


def test_a_bar_without_taper_is_half_a_wavelength_long() -> None:
    for shape in ("block", "cylinder"):
        thin = made(shape).thin
        assert thin is not None
        assert (thin.length, thin.displacement_gain) == approx((0.125, 1.0))


def test_a_stepped_horn_without_a_size_is_two_quarters_of_a_wavelength_with_the_gain_of_its_areas() -> None:
    thin = made("stepped_horn").thin
    assert thin is not None
    assert (thin.length, thin.displacement_gain) == approx((0.0625, 4.0))


def test_a_given_radius_sets_the_others_and_a_given_end_the_step() -> None:
    horn = made("stepped_horn", radius=0.03)
    assert horn.sizes == approx({"radius": 0.03, "end_radius": 0.015, "end_length": 0.0625, "edge_radius": 0.0075})
    assert made("stepped_horn", end_radius=0.014).sizes["edge_radius"] == approx(0.003)
    assert made("stepped_horn", end_radius=0.02).sizes["edge_radius"] == 0.0
    assert made("stepped_horn", edge_radius=0.001).sizes["edge_radius"] == 0.001
    booster = made("booster", radius=0.01).sizes
    assert (booster["end_radius"], booster["flange_radius"]) == approx((0.008, 0.013))


def test_a_given_length_is_where_the_search_begins() -> None:
    assert made("cylinder", length=0.1).length == 0.1
    assert "length" not in made("cylinder", length=0.1).sizes


def test_another_size_is_tuned_at_the_length_of_the_thin_bar_which_has_no_solution_for_it() -> None:
    horn = made("stepped_horn", tune="end_length", end_length=0.05)
    assert (horn.length, horn.tuned_size, horn.thin) == (0.05, "end_length", None)
    assert set(horn.sizes) == {"radius", "end_radius", "edge_radius", "length"}
    # tan kL + tan(kL_1)/4 = 0 with kL_1 = 2 pi 50/250
    k = 2 * pi / 0.25
    assert horn.sizes["length"] == approx((pi - atan(tan(k * 0.05) / 4)) / k)
    assert made("stepped_horn", tune="end_length").length == approx(0.0625)
    solid = made("cylinder", tune="radius", radius=0.01).geometry_at(0.012)
    assert solid.volume == approx(pi * 0.012**2 * 0.125, rel=1e-6)


def test_an_exponential_end_has_the_radius_over_the_gain() -> None:
    body = made("exponential_horn", gain=3.0)
    assert body.sizes["end_radius"] == approx(0.02 / 3)
    assert body.length == approx(hypot(pi, log(3)) / (2 * pi) * 0.25)
    assert made("exponential_horn", gain=2.5, radius=0.03).sizes["end_radius"] == approx(0.012)
    assert made("exponential_horn", gain=1.0).sizes["end_radius"] == approx(0.02)
    assert made("exponential_horn", gain=10.0).sizes["end_radius"] == approx(0.002)  # a tenth of the radius


def test_the_end_of_a_step_at_a_quarter_wave_has_the_radius_over_the_root_of_the_gain() -> None:
    assert made("stepped_horn", gain=9.0).sizes["end_radius"] == approx(0.02 / 3)


@pytest.mark.parametrize("shape", ["conical_horn", "booster"])
def test_the_thin_bar_has_the_gain_that_its_end_was_chosen_by(shape: str) -> None:
    body = made(shape, gain=1.9)
    assert body.thin is not None
    assert body.thin.displacement_gain == approx(1.9)


@pytest.mark.parametrize(
    ("shape", "options", "message"),
    [
        ("exponential_horn", {"gain": 10.5}, "gain 10.5: a exponential_horn has 1 to 10 for ends of 10% of its radius"),
        ("exponential_horn", {"gain": 0.99}, "gain 0.99: a exponential_horn has 1 to 10"),
        ("exponential_horn", {"gain": 2.0, "end_radius": 0.01}, "gain 2: is chosen by end_radius; give one of them"),
        ("cylinder", {"gain": 2.0}, "gain 2: cylinder has only gain 1"),
        ("block", {"gain": 2.0}, "gain 2: block has only gain 1"),
    ],
)
def test_a_gain_that_no_end_has_is_refused(shape: str, options: dict[str, Any], message: str) -> None:
    with raises(InvalidInput) as refusal:
        made(shape, **options)
    assert message in str(refusal.value)


def test_unknown_shapes_and_sizes_are_refused_with_those_that_are_near() -> None:
    with raises(UnknownName, match=r"unknown horn 'conical'; did you mean conical_horn\?"):
        made("conical")
    with raises(UnknownName, match=r"unknown size of a cylinder 'radus'; did you mean radius\?"):
        made("cylinder", radus=0.01)
    with raises(UnknownName, match="unknown size of a cylinder 'end_radius'"):
        made("cylinder", tune="end_radius")
    with raises(UnknownName, match="unknown size of a block 'slots'"):
        made("block", slots=1.0)


def test_a_solid_from_a_file_has_its_extent_along_its_axis_as_its_length() -> None:
    solid = made("block", width=0.03, thickness=0.02, length=0.1).geometry_at(0.1)
    body = body_from_geometry(solid, axis="x")
    assert (body.axis, body.sizes, body.thin) == ("x", {}, None)
    assert body.name == solid.regions[0]
    assert body.length == approx(0.1)
    assert body_from_geometry(solid, axis="y").length == approx(0.03)
    assert body.geometry_at(0.12).volume == approx(0.03 * 0.02 * 0.12, rel=1e-6)
