"""Volume losses of ASTM G99 against integrals, and wear scars measured on synthetic balls."""

import math

import numpy as np
from pytest import approx, mark, raises
from scipy.integrate import quad

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, NoGroove
from sonolube.models.surfaces import HeightMap, disc_volume_loss, pin_volume_loss, wear_scar

RADIUS, PIXEL = 4e-3, 4e-6


def ball(scar_diameter: float, *, noise: float = 0.05e-6, missing: float = 0.05) -> HeightMap:
    x, y = np.meshgrid((np.arange(320) - 150) * PIXEL, (np.arange(240) - 130) * PIXEL)
    whole = np.sqrt(RADIUS**2 - x**2 - y**2) - RADIUS
    height: Floats = np.minimum(whole, math.sqrt(RADIUS**2 - scar_diameter**2 / 4) - RADIUS)
    rng = np.random.default_rng(0)
    height = height + noise * rng.standard_normal(height.shape)
    height[rng.random(height.shape) < missing] = np.nan
    return HeightMap(height=height, spacing_x=PIXEL, spacing_y=PIXEL)


def test_the_disc_volume_loss_is_the_circular_segment_times_the_length_of_the_track() -> None:
    width, r = 1.5e-3, 2e-3
    section, _ = quad(lambda s: math.sqrt(r**2 - s**2) - math.sqrt(r**2 - width**2 / 4), -width / 2, width / 2)
    volume = disc_volume_loss(groove_diameter=50e-3, groove_width=width, tip_radius=r)
    assert volume == approx(math.pi * 50e-3 * section, rel=1e-9)


def test_the_pin_volume_loss_is_the_solid_of_revolution() -> None:
    d, r = 1.5e-3, 2e-3
    volume, _ = quad(lambda z: math.pi * (r**2 - z**2), math.sqrt(r**2 - d**2 / 4), r, epsabs=0, epsrel=1e-12)
    assert pin_volume_loss(scar_diameter=d, tip_radius=r) == approx(volume, rel=1e-9)


def test_the_volume_of_a_small_scar_has_no_cancellation() -> None:
    d, r = 1e-6, 5e-3
    assert pin_volume_loss(scar_diameter=d, tip_radius=r) == approx(math.pi * d**4 / (64 * r), rel=1e-7)


def test_a_hemisphere_is_the_largest_cap() -> None:
    assert pin_volume_loss(scar_diameter=2.0, tip_radius=1.0) == approx(2 / 3 * math.pi)
    with raises(InvalidInput, match=r"scar_diameter must not exceed the ball's diameter, got 2\.1 m"):
        pin_volume_loss(scar_diameter=2.1, tip_radius=1.0)


@mark.parametrize("known", [None, RADIUS])
def test_a_flat_on_a_ball_has_the_volume_of_the_missing_cap(known: float | None) -> None:
    scar = wear_scar(ball(0.4e-3), tip_radius=known)
    volume = float(pin_volume_loss(scar_diameter=0.4e-3, tip_radius=RADIUS))
    assert scar.tip_radius == approx(RADIUS, rel=1e-3)
    assert scar.wear_volume == approx(volume, abs=max(4 * scar.wear_volume_uncertainty, 2e-3 * volume))
    assert scar.scar_diameter == approx(0.4e-3, abs=0.5 * PIXEL)


@mark.parametrize("diameter", [0.15e-3, 0.4e-3, 0.6e-3])
@mark.parametrize("noise", [0.0, 5e-9, 50e-9, 200e-9])
def test_neither_noise_nor_smoothing_shifts_the_edge_of_a_flat(diameter: float, noise: float) -> None:
    assert wear_scar(ball(diameter, noise=noise)).scar_diameter == approx(diameter, abs=0.5 * PIXEL)


@mark.parametrize("noise", [0.0, 5e-9, 50e-9])
@mark.parametrize("wall", ["steep", "bowl", "ramp"])
def test_the_edge_of_a_scar_with_other_walls_is_found(wall: str, noise: float) -> None:
    diameter, depth = 0.4e-3, 1e-6
    unworn = ball(1e-9, noise=noise)
    x, y = np.meshgrid((np.arange(320) - 150) * PIXEL, (np.arange(240) - 130) * PIXEL)
    inwards = diameter / 2 - np.hypot(x, y)
    lost = {
        "steep": inwards > 0,
        "bowl": np.maximum(1 - 4 * (x**2 + y**2) / diameter**2, 0),
        "ramp": np.clip(inwards / (10 * PIXEL), 0, 1),
    }[wall]
    scar = wear_scar(unworn.with_height(unworn.height - depth * lost))
    assert scar.scar_diameter == approx(diameter, abs=PIXEL)


def test_an_unworn_ball_has_no_scar() -> None:
    with raises(NoGroove, match="no scar found"):
        wear_scar(ball(1e-9))


def test_a_concave_map_is_refused() -> None:
    dish = ball(0.4e-3)
    with raises(InvalidInput, match="the map is concave"):
        wear_scar(dish.with_height(-dish.height))
