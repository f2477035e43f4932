"""Slips of the pen in a rig's file: refused by name before any work; what lies within the limits ends soon."""

import tomllib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, OutsideRange, SonolubeError
from sonolube.rig import read_rig, simulate
from sonolube.rig.file.section import LIMITS, require_plausible
from sonolube.vocabulary import quantities

RIGS = sorted((Path(__file__).parents[3] / "examples" / "rigs").glob("*.toml"))
TRIBOMETER = next(path for path in RIGS if path.stem == "tribometer")


def physical_keys(table: dict[str, object], path: str = "") -> Iterator[tuple[str, str]]:
    for key, value in table.items():
        if isinstance(value, dict):
            yield from physical_keys(value, f"{path}{key}.")
        elif key in quantities():
            yield path + key, quantities()[key].unit


@pytest.mark.parametrize("path", RIGS, ids=lambda path: path.stem)
@pytest.mark.parametrize("number", ["1e-30", "-1e30", "1e30", "nan", "inf"])
def test_what_no_rig_has_is_refused_under_its_key(path: Path, number: str) -> None:
    keys = list(physical_keys(tomllib.loads(path.read_text(encoding="utf-8"))))
    assert len(keys) > 5
    for key, unit in keys:
        with raises(InvalidInput, match=rf"{key}: .*(lies beyond any rig: expected|is not a number)"):
            read_rig(path, changes=[f"{key}={number} {unit}"])


def test_an_integer_beyond_any_float_is_refused_too(tmp_path: Path) -> None:
    text = TRIBOMETER.read_text(encoding="utf-8").replace("= 0.341", f"= 1{'0' * 400}")
    (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    with raises(InvalidInput, match=r"friction\.friction_coefficient: 1\S* lies beyond any rig: expected 1e-09 to 100"):
        read_rig(tmp_path / "rig.toml")


@pytest.mark.parametrize(
    "key", ["structure.tip_mass", "structure.arm_damping", "drive.frequency", "contact.normal_load"]
)
@pytest.mark.parametrize("number", ["0", "-1", "1e-9", "1e-3", "1e5", "1e9"])
def test_a_simulation_answers_or_refuses_whatever_the_size(key: str, number: str) -> None:
    unit = quantities()[key.rpartition(".")[2]].unit
    with suppress(SonolubeError):
        assert 0 <= simulate(read_rig(TRIBOMETER, changes=[f"{key}={number} {unit}"])).friction.friction_ratio < 10


def test_a_drive_slower_by_far_than_the_fastest_mode_is_refused_at_once() -> None:
    with raises(OutsideRange, match=r"0\.01 Hz is too slow beside the structure's fastest mode"):
        simulate(read_rig(TRIBOMETER, changes=["drive.frequency=0.01Hz"]))


def test_a_ramp_of_a_day_is_refused_where_it_would_be_marched() -> None:
    beating = ["contact.normal_load=61.209N", "drive.frequency=22436.58Hz", "drive.voltage_peak_to_peak=149.83V"]
    with raises(InvalidInput, match=r"a ramp of 86400 s is \d+ periods of the drive, too many to march"):
        simulate(read_rig(TRIBOMETER, changes=[*beating, "drive.ramp_duration=24h"]))


@pytest.mark.parametrize("unit", LIMITS)
def test_the_ends_of_what_a_rig_may_have_are_whole_powers_of_ten_and_still_accepted(unit: str) -> None:
    for sign, end in ((-1, LIMITS[unit][0]), (1, LIMITS[unit][1])):
        power = round(np.log10(end))
        assert end == approx(10.0**power, rel=1e-12)
        assert require_plausible(end, unit=unit, text="value") == end
        assert require_plausible(-end, unit=unit, text="value") == -end
        with raises(InvalidInput, match="value lies beyond any rig: expected"):
            require_plausible(end * 1.01**sign, unit=unit, text="value")
    assert require_plausible(0.0, unit=unit, text="value") == 0.0


def test_a_unit_without_ends_takes_any_number_but_the_absurd() -> None:
    assert require_plausible(1e29, unit="A", text="value") == 1e29
    for value in (1e-31, -1e31):
        with raises(InvalidInput, match="beyond any rig"):
            require_plausible(value, unit="A", text="value")
