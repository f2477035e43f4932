"""Methods of lubrication of a rig by hand: load shared by pressure, films of balls and pads, the map about a point."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.materials import material
from sonolube.models.friction import BoundaryLubricant, FilmLubricant, mixed_lubrication
from sonolube.rig import Rig, lubrication_map, lubrication_point, rig_from, wear_of_materials

FILE = """
title = "a"
source = "b"
[contact]
normal_load = "6 N"
nominal_area = "7 mm2"
decay_length = "2 um"
[contact.roughness]
rms_height = "0.6 um"
summit_radius = "10 um"
summit_density = "5e9 /m2"
[contact.pair]
effective_modulus = "80 GPa"
poisson_ratio = 0.3
yield_strength = "0.5 GPa"
[friction]
friction_coefficient = 0.4
model = "coulomb"
[sliding]
sliding_speed = "50 mm/s"
[drive]
frequency = "20 kHz"
[vibration]
vibration_amplitude = "1.2 um"
direction = "along"
"""
PRESSURE = 6 / 7e-6
PEAK = 2 * np.pi * 20e3 * 1.2e-6  # m/s, of the vibration
OIL = BoundaryLubricant(film_coefficient=0.02, full_asperity_pressure=4e6)


def known(text: str = FILE) -> Rig:
    return rig_from(tomllib.loads(text))


def ratio_of(speed: float) -> float:
    """Coulomb friction under a sine along the sliding over that without."""
    return float(2 / np.pi * np.arcsin(min(speed / PEAK, 1.0)))


def test_the_four_methods_share_the_load_by_the_pressure() -> None:
    # 857 kPa of 4 MPa: the asperities carry 3/14 of the load, and rub with 0.4, the film with 0.02
    found = lubrication_point(known(), lubricant=OIL)
    share, ratio = 3 / 14, ratio_of(0.05)
    film = (1 - share) * 0.02
    assert found.nominal_pressure == approx(PRESSURE)
    assert found.asperity_load_fraction == approx(share)
    assert found.film_coefficient == approx(0.02)
    assert tuple(found.coefficients) == approx((0.4, 0.4 * ratio, share * 0.4 + film, share * 0.4 * ratio + film))
    assert (found.film_thickness, found.film_ratio) == (None, None)
    assert (found.sliding_speed, found.friction_coefficient, found.friction_model) == (0.05, 0.4, "coulomb")
    assert found.vibration_amplitude == approx(1.2e-6)
    assert found.amplitude_source == "measured"
    assert any("load sharing in proportion to the pressure" in line for line in found.caveats)
    assert any("vibration along the sliding" in line for line in found.caveats)


@pytest.mark.parametrize(("gain", "best"), [(0.0, "combined"), (0.6, "combined"), (0.7, "lubricant")])
def test_vibration_has_to_be_worth_its_power(gain: float, best: str) -> None:
    # combined 0.034 of the 0.101 of the lubricant alone: a gain of 0.66
    assert lubrication_point(known(), lubricant=OIL, smallest_gain=gain).best == best


def test_the_map_reaches_a_decade_to_either_side_and_holds_the_least_of_the_four_methods() -> None:
    about = lubrication_map(known(), lubricant=OIL)
    assert about.sliding_speed[[0, 60, -1]] == approx([0.005, 0.05, 0.5])
    assert about.nominal_pressure[[0, 60, -1]] == approx(PRESSURE * np.array([0.1, 1.0, 10.0]))
    assert about.best.shape == (121, 121)
    ratios = np.array([ratio_of(speed) for speed in about.sliding_speed])
    shares = np.minimum(about.nominal_pressure / 4e6, 1.0)[:, np.newaxis]
    film = (1 - shares) * 0.02
    every = np.stack(np.broadcast_arrays(0.4 * ratios, shares * 0.4 * ratios + film, shares * 0.4 + film))
    names = np.array(["ultrasonic", "combined", "lubricant"])
    clear = np.sort(every, axis=0)[1] - every.min(axis=0) > 1e-9
    assert clear.mean() > 0.5
    assert np.array_equal(about.best[clear], names[every.argmin(axis=0)][clear])
    assert {"ultrasonic", "combined"} <= set(about.best.ravel().tolist())
    worth = lubrication_map(known(), lubricant=OIL, smallest_gain=0.7)
    assert worth.best[60, 60] == "lubricant"


@pytest.mark.parametrize("radius", [None, 5e-3])
def test_a_film_by_viscosity_carries_its_share_under_the_load_of_the_rig(radius: float | None) -> None:
    oil = FilmLubricant(dynamic_viscosity=5.0, tip_radius=radius)
    found = lubrication_point(known(), lubricant=oil)
    alone = mixed_lubrication(oil, known().contact, sliding_speed=0.05, normal_load=6.0)
    assert 0.01 < found.asperity_load_fraction < 0.99
    assert found.asperity_load_fraction == approx(float(alone.asperity_load_fraction))
    assert found.film_coefficient == approx(float(alone.film_coefficient))
    assert found.film_thickness == approx(float(alone.film_thickness))
    assert found.film_thickness is not None
    assert found.film_ratio == approx(found.film_thickness / 0.6e-6)


def test_a_flat_pad_is_said_to_have_an_upper_bound_of_a_film_and_a_ball_is_not() -> None:
    pad, ball = (
        lubrication_point(known(), lubricant=FilmLubricant(dynamic_viscosity=0.1, tip_radius=radius)).caveats
        for radius in (None, 5e-3)
    )
    assert any("a flat pad has the film of an endlessly wide one" in line for line in pad)
    assert not any("flat pad" in line for line in ball)
    for lines in (pad, ball):
        assert any("compared with no friction" in line for line in lines)
        assert any("the film is that without vibration" in line for line in lines)
        assert not any("in proportion to the pressure" in line for line in lines)


def test_a_map_by_viscosity_shares_each_load_at_each_speed() -> None:
    # at speeds below that of the vibration, where dry friction is never the least
    oil = FilmLubricant(dynamic_viscosity=5.0, tip_radius=5e-3)
    about = lubrication_map(known(), lubricant=oil)
    for row, column in ((0, 80), (120, 0), (30, 75), (90, 30), (60, 60)):
        speed, load = float(about.sliding_speed[column]), float(about.nominal_pressure[row]) * 7e-6
        mixed = mixed_lubrication(oil, known().contact, sliding_speed=speed, normal_load=load)
        share, film, ratio = float(mixed.asperity_load_fraction), float(mixed.film_coefficient), ratio_of(speed)
        rest = (1 - share) * film
        methods = {"ultrasonic": 0.4 * ratio, "combined": share * 0.4 * ratio + rest, "lubricant": share * 0.4 + rest}
        assert about.best[row, column] == min(methods, key=lambda name: methods[name])
    assert len(set(about.best.ravel().tolist())) > 1


def test_a_rig_at_rest_has_no_method() -> None:
    resting = known(FILE.replace("50 mm/s", "0 m/s"))
    for function in (lubrication_point, lubrication_map):
        with raises(InvalidInput, match=r"sliding_speed must be positive"):
            function(resting, lubricant=OIL)


def test_materials_wear_by_their_hardness_and_structure() -> None:
    # D Table 2.14: aluminium on steel is ploughed, and less under vibration; titanium on steel wears more under it
    soft, hexagonal, hard = (material(name) for name in ("aluminium_2024", "titanium_6al4v", "m50"))
    found = wear_of_materials(soft, hard)
    assert found.mechanism == "abrasive"
    assert found.vibration_effect == "less wear"
    ratio = hard.value("hardness") / soft.value("hardness")
    assert found.reasons[0].startswith(f"{hard.title} is {ratio:.2f} times as hard as {soft.title}")
    assert wear_of_materials(hard, soft).reasons[0] == found.reasons[0]
    with_titanium = wear_of_materials(hexagonal, hard)
    assert with_titanium.vibration_effect == "more wear"
    assert with_titanium.reasons[1].startswith(f"{hexagonal.title} is hexagonal close-packed")


def test_a_structure_that_the_rule_does_not_know_is_refused_by_name() -> None:
    body = material("m50")
    assert body.crystal_structure is not None
    odd = replace(body, crystal_structure=replace(body.crystal_structure, text="quasicrystal"))
    with raises(UnknownName, match="unknown crystal structure 'quasicrystal'"):
        wear_of_materials(odd, material("aluminium_2024"))
