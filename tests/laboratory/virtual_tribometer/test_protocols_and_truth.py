"""Shipped protocols from a virtual rig to the catalogue: levels, speeds, loads and stick-slip against the truth."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from sonolube.facts.protocol import (
    Acquire,
    Protocol,
    Repeat,
    Wait,
    protocol_at,
    protocol_by_name_or_file,
    protocol_text,
)
from sonolube.facts.protocol.record import Step
from sonolube.laboratory import DriveSetting
from sonolube.laboratory.catalogue import catalogued_runs
from sonolube.laboratory.records import read_run
from sonolube.laboratory.virtual_tribometer import FrictionDraw
from sonolube.laboratory.virtual_tribometer.disturbances import DISTURBANCE_UNITS
from sonolube.measurement.friction.force_cycle import StickSlipEstimate
from sonolube.measurement.friction_analysis import analyse_stick_slip
from sonolube.measurement.recorded_conditions import swept_impedance
from sonolube.models.dynamics.structure import electrical_admittance
from sonolube.report.blocks import text_lines
from sonolube.rig import read_rig
from sonolube.tasks import lab
from sonolube.tasks.identify.decay_length_of_run import decay_length
from sonolube.tasks.lab.protocol_run import RunAnswer
from sonolube.tasks.measure.recordings import calibration

RIG = Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml"
LONGEST = 60.0  # s, of a recording of the long protocols
SETTLING = 0.5  # s
SPECIMENS = {"study_2": 3}  # at one load, speed and voltage; one elsewhere
STEPPED = ("map_test", "temperature_test")  # whose run-in the steps of the voltage correct
SHORT = ("map_test", "temperature_test", "lubrication_comparison")
LONG = ("study_1", "study_2", "appendix_a")
SETTINGS = {  # loads in N, speeds in mm/s, voltages: D Tables 2.2, 2.6, 4.2, 4.3, 4.4 and A 3.1
    "map_test": ({5.0}, {65.5}, {5.1, 10.3, 15.5, 20.7, 25.9}),
    "temperature_test": ({3.0}, {220.0}, {5.1, 10.3, 15.5, 20.7, 25.9}),
    "lubrication_comparison": ({3.0, 6.0, 9.0}, {float(speed) for speed in range(60, 141, 10)}, {25.9}),
    "study_1": ({3.0}, {20.3, 40.6, 87.0}, {28.0}),
    "study_2": ({3.0}, {20.9}, {28.0}),
    "appendix_a": ({3.0}, {20.3, 40.5, 87.5}, {28.0}),
}


def recorded(*rig: Any, **arguments: Any) -> RunAnswer:
    """Answer of a virtual run that is no dry one."""
    answer = lab.virtual(*rig, **arguments)
    assert isinstance(answer, RunAnswer)
    return answer


def shortened(
    steps: tuple[Step, ...], *, longest: float = LONGEST, sample_rate: float | None = None
) -> tuple[Step, ...]:
    """Steps whose recordings and waits are bounded, the recordings at a rate of their own."""
    found: list[Step] = []
    for step in steps:
        if isinstance(step, Acquire | Wait):
            rate = {"sample_rate": sample_rate} if isinstance(step, Acquire) and sample_rate else {}
            found.append(step.model_copy(update={"duration": min(step.duration, longest), **rate}))
        elif isinstance(step, Repeat):
            inside = shortened(step.steps, longest=longest, sample_rate=sample_rate)
            found.append(step.model_copy(update={"steps": inside}))
        else:
            found.append(step)
    return tuple(found)


def protocol_of(name: str) -> Protocol:
    protocol = protocol_by_name_or_file(name)
    return protocol.model_copy(update={"steps": shortened(protocol.steps)}) if name in LONG else protocol


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Folder of a run of a protocol by its name and a seed, each made once."""

    @cache
    def make(name: str, seed: int) -> Path:
        parent = tmp_path_factory.mktemp(f"{name}-{seed}")
        (parent / "protocol.toml").write_text(protocol_text(protocol_of(name)))
        found = recorded(RIG, protocol=parent / "protocol.toml", seed=seed, out=parent / "runs")
        assert not found.is_failure, found.run.summary.reason
        return found.run.folder

    return make


def true_reductions(truth: xr.Dataset, one: xr.Dataset, *, name: str) -> np.ndarray:
    """Reduction at a load, speed and voltage by the levels of the truth, of each specimen."""
    forces = truth["friction_force"].to_numpy() * (1.0 if name in STEPPED else _run_in(truth))
    load, speed = float(one["normal_load"]), float(one["sliding_speed"])
    volts, lasts = truth["voltage_peak_to_peak"].to_numpy(), np.append(np.diff(truth["start_time"]), 0)
    same = np.isclose(truth["normal_load"], load) & np.isclose(truth["sliding_speed"], speed, rtol=5e-3) & (lasts > 2)
    vibrating = same & np.isclose(volts, float(one["voltage_peak_to_peak"]))
    count = SPECIMENS.get(name, 1)
    return np.asarray(1 - forces[vibrating][:count] / np.mean(forces[same & (volts == 0)][:count]))


def _run_in(truth: xr.Dataset) -> np.ndarray:
    """Mean over each setting, its settling excepted, of friction over that of the worn-in track."""
    start = truth["start_time"].to_numpy()
    speed = truth["sliding_speed"].to_numpy() * (truth["normal_load"].to_numpy() > 0)
    lasts = np.append(np.diff(start), 1.0)
    slid = np.concatenate([[0.0], np.cumsum(speed * lasts)[:-1]])
    share, length = float(truth["run_in_share"]), float(truth["run_in_distance"])
    first, last = slid + speed * SETTLING, slid + speed * np.maximum(lasts, 2 * SETTLING)
    mean = length * (np.exp(-first / length) - np.exp(-last / length)) / np.maximum(last - first, 1e-12)
    return np.asarray(1 + share * np.where(speed > 0, mean, np.exp(-slid / length)))


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("name", [*SHORT, *LONG])
def test_levels_speeds_and_loads_are_those_of_the_truth(made: Any, name: str, seed: int) -> None:
    folder = made(name, seed)
    runs = catalogued_runs(f"catalogue:in={folder.parent}")
    loads, speeds, voltages = SETTINGS[name]
    found_speeds = sorted({round(1e3 * float(speed), 1) for speed in runs["sliding_speed"]})
    assert {round(float(load), 6) for load in runs["normal_load"]} == loads
    assert found_speeds == pytest.approx(sorted(speeds), rel=5e-3)
    assert {round(float(volts), 3) for volts in runs["voltage_peak_to_peak"]} == voltages
    truth = xr.load_dataset(folder / "truth" / "truth.nc", engine="h5netcdf")
    for row in range(runs.sizes["run"]):
        one = runs.isel(run=row)
        expected = true_reductions(truth, one, name=name)
        reduction, uncertainty = float(one["friction_reduction"]), float(one["friction_reduction_uncertainty"])
        assert np.min(np.abs(expected - reduction)) < 4 * uncertainty


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("name", ["study_1", "study_2"])
def test_stick_slip_is_seen_or_too_fast_where_the_truth_has_it_alone(made: Any, name: str, seed: int) -> None:
    folder = made(name, seed)
    truth = xr.load_dataset(folder / "truth" / "truth.nc", engine="h5netcdf")
    run = read_run(folder)
    for part in range(1, len(run.recordings) + 1):
        recording = run.dataset(part)
        speed, volts = float(recording["sliding_speed_set"][-1]), float(recording["voltage_peak_to_peak_set"][-1])
        same = np.isclose(truth["sliding_speed"], speed) & np.isclose(truth["voltage_peak_to_peak"], volts)
        frequency = float(truth["stick_slip_frequency"].to_numpy()[same & (truth["normal_load"].to_numpy() > 0)][-1])
        is_shown = 6 * frequency < float(recording.attrs["sample_rate"])  # 100 Hz is not, at 400 Hz
        settled = recording.isel(time=recording["time"].to_numpy() > SETTLING)
        found = analyse_stick_slip(settled)
        assert (found.detected, found.resolved) == (frequency > 0 and is_shown, is_shown)


def hold_to_truth(found: StickSlipEstimate, truth: xr.Dataset, *, fraction: float, duration: float) -> None:
    """Frequency, fall and bursts of stick-slip within four standard uncertainties of the truth."""
    sticks = truth["stick_slip_frequency"].to_numpy() > 0
    frequency, fall = (float(truth[f"stick_slip_{name}"].to_numpy()[sticks][0]) for name in ("frequency", "fall"))
    lower, upper = found.stick_slip_amplitude_interval
    timing = 8 / frequency if found.slip_time.size == 0 else 1 / frequency  # of an end of a burst
    ends = timing * np.sqrt(2 * len(found.bursts) / 12)
    clock = 1 / np.sqrt(12) / duration if found.slip_time.size == 0 else frequency * timing / duration / np.sqrt(6)
    assert found.detected
    assert abs(found.stick_slip_frequency - frequency) < 4 * clock
    assert abs(found.stick_slip_amplitude - fall) < 4 * (upper - lower) / (2 * 1.96)
    assert abs(found.stick_slip_fraction - fraction) < 4 * ends / duration


@pytest.mark.parametrize("seed", [3, 4])
def test_bursts_of_stick_slip_are_those_of_the_truth_where_the_rate_shows_them(tmp_path: Path, seed: int) -> None:
    protocol = protocol_by_name_or_file("study_2")
    steps = shortened(protocol.steps, longest=20.0, sample_rate=4000.0)
    (tmp_path / "fast.toml").write_text(protocol_text(protocol.model_copy(update={"steps": steps})))
    folder = recorded(RIG, protocol=tmp_path / "fast.toml", seed=seed, out=tmp_path / "runs").run.folder
    truth, run = xr.load_dataset(folder / "truth" / "truth.nc", engine="h5netcdf"), read_run(folder)
    fractions = truth["stick_slip_fraction"].to_numpy()
    fractions = fractions[(fractions > 0) & (truth["sliding_speed"].to_numpy() > 0)]
    assert len(set(fractions)) == 3  # in bursts
    for part, fraction in zip((1, 3, 5), fractions, strict=True):
        hold_to_truth(analyse_stick_slip(run.dataset(part)), truth, fraction=fraction, duration=20.0)


@pytest.mark.parametrize("speed", [3e-3, 6e-3])
def test_stick_slip_at_low_speed_has_the_frequency_and_fall_of_the_truth(tmp_path: Path, speed: float) -> None:
    protocol = protocol_at(protocol_by_name_or_file("map_test"), normal_load=5.0, sliding_speed=speed)
    steps = shortened(protocol.steps, longest=LONGEST, sample_rate=4000.0)
    (tmp_path / "slow.toml").write_text(protocol_text(protocol.model_copy(update={"steps": steps})))
    folder = recorded(RIG, protocol=tmp_path / "slow.toml", seed=4, out=tmp_path / "runs").run.folder
    truth = xr.load_dataset(folder / "truth" / "truth.nc", engine="h5netcdf")
    recording = read_run(folder).dataset()
    time = recording["time"].to_numpy()
    found = analyse_stick_slip(recording.isel(time=(time > 2) & (time < 12)))
    hold_to_truth(found, truth, fraction=1.0, duration=10.0)


def next_of(answer: RunAnswer) -> list[str]:
    """Words of the command that a run names as the next one."""
    (line,) = (line for line in text_lines(answer.blocks(), line_length=40) if line.lstrip().startswith("next:"))
    return line.split()[1:]


def test_the_resonance_sweep_leads_to_the_resonance_of_the_structure(tmp_path: Path) -> None:
    answer = recorded(RIG, protocol="resonance_sweep", out=tmp_path)
    assert next_of(answer) == ["sonolube", "measure", "impedance", str(answer.run.folder)]
    found = swept_impedance(answer.run.recordings[0])
    assert found is not None
    structure = read_rig(RIG).structure
    assert structure is not None
    expected = 1 / electrical_admittance(structure, frequency=found.frequency)
    assert np.max(np.abs(found.impedance / expected - 1)) < 2e-3
    line = "voltage and current at 100 kHz do not resolve the drive (fewer than five samples a period)"
    assert line in found.caveats


def test_the_waveguide_calibration_leads_to_the_stiffness_of_the_truth(tmp_path: Path) -> None:
    answer = recorded(RIG, protocol="waveguide_calibration", out=tmp_path)
    loops, test = answer.run.recordings
    assert next_of(answer) == ["sonolube", "measure", "calibration", str(loops), "--apply", str(test)]
    truth = xr.load_dataset(answer.run.folder / "truth" / "truth.nc", engine="h5netcdf")
    stiffness = next(
        value.value for value in calibration(loops, apply=[test]).sheets[0].values if "stiffness" in value.name
    )
    assert stiffness == pytest.approx(float(truth["deflected_stiffness"]), rel=0.01)


def test_the_decay_length_run_leads_to_the_forces_of_the_truth_and_to_no_change(tmp_path: Path) -> None:
    protocol = protocol_by_name_or_file("decay_length_run")
    *before, switched = protocol.steps
    assert isinstance(switched, Repeat)
    few = switched.model_copy(update={"count": 5, "steps": shortened(switched.steps, longest=6.0)})
    (tmp_path / "run.toml").write_text(protocol_text(protocol.model_copy(update={"steps": (*before, few)})))
    answer = recorded(RIG, protocol=tmp_path / "run.toml", seed=1, out=tmp_path / "runs")
    folder = answer.run.folder
    assert next_of(answer) == ["sonolube", "identify", "decay-length", str(folder)]
    truth = xr.load_dataset(folder / "truth" / "truth.nc", engine="h5netcdf")
    volts, slides = truth["voltage_peak_to_peak"].to_numpy(), truth["sliding_speed"].to_numpy() > 0
    without, with_vibration = (truth["friction_force"].to_numpy()[slides & (volts == each)][0] for each in (0.0, 25.9))
    (one,) = {float(value) for value in catalogued_runs(f"catalogue:in={folder.parent}")["voltage_peak_to_peak"]}
    assert one == pytest.approx(25.9)
    found = decay_length(folder)
    table = found.table
    assert table.sliding_distance == pytest.approx(6.0 * 0.065 * np.arange(1, 10), rel=2e-3)
    for force, error, expected in (
        (table.friction_force, table.friction_force_uncertainty, with_vibration),
        (table.intrinsic_friction_force, table.intrinsic_friction_force_uncertainty, without),
    ):
        assert error is not None
        assert table.force_zero_uncertainty is not None
        late = table.sliding_distance > 3 * float(truth["run_in_distance"])  # the track has run in
        deviation = (force - table.force_zero - expected) / np.hypot(error, table.force_zero_uncertainty)
        assert np.max(np.abs(deviation[late])) < 4
    assert "none of them" in found.decision.verdict


def test_lubricant_and_load_of_prompts_change_the_virtual_rig_or_it_says_that_they_do_not(made: Any) -> None:
    truth = xr.load_dataset(made("lubrication_comparison", 1) / "truth" / "truth.nc", engine="h5netcdf")
    off = truth["voltage_peak_to_peak"].to_numpy() == 0
    coefficient = truth["friction_force"].to_numpy()[off] / truth["normal_load"].to_numpy()[off]
    assert coefficient == pytest.approx(float(truth["friction_coefficient"]))
    assert set(truth["normal_load"].to_numpy()) >= {3.0, 6.0, 9.0}
    assert float(truth["start_time"][-1]) > 12 * 46 + 12 * 60  # a prompt of a load takes a minute


def test_no_virtual_rig_slides_free_of_friction() -> None:
    rig = replace(read_rig(RIG), sliding_speed=0.005)
    drive = DriveSetting(voltage_peak_to_peak=60.0, voltage_offset=30.0, frequency=22e3)
    ratios = [FrictionDraw(rig, seed=seed).at(drive, 0.002).friction_ratio for seed in range(40)]
    assert min(ratios) >= 0.01


def test_what_was_drawn_stands_in_the_truth_only(made: Any) -> None:
    facts = (made("map_test", 1) / "run.json").read_text()
    assert not [name for name in DISTURBANCE_UNITS if name in facts]
