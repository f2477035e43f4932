"""Tables of switches: from rows of a file, from a recording with lifted pin, and what is refused."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.identification import SwitchTable, recorded_switches, switch_table
from sonolube.identification.decay_length.recorded_switches import _unseen_current
from sonolube.identification.decay_length.switch_table import is_switch_table
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


def test_a_table_may_be_in_any_order_and_eight_switches_of_a_reading_do(rows: Callable[..., Path]) -> None:
    runs = read_runs(rows(HEAD, "{},500,1.2,-3,400", 10))
    shuffled = runs.isel(run=[3, 1, 0, 2, 9, 8, 7, 6, 5, 4]).assign(friction_force=("run", np.arange(10) / 20))
    table = switch_table(shuffled)
    assert table.sliding_distance == approx(5.0 * np.arange(1, 11))
    assert table.friction_force == approx(np.array([2, 1, 3, 0, 9, 8, 7, 6, 5, 4]) / 20)
    shift = np.where(np.arange(10) < 8, 50.0, np.nan)
    eight = switch_table(runs.assign(small_drive_shift=("run", shift), large_drive_shift=("run", np.full(10, np.nan))))
    assert eight.missing == ("large_drive_shift",)
    assert eight.large_drive_shift is None  # an empty column states nothing
    seven = switch_table(runs.assign(small_drive_shift=("run", np.where(np.arange(10) < 7, 50.0, np.nan))))
    assert seven.missing == ("small_drive_shift", "large_drive_shift")


def test_the_first_switch_whose_friction_is_below_its_zero_is_named_whatever_is_missing_before() -> None:
    nine = np.arange(1.0, 12.0)
    zero = np.zeros(11)
    zero[1], zero[6] = np.nan, 1.5
    with raises(InvalidInput, match=r"got 1 N over 1\.5 N at switch 7"):
        SwitchTable(
            sliding_distance=nine, friction_force=0.5 + 0 * nine, intrinsic_friction_force=1 + 0 * nine, force_zero=zero
        )
    with raises(InvalidInput, match="sliding_distance must increase"):
        SwitchTable(
            sliding_distance=np.where(nine == 4, 3.0, nine),
            friction_force=0.5 + 0 * nine,
            intrinsic_friction_force=1 + 0 * nine,
            force_zero=0 * nine,
        )


@pytest.mark.parametrize(
    ("text", "encoding", "is_table"),
    [
        ("sliding_distance [m],friction_force [N]\n1,2\n", "utf-8", True),
        ("# time of the test\nGleitweg;Kraft\n1;2\n", "utf-8", True),
        ("sliding distance [m],force\n", "utf-16", True),
        ("time [s],sliding_distance [m],friction_force\n", "utf-8", False),
        ("Zeit;Gleitweg\n", "utf-8", False),
        ("friction_force [N]\nsliding_distance\n", "utf-8", False),
        ("", "utf-8", False),
    ],
)
def test_a_table_of_switches_names_a_distance_and_no_time_in_its_head(
    text: str, encoding: str, is_table: bool, tmp_path: Path
) -> None:
    (tmp_path / "file.csv").write_text(text, encoding=encoding)
    assert is_switch_table(tmp_path / "file.csv", None) is is_table


def test_means_are_of_the_halves_beside_a_switch_without_a_tenth_at_either_end() -> None:
    # a force that creeps within each part: samples 385 to 693 of 770 before a switch, 77 to 385 after one
    data = recording(wobble=0.0)
    size, stage = data.sizes["time"], SLIDE + LIFT
    place = np.arange(size) % stage
    on = np.arange(size) // stage % 2 == 1
    creep = np.where(place < SLIDE, 1e-3 * place, -5.0)
    data["friction_force"] = ("time", creep + np.where(on & (place < SLIDE), 0.0, 2.0) * (place < SLIDE))
    table = recorded_switches(data, sliding_speed=SPEED, rotation_speed=1e-4)
    before, after = np.mean(np.arange(385, 693)) * 1e-3, np.mean(np.arange(77, 385)) * 1e-3
    assert table.intrinsic_friction_force[0] - table.friction_force[0] == approx(2 + before - after, abs=0.02)
    assert table.friction_force[1] - table.intrinsic_friction_force[1] == approx(-2 + before - after, abs=0.02)
    assert table.force_zero == approx(np.full(STAGES - 1, -5.0))


def test_an_alternating_current_counts_by_its_amplitude_and_a_rectified_one_by_its_mean() -> None:
    data = recording()
    t, on = data["time"].to_numpy(), data["voltage_peak_to_peak"].to_numpy() > 0
    data["stack_current"] = ("time", np.where(on, 0.02 + 0.3 * np.sin(2 * np.pi * 1.37 * t), 0.0))
    table = recorded_switches(data, sliding_speed=SPEED, rotation_speed=0.41)
    assert table.stack_current == approx(np.full(STAGES - 1, 0.3), rel=0.02)
    assert table.stack_current_uncertainty is not None
    assert np.all(table.stack_current_uncertainty < 0.01)
    data["stack_current"] = ("time", np.where(on, 0.3 + 0.3 * np.sin(2 * np.pi * 1.37 * t), 0.0))
    assert recorded_switches(data, sliding_speed=SPEED, rotation_speed=0.41).stack_current == approx(
        np.full(STAGES - 1, 0.3), rel=0.02
    )


@pytest.mark.parametrize(("drive", "enters"), [(1.9, True), (2.1, False)])
def test_a_current_needs_five_samples_a_period_of_the_drive(drive: float, enters: bool) -> None:
    data = recording()
    t, on = data["time"].to_numpy(), data["voltage_peak_to_peak"].to_numpy() > 0
    data["stack_current"] = ("time", np.where(on, 0.3 * np.sin(2 * np.pi * 1.37 * t), 0.0))
    data["frequency_set"] = ("time", np.where(t < 50, 0.5, drive))
    table = recorded_switches(data, sliding_speed=SPEED, rotation_speed=0.41)
    assert (table.stack_current is not None) is enters
    assert bool(table.caveats) is not enters
    assert enters or table.caveats[0].startswith("stack_current at 10 Hz does not resolve the drive")
    data["stack_current"] = ("time", np.full(t.size, 0.3))
    assert recorded_switches(data, sliding_speed=SPEED, rotation_speed=0.41).caveats == ()  # a rectified one


def test_the_distance_is_that_of_the_set_speed_and_stands_still_while_nothing_is_recorded() -> None:
    data = recording()
    t = data["time"].to_numpy()
    lifted = data["normal_load"].to_numpy() == 0
    data["sliding_speed_set"] = ("time", np.where(lifted, 0.0, 0.13))
    assert recorded_switches(data, sliding_speed=SPEED, rotation_speed=0.41).sliding_distance == approx(
        10.0 * np.arange(1, STAGES), abs=0.2
    )
    late = recording().assign_coords(time=np.where(t < 100, t, t + 500.0))
    assert recorded_switches(late, sliding_speed=SPEED, rotation_speed=0.41).sliding_distance == approx(
        5.0 * np.arange(1, STAGES), abs=0.1
    )


def test_a_load_that_is_never_positive_is_refused() -> None:
    data = recording()
    data["normal_load"] = 0 * data["normal_load"]
    with raises(InvalidInput, match="normal_load must be positive while the pin slides"):
        recorded_switches(data, sliding_speed=SPEED, rotation_speed=0.41)


@pytest.mark.parametrize(
    ("mean", "rate", "seen"),
    [(0.0, 1e3, False), (2.0, 1e3, True), (-2.0, 1e3, True), (0.0, 1e7, True)],
    ids=["alternating", "rectified", "rectified, the other way", "sampled densely"],
)
def test_a_current_that_alternates_faster_than_its_samples_does_not_enter(mean: float, rate: float, seen: bool) -> None:
    time = np.arange(400) / rate
    current = mean + np.where(np.arange(400) % 2, 0.1, -0.1)
    current[:3] = np.nan
    recording = xr.Dataset(
        {"stack_current": ("time", current), "frequency_set": ("time", np.full(400, 22e3))}, {"time": time}
    )
    assert (_unseen_current(recording, time) == ()) is seen
    for missing in ("stack_current", "frequency_set"):
        assert _unseen_current(recording.drop_vars(missing), time) == ()
    if not seen:
        assert _unseen_current(recording, time) == (
            "stack_current at 1 kHz does not resolve the drive, and does not enter",
        )
