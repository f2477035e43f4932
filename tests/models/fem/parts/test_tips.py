"""Acorn nut and disc on a hub against the volumes of geometry."""

import numpy as np
import pytest
from pytest import approx, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.errors import InvalidInput
from sonolube.models.fem import acorn_nut, hub_disc


def test_an_acorn_nut_and_a_disc_on_a_hub_have_the_volume_of_their_formula() -> None:
    # hexagon and a spherical zone of heights 0 to h: pi h (R^2 - h^2/3)
    high = np.sqrt(5e-3**2 - 0.8e-3**2)
    nut = acorn_nut(width=11e-3, length=6e-3, tip_radius=5e-3, contact_radius=0.8e-3)
    assert nut.volume == approx(np.sqrt(3) / 2 * 11e-3**2 * 6e-3 + np.pi * high * (5e-3**2 - high**2 / 3), rel=1e-3)
    disc = hub_disc(hub_radius=4e-3, hub_length=5e-3, disc_radius=10e-3, thickness=1e-3)
    assert disc.volume == approx(np.pi * (4e-3**2 * 5e-3 + 10e-3**2 * 1e-3), rel=1e-4)


def test_impossible_tips_are_refused() -> None:
    with raises(InvalidInput, match="contact_radius, tip_radius and half the width must rise"):
        acorn_nut(width=5e-3, length=5e-3, tip_radius=5e-3, contact_radius=1e-3)
    with raises(InvalidInput, match="hub_radius must be below disc_radius"):
        hub_disc(hub_radius=1e-2, hub_length=1e-2, disc_radius=1e-2, thickness=1e-3)
