"""Readings of a run against a circuit, a mass on two springs, and friction that is marched element by element."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from reliability import decay_length_recordings as made

from sonolube.identification import SwitchConditions, SwitchTable
from sonolube.identification.decay_length.run_model import (
    PARAMETERS,
    Changes,
    RunModel,
    interpolated_ratio,
    noise_covariance,
    relaxation,
    run_channels,
)

S = np.arange(5.0, 300.0, 5.0)
LENGTH = 1e-6 * (0.7 + 1.3 * S / S[-1])


def test_interpolated_ratios_are_those_of_elements_marched_through_a_period() -> None:
    length, a = 1e-6 * np.array([0.5, 0.7, 1.0, 2.0, 3.0]), np.full(5, 2.3e-6)
    marched = made.stick_slip_ratio(length, a, 1.5e-6, steps=4800)
    speed = made.SLIDING_SPEED * length / (2 * np.pi * made.FREQUENCY * a * 1.5e-6)
    assert_allclose(interpolated_ratio(relative_amplitude=a / length, reduced_speed=speed), marched, atol=1e-3)


def test_without_relative_speed_reserve_nothing_sticks() -> None:
    assert interpolated_ratio(relative_amplitude=np.array([1.0]), reduced_speed=np.array([1.5]))[0] == 1


def test_a_relaxation_is_exponential_and_ends_at_one() -> None:
    course = relaxation(S, reach=np.array([60.0]), exponent=np.array([1.0]))[0]
    assert_allclose(course, (1 - np.exp(-S / 60)) / (1 - np.exp(-S[-1] / 60)))
    assert np.isfinite(relaxation(S, reach=np.array([1e-30, 1e30]), exponent=np.array([1e9, 1e-9]))).all()


def steady_model(**conditions: float) -> RunModel:
    """Model of a run whose readings do not matter here."""
    shift = np.full(S.size, 60.0)
    table = SwitchTable(
        sliding_distance=S,
        friction_force=np.full(S.size, 0.6) + 1e-3 * np.sin(S),
        intrinsic_friction_force=np.full(S.size, 1.0),
        force_zero=1e-3 * np.cos(S),
        stack_current=0.4 + 1e-3 * np.sin(2 * S),
        small_drive_shift=shift + np.sin(S),
        large_drive_shift=0.8 * shift + np.cos(S),
    )
    known = SwitchConditions(natural_frequency=40.0, **conditions)
    changes = Changes(grows=True, falls=True, drifts=False, follows=True)
    return RunModel(table, known, changes, channels=run_channels(table, known))


def deviates(model: RunModel, **values: float) -> np.ndarray:
    row = np.zeros((1, len(PARAMETERS)))
    for name, value in values.items():
        column = PARAMETERS.index(name)
        row[0, column] = (value - model.means[column]) / model.deviations[column]
    return row


def test_shifts_are_those_of_a_mass_between_its_own_spring_and_that_of_the_contact() -> None:
    model = steady_model(modal_mass=8.0)
    row = deviates(model, decay_length=np.log(0.8e-6), growth=0.0, fall=0.0, large_drive=np.log(2e-6))
    fitted = model.predicted(row)
    stiffness = made.NORMAL_LOAD / 0.8e-6
    exact = np.sqrt(40.0**2 + stiffness / (4 * np.pi**2 * 8.0)) - 40.0
    assert_allclose(fitted["small_drive_shift"], exact * (1 + exact / 80.0))
    share = made.contact_stiffness(np.array([0.8e-6]), np.array([2e-6]))[0] / stiffness
    assert_allclose(fitted["large_drive_shift"] / fitted["small_drive_shift"], share, rtol=1e-6)


@pytest.mark.parametrize("turned", [-50.0, 0.0, 50.0])
def test_the_current_is_that_of_a_resonator_beside_its_capacitance(turned: float) -> None:
    model = steady_model()
    row = deviates(model, capacitive_share=0.0, turned_share=turned, fall=np.log(2.0))
    fitted = model.predicted(row)["stack_current"][0]
    _, a = model.courses(row)
    relative = a[0] / np.exp(model.means[PARAMETERS.index("amplitude")])
    off = np.sign(turned) * np.sqrt(np.maximum(relative**-2 - 1, 0))
    motional = relative if turned == 0 else 1 / (1 + 1j * off)
    assert_allclose(np.exp(fitted), np.abs(0.4j + motional), rtol=1e-6)  # half of the largest share, 0.8


def test_noise_beside_a_course_has_its_true_variance_and_not_less_than_stated() -> None:
    rng = np.random.default_rng(0)
    found = [
        noise_covariance(S, 3 * np.exp(-S / 40) + 0.1 * rng.standard_normal(S.size), None)[0, 0] for _ in range(40)
    ]
    assert np.mean(found) == pytest.approx(0.01, rel=0.15)
    stated = noise_covariance(S, 3 * np.exp(-S / 40) + 0.1 * rng.standard_normal(S.size), np.full(S.size, 0.5))
    assert np.all(np.diag(stated) >= 0.25)
