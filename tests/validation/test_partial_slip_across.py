"""Front. Mech. Eng. 6 (2020), doi:10.3389/fmech.2020.566440: boundary elements of a contact that oscillates sideways.

Its abstract: for a Hertzian contact the behaviour at small velocities is best described with partial slip.
"""

import numpy as np
import pytest
from pytest import approx

from sonolube.models.friction import SpringContact, combined_oscillation_ratio, transverse_static_ratio

SPHERE = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
DEPTH, SLIP, FREQUENCY = 1e-6, 0.5e-6, 20e3


@pytest.mark.parametrize(("stroke", "off"), [(0.3, 0.07), (0.5, 0.17), (0.7, 0.24)])
def test_slow_sliding_follows_partial_slip_and_not_one_spring(stroke: float, off: float) -> None:
    slow = float(
        combined_oscillation_ratio(
            SPHERE,
            approach=DEPTH,
            transverse_amplitude=stroke * SLIP,
            frequency=FREQUENCY,
            sliding_speed=1e-3 * 2 * np.pi * FREQUENCY * stroke * SLIP,
        )
    )
    partial = transverse_static_ratio(SPHERE, approach=DEPTH, transverse_amplitude=stroke * SLIP)
    assert slow == approx(float(partial), abs=0.01)
    assert np.sqrt(1 - stroke**2) - slow > off
