"""Rayleigh-Ritz frequencies against an exact ring mode."""

import numpy as np
from tests.models.fem.ritz import annular_section, ritz_frequencies

from sonolube.models.fem import isotropic_medium

STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)


def test_the_breathing_mode_of_a_thin_ring_has_its_exact_frequency() -> None:
    # Breathing of a thin ring: omega = sqrt(E/rho)/R, to second order in thickness over radius.
    found = ritz_frequencies(
        annular_section(outer_radius=0.0505, inner_radius=0.0495, order=14), length=0.001, medium=STEEL, order=14
    )
    breathing = np.sqrt(200e9 / 7900) / 0.05 / (2 * np.pi)
    assert np.abs(found / breathing - 1).min() < 1e-3
