"""Removal of the wobble from forces with known harmonics of the rotation."""

import numpy as np
import xarray as xr
from hypothesis import given, strategies as st
from pytest import approx, raises
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.wobble import remove_wobble
from sonolube.measurement.friction_analysis import analyse_rotation, analyse_wobble

RATE = 400.0  # Hz, D 2.3.2


def seconds(duration: float, rate: float = RATE) -> np.ndarray:
    return np.arange(round(duration * rate)) / rate


def recording(time: np.ndarray, **channels: np.ndarray) -> xr.Dataset:
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": time})


def test_a_known_wobble_is_removed_without_changing_the_rest() -> None:
    t = seconds(134)
    turns = t / 1.34  # D 4.1.2: a turn in 1.34 s
    rest = 0.89 + 0.1 * np.sin(2 * np.pi * 10.5 * turns)  # between the harmonics, over whole turns
    wobble = 0.04 * np.cos(2 * np.pi * turns - 0.7) + 0.01 * np.cos(4 * np.pi * turns + 2.0)
    clean = remove_wobble(revolutions=turns, friction_force=rest + wobble, harmonics=2, trend_degree=0)
    assert np.max(np.abs(clean.friction_force - rest)) < 1e-12
    assert clean.wobble_amplitude == approx([0.04, 0.01])
    assert clean.phase == approx([0.7, -2.0])


@given(st.floats(0.001, 10), st.floats(-3, 3), st.integers(0, 2**32 - 1))
@examples(40)
def test_gaps_do_not_affect_the_removal(amplitude: float, phase: float, seed: int) -> None:
    turns = np.linspace(0, 23.4, 5000)
    rest = 2.0 - 0.05 * turns
    force = rest + amplitude * np.cos(6 * np.pi * turns - phase)
    force[np.random.default_rng(seed).random(turns.size) < 0.3] = np.nan
    force[1000:1600] = np.nan
    clean = remove_wobble(revolutions=turns, friction_force=force)
    known = np.isfinite(force)
    assert np.max(np.abs(clean.friction_force - rest)[known]) < 1e-12 * max(1.0, amplitude)
    assert np.isnan(clean.friction_force[~known]).all()


def test_wobble_at_a_changing_speed_is_removed_by_the_pulse_times() -> None:
    t = seconds(60)
    turns = 0.5 * t + 0.004 * t**2  # quickening from 0.5 turns a second
    pulses = np.exp(-(((turns + 0.5) % 1 - 0.5) ** 2) / 2e-4)
    force = 0.9 + 0.05 * np.cos(2 * np.pi * turns)
    made = recording(t, friction_force=force, magnetic_flux_density=pulses)
    rotation = analyse_rotation(made, groove_diameter=28e-3)
    clean = analyse_wobble(made, rotation=rotation)
    between = (t > rotation.time[0]) & (t < rotation.time[-1])
    assert clean.friction_force[between] == approx(0.9, abs=1e-3)  # of 0.05


def test_less_than_one_revolution_is_refused() -> None:
    with raises(InvalidInput, match=r"revolutions cover 0\.9 of a revolution"):
        remove_wobble(revolutions=np.linspace(0, 0.9, 100), friction_force=np.ones(100))


def test_harmonics_above_the_sampling_limit_are_refused() -> None:
    with raises(InvalidInput, match="sampled too coarsely for 3 harmonics"):
        remove_wobble(revolutions=np.arange(0, 50, 0.25), friction_force=np.ones(200))
