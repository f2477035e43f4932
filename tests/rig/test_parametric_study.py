"""Parametric studies of the tribometer: what waveforms, loads and resonance must do, and datasets that say so."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import approx
from scipy.special import i0

from sonolube.charts import draw_chart
from sonolube.errors import InvalidInput
from sonolube.figure import publication_style, render_figure
from sonolube.rig import (
    STUDY_CHARTS,
    Rig,
    frequency_study,
    least_power_study,
    load_study,
    operating_points,
    read_rig,
    speed_study,
    voltage_study,
    waveform_study,
    write_netcdf,
)
from sonolube.vocabulary import quantities

TRIBOMETER = read_rig(Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml")
DECAY = 2e-6  # Rq/3


def driven(volts: float) -> Rig:
    assert TRIBOMETER.drive is not None
    return replace(TRIBOMETER, drive=replace(TRIBOMETER.drive, voltage_peak_to_peak=volts, voltage_offset=volts / 2))


STUDIES: dict[str, Callable[[], xr.Dataset]] = {
    "voltage": lambda: voltage_study(TRIBOMETER, voltage_peak_to_peak=[0.0, 10, 28, 60]),
    "speed": lambda: speed_study(TRIBOMETER, sliding_speed=[5e-3, 20e-3, 2.0], voltage_peak_to_peak=[14, 28]),
    "frequency": lambda: frequency_study(TRIBOMETER, frequency=[15e3, 21e3, 22e3, 23e3], voltage_peak_to_peak=[14, 28]),
    "power": lambda: least_power_study(TRIBOMETER, frequency=[5e3, 20e3, 22e3, 23e3], friction_ratio=0.6),
    "waveform": lambda: waveform_study(driven(1.0)),
    "load": lambda: load_study(TRIBOMETER, normal_load=[2.0, 3.0, 6.5]),
}


@cache
def studied(of: str) -> xr.Dataset:
    return STUDIES[of]()


@pytest.mark.parametrize("of", STUDIES)
def test_every_variable_says_its_unit_and_what_it_is(of: str) -> None:
    for name, variable in studied(of).variables.items():
        assert variable.attrs["long_name"]
        if name in quantities():
            assert variable.attrs["units"] == (quantities()[str(name)].unit or "1")
        else:
            assert name in ("status", "reason", "waveform")


@pytest.mark.parametrize("of", STUDIES)
def test_a_study_is_drawn_and_comes_back_from_its_file(of: str, tmp_path: Path) -> None:
    with publication_style():
        assert len(render_figure(draw_chart(STUDY_CHARTS[of](studied(of))), "svg")) > 10_000
    path = write_netcdf(studied(of), path=tmp_path / "study.nc")
    with xr.open_dataset(path, engine="h5netcdf") as read:
        xr.testing.assert_identical(read.load(), studied(of))


def test_small_waveforms_move_the_tip_by_their_fundamentals() -> None:
    # of equal swing: 4/pi, 1, 8/pi^2 and 2/pi; what the harmonics add off resonance stays below a percent
    study = studied("waveform")
    amplitude = dict(zip(study["waveform"].values.tolist(), study["vibration_amplitude"].values, strict=True))
    ratios = [amplitude[name] / amplitude["sine"] for name in ("square", "triangle", "sawtooth")]
    assert ratios == approx([4 / np.pi, 8 / np.pi**2, 2 / np.pi], rel=0.01)


def test_the_mean_rises_until_it_carries_the_load() -> None:
    study = studied("voltage")
    expected = DECAY * np.log(i0(study["vibration_amplitude"].values / DECAY))
    assert study["mean_displacement"].values == approx(expected, rel=2e-3, abs=1e-12)
    assert study["normal_force"].mean("phase").values == approx(np.full(4, 3.0), rel=1e-3)


def test_the_drive_keeps_its_proportion_of_offset() -> None:
    # from 0 V up: D 1.9 with U_max = U_pp
    study = studied("voltage")
    volts = study["voltage_peak_to_peak"].values
    assert study["charging_power"].values == approx(360e-9 * volts**2 * 22e3)


def test_velocity_ratio_is_sliding_over_peak_vibration() -> None:
    study = studied("speed")
    assert study["velocity_ratio"].values == approx(
        study["sliding_speed"].values / (2 * np.pi * 22e3 * study["vibration_amplitude"].values), rel=2e-3
    )


def test_resonance_takes_the_least_voltage_and_amplifier_power() -> None:
    study = studied("power")
    assert int(np.nanargmin(study["voltage_peak_to_peak"])) == 2
    assert int(np.nanargmin(study["charging_power"])) == 2


def test_the_voltage_found_gives_the_friction_asked_for() -> None:
    study = studied("power")
    volts = study["voltage_peak_to_peak"].values[1:]
    again = operating_points(TRIBOMETER, frequency=[20e3, 22e3, 23e3], voltage_peak_to_peak=volts)
    assert again.friction_ratio == approx(np.full(3, 0.6), abs=1e-3)


def test_what_no_voltage_reaches_has_a_reason_and_no_numbers() -> None:
    study = studied("power")
    assert study["status"].values[0] == "out_of_reach"
    assert "200 V does not reduce friction" in str(study["reason"].values[0])
    assert np.isnan(study["power_to_supply"].values[0])


def test_weights_slow_the_arm_as_one_over_the_root_of_its_mass() -> None:
    # under a hundred times the arm's stiffness the contact holds the pin, and the arm swings alone on its spring
    study = load_study(TRIBOMETER, normal_load=[150.0, 300.0])
    masses = 0.602 + (study["normal_load"].values - 3.0) / 9.80665
    assert study["natural_frequency"].values == approx(np.sqrt(4.56e5 / masses) / (2 * np.pi), rel=0.01)


def test_friction_over_load_does_not_care_for_a_load_whose_decay_length_stays() -> None:
    assert np.ptp(studied("load")["friction_ratio"].values) < 1e-3


def test_a_load_lighter_than_the_arm_is_refused() -> None:
    heavy = replace(TRIBOMETER, normal_load=20.0)
    with pytest.raises(InvalidInput, match="leaves no mass on the loading arm"):
        load_study(heavy, normal_load=[1.0])


def test_a_ratio_beyond_one_is_refused() -> None:
    with pytest.raises(InvalidInput, match="friction_ratio must lie between 0 and 1"):
        least_power_study(TRIBOMETER, frequency=22e3, friction_ratio=1.5)
