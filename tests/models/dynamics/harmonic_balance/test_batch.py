"""Batches of steady states: chunks joined."""

import numpy as np

from sonolube.checks import Floats
from sonolube.models.dynamics.harmonic_balance.batch import BatchSolution, concatenate


def solution(first: float, points: int, harmonics: int) -> BatchSolution:
    values: Floats = np.asarray(first + np.arange(points), dtype=np.float64)
    pair = np.stack([values, values], axis=1)
    return BatchSolution(
        mean_displacement=values.copy(),
        harmonics=np.outer(values, np.ones(harmonics)).astype(np.complex128),
        mean_normal_force=values.copy(),
        charge_harmonics=pair.astype(np.complex128),
        vibration_amplitude=values.copy(),
        extremum_phases=pair.copy(),
        lowest_displacement=values.copy(),
        highest_normal_force=values.copy(),
        lowest_normal_force=values.copy(),
        contact_loss_fraction=values.copy(),
        unstable=values > 100,
        coexisting_amplitude=values.copy(),
        harmonic_count=np.full(points, harmonics),
    )


def test_chunks_with_different_numbers_of_harmonics_are_joined_in_order() -> None:
    joined = concatenate([solution(1.0, 2, 3), solution(3.0, 3, 1)])
    assert joined.mean_displacement.tolist() == [1.0, 2.0, 3.0, 4.0, 5.0]
    assert joined.harmonics.shape == (5, 3)
    assert joined.harmonics[3].tolist() == [4.0, 0.0, 0.0]
