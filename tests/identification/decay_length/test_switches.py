"""Tables of switches: from rows of a file, from a recording with lifted pin, and what is refused."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.identification import SwitchTable, recorded_switches, switch_table
from sonolube.measurement.measured_runs import read_runs

RATE, SPEED, SLIDE, LIFT = 10.0, 0.065, 770, 120  # samples of a slide of 5 m, and with the pin lifted
STAGES = 12


def recording(*, wobble: float = 0.05, lifted: bool = True) -> xr.Dataset:
    """Slides by turns without and with vibration: 1.2 and 0.5 N over a zero of -0.1 N, 0.3 A, shifts 60 and 45 Hz."""
    stage = SLIDE + (LIFT if lifted else 0)
    size = STAGES * stage - (LIFT if lifted else 0)
    t, place = np.arange(size) / RATE, np.arange(size) % stage
    up, on = place >= SLIDE, (np.arange(size) // stage % 2 == 1) & (place < SLIDE)
    noise = 0.01 * np.random.default_rng(0).standard_normal(size)
    turning = 1 + wobble * np.cos(2 * np.pi * 0.41 * t)
    force = -0.1 + np.where(up, 0.0, np.where(on, 0.5, 1.2) * turning) + noise
    channels = {
        "friction_force": force,
        "voltage_peak_to_peak": np.where(on, 26.0, 0.0),
        "normal_load": np.where(up, 0.0, 5.0),
        "stack_current": np.where(on, 0.3, 0.0),
        "small_drive_shift": np.where(up, 60.0, np.nan),
        "large_drive_shift": np.where(up, 45.0, np.nan),
    }
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": t})


def test_a_recording_gives_the_levels_about_every_switch() -> None:
    table = recorded_switches(recording(), sliding_speed=SPEED)
    assert table.sliding_distance == approx(5.0 * np.arange(1, STAGES), abs=0.1)
    assert table.friction_force == approx(np.full(STAGES - 1, 0.4), abs=0.005)
    assert table.intrinsic_friction_force == approx(np.full(STAGES - 1, 1.1), abs=0.005)
    assert table.force_zero == approx(np.full(STAGES - 1, -0.1), abs=0.005)
    assert table.stack_current == approx(np.full(STAGES - 1, 0.3))
    assert table.small_drive_shift == approx(np.full(STAGES - 1, 60.0))
    assert table.large_drive_shift == approx(np.full(STAGES - 1, 45.0))
    assert table.friction_force_uncertainty is not None
    assert np.all(table.friction_force_uncertainty < 0.005)


def test_the_wobble_of_a_known_rotation_leaves_no_trace_in_the_scatter() -> None:
    table = recorded_switches(recording(wobble=0.3), sliding_speed=SPEED, rotation_speed=0.41)
    assert float(np.std(table.intrinsic_friction_force)) < 0.004


def test_a_run_whose_pin_is_never_lifted_is_refused_with_the_remedy() -> None:
    with raises(InvalidInput, match=r"0 switches with friction and zero.*lift the pin at every switch"):
        recorded_switches(recording(lifted=False), sliding_speed=SPEED)


def test_a_run_without_switches_is_refused() -> None:
    steady = recording()
    steady["voltage_peak_to_peak"][:] = 26.0
    with raises(InvalidInput, match="the vibration is never switched"):
        recorded_switches(steady, sliding_speed=SPEED)


@pytest.fixture
def rows(tmp_path: Path) -> Callable[..., Path]:
    def write(head: str, line: str, count: int = 9) -> Path:
        path = tmp_path / "switches.csv"
        text = "\n".join(line.format(5 * (index + 1)) for index in range(count))
        path.write_text(f"{head}\n{text}\n")
        return path

    return write


HEAD = "sliding_distance [m],friction_force [mN],intrinsic_friction_force [N],force_zero [mN],stack_current [mA]"


def test_a_table_is_read_in_the_units_of_its_head(rows: Callable[..., Path]) -> None:
    table = switch_table(read_runs(rows(HEAD, "{},500,1.2,-3,400")))
    assert table.friction_force == approx(np.full(9, 0.5))
    assert table.stack_current == approx(np.full(9, 0.4))
    assert table.missing == ("small_drive_shift", "large_drive_shift")


@pytest.mark.parametrize(
    ("head", "line", "count", "refusal"),
    [
        (HEAD.replace(",force_zero [mN]", ""), "{},500,1.2,400", 9, "has no column force_zero: add it, the reading"),
        (HEAD, "{},500,1.2,-3,400", 7, "7 switches with friction and zero; at least 8"),
        (HEAD, "7,500,1.2,-3,400", 9, "sliding_distance must increase"),
        (HEAD, "{},500,1.2,1300,400", 9, r"must lie above force_zero, got 1\.2 N over 1\.3 N at switch 1"),
        (HEAD, "{},500,1.2,-3,-400", 9, r"stack_current must be positive, got -0\.4 A"),
    ],
)
def test_a_table_that_tells_nothing_is_refused(
    head: str, line: str, count: int, refusal: str, rows: Callable[..., Path]
) -> None:
    with raises(InvalidInput, match=refusal):
        switch_table(read_runs(rows(head, line, count)))


def test_columns_of_other_lengths_are_refused() -> None:
    nine = np.arange(1.0, 10.0)
    with raises(InvalidInput, match="stack_current must have a value for each of the 9 switches"):
        SwitchTable(
            sliding_distance=nine,
            friction_force=nine,
            intrinsic_friction_force=nine + 1,
            force_zero=0 * nine,
            stack_current=nine[:3],
        )
