"""Roughness against in-plane motion on the rig of the power maps: which test would tell them apart."""

from dataclasses import replace

import numpy as np

from sonolube.checks import Floats
from sonolube.design.test_plan.information import ModelOutcomes, mutual_information
from sonolube.validation.friction_model_variants import asperity_stick_slip
from sonolube.validation.published_tests import FrictionTest, friction_tests

TESTS = tuple(friction_tests("B"))  # D Table 4.2, 65.5 mm/s
SPEEDS = 1e-3 * np.array([20, 30, 45, 65.5, 100, 150])
AMPLITUDES = np.array([test.vibration_amplitude for test in TESTS])
DRAWS, PRIOR = 128, 400
Draw = tuple[float, float, float, float]


def ratio(test: FrictionTest, draw: Draw) -> float:
    """Friction ratio by memory length, roughness, and fraction and phase of motion along the sliding."""
    memory, rms_height, fraction, phase = draw
    contact = replace(test.contact, roughness=replace(test.contact.roughness, rms_height=rms_height))
    test = replace(test, contact=contact)
    found = asperity_stick_slip(test, memory_length=memory, in_plane_fraction=fraction, in_plane_phase=phase)
    return float(found)


def outcomes(name: str, *, roughness_spread: float, largest_fraction: float) -> ModelOutcomes:
    """Outcomes over speeds and amplitudes by draws that Table 4.2 weighs."""
    rng = np.random.default_rng(0)
    prior = [
        (1.5e-6 * np.exp(0.5 * a), 2.12e-6 * np.exp(roughness_spread * b), c, d)
        for a, b, c, d in zip(
            rng.standard_normal(PRIOR),
            rng.standard_normal(PRIOR),
            rng.uniform(0, largest_fraction, PRIOR),
            rng.uniform(0, 2 * np.pi, PRIOR),
            strict=True,
        )
    ]
    residual = np.array([[ratio(test, draw) - test.friction_ratio for test in TESTS] for draw in prior])
    weights = np.exp(-0.5 * np.sum((residual / 0.05) ** 2, axis=1))
    rows = rng.choice(PRIOR, DRAWS, p=weights / weights.sum())
    found = {row: _row(prior[row]) for row in np.unique(rows)}
    means = np.array([found[row] for row in rows])
    count = means.shape[1]
    return ModelOutcomes(
        name=name,
        weight=0.5,
        means=means,
        deviations=np.full(means.shape, 0.05),
        squared_distances=1e3 * (1 - np.eye(count)),
        lengths=np.ones(DRAWS),
    )


def _row(draw: Draw) -> list[float]:
    points = ((speed, amplitude) for speed in SPEEDS for amplitude in AMPLITUDES)
    return [ratio(replace(TESTS[0], sliding_speed=v, vibration_amplitude=a), draw) for v, a in points]


def informations() -> Floats:
    """Information of one test in bits, shape (speeds, amplitudes)."""
    models = [
        outcomes("roughness", roughness_spread=0.7, largest_fraction=0.0),
        outcomes("in-plane motion", roughness_spread=0.23, largest_fraction=0.6),
    ]
    count = SPEEDS.size * AMPLITUDES.size
    noise = np.full(count, 0.03)
    found = [mutual_information(models, np.array([point]), noise=noise) for point in range(count)]
    return np.array(found).reshape(SPEEDS.size, -1)


def test_slow_sliding_at_the_largest_amplitude_tells_roughness_from_in_plane_motion() -> None:
    found = informations()
    slow = found[1, -1]  # 30 mm/s and 2.31 um
    assert slow > 0.9 * found.max()
    assert slow > 0.7
    assert slow > 1.2 * found[3].max()  # than any repeat at the speed of Table 4.2
