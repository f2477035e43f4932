"""Krylov reduction against the full equations and all natural modes."""

import numpy as np
import pytest

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from tests.models.fem.direct_response import direct_response

from sonolube.models.fem import (
    coupled_resonances,
    generate_mesh,
    harmonic_response,
    krylov_reduction,
    natural_modes,
    stack_transducer,
)


def test_the_krylov_reduction_has_the_response_and_driven_modes_of_the_full_equations() -> None:
    made = stack_transducer(
        outer_radius=5e-3, length=12e-3, back_length=15e-3, ceramic="pic255", metal="stainless_steel_304"
    )
    model = made.model(generate_mesh(made.geometry, element_size=6e-3))
    few, coordinates = krylov_reduction(model, outputs=made.outputs, highest_frequency=160e3)
    frequency = np.array([1e3, 52e3, 119e3])
    quick = harmonic_response(few, frequency=frequency)
    full = direct_response(model, frequency=frequency, outputs=made.outputs)
    assert np.abs(quick.admittance / full.admittance - 1).max() < 1e-3
    assert np.abs(quick.displacement_per_volt / full.displacement_per_volt - 1).max() < 1e-3
    known = natural_modes(model, count=60).natural_frequency
    series, _, coupling = coupled_resonances(few)
    driven = series[(coupling > 0.05) & (series < 160e3)]
    assert driven.size > 1
    assert np.abs(known[:, np.newaxis] / driven - 1).min(axis=0).max() < 1e-5
    assert len(coordinates) < 66  # fewer than the modes, rigid ones with them
