"""Sizes of disturbances: their ranges, their scatter from test to test, and what is left without them."""

from dataclasses import fields, replace

import numpy as np
import pytest
from pytest import approx

from sonolube.errors import InvalidInput
from sonolube.laboratory.virtual_tribometer import UNDISTURBED, Disturbances


def test_tests_scatter_about_their_sizes_by_three_tenths_and_the_others_stay() -> None:
    drawn = [Disturbances().drawn(np.random.default_rng(seed)) for seed in range(400)]
    scattering = ("wobble_1", "wobble_2", "run_in_share", "run_in_distance", "static_share", "ringing")
    for name in scattering:
        logs = np.log([getattr(each, name) / getattr(Disturbances(), name) for each in drawn])
        assert np.mean(logs) == approx(0.0, abs=0.06)
        assert np.std(logs) == approx(0.3, rel=0.15)
    for each in fields(Disturbances):
        if each.name not in scattering:
            assert {getattr(one, each.name) for one in drawn} == {getattr(Disturbances(), each.name)}
    assert all(each.wobble_1 != each.wobble_2 for each in drawn)
    assert drawn[0].wobble_1 / 0.04 != approx(drawn[0].wobble_2 / 0.015)


def test_the_usual_sizes_are_those_of_the_dissertation_and_switched_off_they_are_zero() -> None:
    usual = Disturbances()
    assert usual.static_share == approx(1.2 / 0.89 - 1, abs=2e-3)  # D 4.1.2
    assert usual.natural_frequency == approx(100.0, rel=0.01)  # D 2.3.4
    switched = (
        *("wobble_1", "wobble_2", "run_in_share", "static_share", "burst_duration", "friction_noise", "ringing"),
        *("sensor_noise", "drift_rate", "hysteresis", "deflection_play", "displacement_noise", "flux_noise"),
        *("temperature_noise", "voltage_noise", "current_noise", "clock_error"),
    )
    for each in fields(Disturbances):
        expected = 0.0 if each.name in switched else getattr(usual, each.name)
        assert getattr(UNDISTURBED, each.name) == expected


@pytest.mark.parametrize(
    "changed",
    [
        *({name: 0.0} for name in ("motor_time", "vibration_time", "thermocouple_time", "run_in_distance")),
        *({name: 0.0} for name in ("holder_stiffness", "holder_mass", "deflected_stiffness")),
        *(
            {name: -0.1}
            for name in ("static_share", "burst_duration", "friction_noise", "clock_error", "contact_share")
        ),
        {"holder_damping_ratio": 1.01},
        {"contact_share": 1.01},
        {"run_in_share": -1.0},
    ],
)
def test_sizes_out_of_their_range_are_refused_by_name_and_those_at_its_ends_are_not(changed: dict[str, float]) -> None:
    with pytest.raises(InvalidInput, match=next(iter(changed))):
        replace(Disturbances(), **changed)  # type: ignore[arg-type]
    at_ends = replace(Disturbances(), holder_damping_ratio=1.0, contact_share=1.0, run_in_share=-0.99, magnets=0)
    assert at_ends.contact_share == 1.0
