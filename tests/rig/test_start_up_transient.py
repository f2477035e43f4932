"""The tribometer from rest: it settles to the steady vibration, and the arm beats beside it."""

import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.errors import InvalidInput
from sonolube.rig import StartUp, read_rig, simulate, start_up, with_tables
from sonolube.rig.responses import start_up_arrays

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
TRIBOMETER = read_rig(RIGS / "tribometer.toml")


@cache
def started() -> StartUp:
    return start_up(TRIBOMETER, duration=0.1)


def test_it_settles_to_the_steady_state_that_harmonic_balance_finds() -> None:
    steady = simulate(TRIBOMETER)
    assert started().vibration_amplitude == approx(steady.vibration.vibration_amplitude, rel=1e-3)
    assert started().mean_displacement == approx(steady.vibration.mean_displacement, rel=5e-3)


def test_the_fluctuation_beside_it_is_near_100_hertz_as_section_3_3_4_says() -> None:
    assert started().beat_frequency == approx(100, abs=10)


def test_it_starts_from_rest_and_every_step_is_there() -> None:
    marched = started().trajectory
    assert marched.contact.displacement[0] == 0.0
    assert marched.contact.normal_force[0] == approx(3.0)
    assert np.all(np.diff(marched.time) > 0)
    assert marched.time[-1] == approx(0.1, rel=1e-3)


def test_its_arrays_hold_every_step_and_end_with_its_amplitude() -> None:
    arrays = start_up_arrays(TRIBOMETER, started())
    moved, time = (np.asarray(arrays[name].values) for name in ("displacement", "time"))
    assert time.size == moved.size == arrays["normal_force"].values.size
    last = time > time[-1] - 40 / 22e3
    turned = np.exp(-2j * np.pi * 22e3 * time[last])
    assert 2 * abs(np.mean((moved[last] - np.mean(moved[last])) * turned)) == approx(2.5e-6, rel=0.02)


@pytest.mark.parametrize(("periods", "is_taken"), [(7, False), (8, True), (9, True)])
def test_a_start_up_takes_eight_periods_at_least(periods: int, is_taken: bool) -> None:
    duration = (periods - 0.5) / 22e3  # begun periods count
    if is_taken:
        assert start_up(TRIBOMETER, duration=duration).trajectory.time[-1] == approx(periods / 22e3, rel=0.02)
    else:
        with pytest.raises(InvalidInput, match="from 8 to 200000 periods of the drive, got 7"):
            start_up(TRIBOMETER, duration=duration)


@pytest.mark.parametrize("duration", [1e-5, 100.0])
def test_a_duration_no_figure_can_show_is_refused(duration: float) -> None:
    with pytest.raises(InvalidInput, match="duration must be from 8 to 200000 periods of the drive"):
        start_up(TRIBOMETER, duration=duration)


def test_tables_are_replaced_and_the_rest_of_the_file_is_kept() -> None:
    text = (RIGS / "tribometer.toml").read_text(encoding="utf-8")
    tables = text[text.index("[structure]") : text.index("[assumptions]")].replace('"2.41 kg"', '"3 kg"')
    before, after = tomllib.loads(text), tomllib.loads(with_tables(text, tables))
    assert after["structure"].pop("reaction_mass") == "3 kg"
    assert before["structure"].pop("reaction_mass") == "2.41 kg"
    assert before == after
