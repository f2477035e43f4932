"""Sheets of vibrometers, force gauges, Hall probes and temperatures, from files of known content."""

from pathlib import Path

import numpy as np
import pytest
from pytest import raises
from tests.same import approx

from sonolube.charts import Bars, Chart, Line, Points, Rule
from sonolube.errors import InvalidInput
from sonolube.measurement.vibration import amplitude_per_volt, operating_deflection_shape
from sonolube.report.measured.sensors import (
    CalibrationSettings,
    RotationSettings,
    TemperatureSettings,
    calibrated_hysteresis,
    calibration_sheet,
    force_sheet,
    rotation_sheet,
    temperature_sheet,
)
from sonolube.report.measured.sheet import Figure, Sheet
from sonolube.report.measured.vibration import (
    VibrationSettings,
    assurance_figure,
    has_voltage,
    proportion_figure,
    proportion_sheet,
    shape_figure,
    vibration_sheet,
)


def written(path: Path, **columns: np.ndarray) -> Path:
    rows = np.stack(list(columns.values()), axis=1)
    np.savetxt(path, rows, delimiter=",", header=",".join(columns), comments="", fmt="%.15g")
    return path


def chart_of(figure: Figure) -> Chart:
    assert figure.drawing.chart is not None
    return figure.drawing.chart()


def numbers(sheet: Sheet) -> dict[str, float]:
    return {value.name: value.value for value in sheet.values}


FREQUENCY = 1000.0
T = np.arange(800) / 20e3  # forty periods


def vibration(folder: Path, *, volts: float = 20.0, drive: bool = True, noise: float = 0.0) -> Path:
    """Displacement of 2 um that lags the drive by 0.5, velocity of an amplitude of 1 um against it, in noise."""
    rng = np.random.default_rng(1)
    angle = 2 * np.pi * FREQUENCY * T + 0.8
    columns = {
        "time (s)": T,
        "tip (um)": 2 * np.cos(angle - 0.5) + noise * rng.standard_normal(T.size),
        "side (mm/s)": 1e-3 * 2 * np.pi * FREQUENCY * -np.sin(angle - 0.5 + np.pi),
    }
    if drive:
        columns["stack_voltage (V)"] = 3 + volts / 2 * np.cos(angle)
    return written(folder / f"v{volts:g}.csv", **columns)


def test_amplitudes_are_those_of_the_displacement_relative_to_the_drive(tmp_path: Path) -> None:
    modes = np.array([[2.0, 1.0], [-1.0, 2.0]])
    sheet = vibration_sheet(vibration(tmp_path), settings=VibrationSettings(frequency=FREQUENCY, modes=modes))
    found = numbers(sheet)
    assert found["vibration_amplitude"] == approx(2e-6)
    assert found["voltage_peak_to_peak"] == approx(20.0)
    assert found["amplitude_per_volt"] == approx(1e-7)
    assert found["standing_wave_fraction"] == approx(1.0)
    points, assurance = sheet.tables
    assert [row[0] for row in points.rows] == ["tip", "side"]
    assert [row[1] for row in points.rows] == approx([2e-6, 1e-6])
    assert [row[3] for row in points.rows] == approx([-0.5, np.pi - 0.5])
    assert assurance.rows[0] == ("1", approx(1.0))
    assert assurance.rows[1] == ("2", approx(0.0, abs=1e-9))
    assert has_voltage(sheet)


def test_without_the_drive_there_is_no_amplitude_per_volt_and_noise_gives_the_error(tmp_path: Path) -> None:
    path = vibration(tmp_path, drive=False, noise=0.1)
    sheet = vibration_sheet(path, settings=VibrationSettings(frequency=FREQUENCY))
    assert [value.name for value in sheet.values[:2]] == ["vibration_amplitude", "standing_wave_fraction"]
    # of 800 samples: 0.1 um times the root of 2/800
    assert sheet.values[0].uncertainty == approx(0.1e-6 * np.sqrt(2 / 800), rel=0.7)
    assert not has_voltage(sheet)
    with raises(InvalidInput, match="frequency must be positive"):
        VibrationSettings(frequency=0.0)


def test_a_short_recording_has_no_error_and_one_without_motion_is_refused(tmp_path: Path) -> None:
    few = slice(0, 300)  # fifteen periods: less than two in an eighth
    path = written(tmp_path / "short.csv", **{"time (s)": T[few], "tip (um)": np.cos(2 * np.pi * FREQUENCY * T[few])})
    sheet = vibration_sheet(path, settings=VibrationSettings(frequency=FREQUENCY))
    assert sheet.values[0].uncertainty is None
    assert sheet.tables[0].rows[0][2] is None
    assert sheet.figures == ()  # of a single point there is no shape
    other = written(tmp_path / "force.csv", **{"time (s)": T, "friction_force (N)": T})
    with raises(InvalidInput, match="no channel is a displacement or a velocity; give units, or a mapping"):
        vibration_sheet(other, settings=VibrationSettings(frequency=FREQUENCY))


def test_amplitudes_at_several_voltages_are_in_proportion_or_not(tmp_path: Path) -> None:
    made = [
        vibration_sheet(vibration(tmp_path, volts=volts), settings=VibrationSettings(frequency=FREQUENCY))
        for volts in (20.0, 22.0, 24.0, 26.0, 28.0, 30.0)
    ]
    flat = proportion_sheet(made)  # 2 um at every voltage
    assert flat.title == "amplitude over voltage, 6 recordings"
    assert "amplitude is not in proportion to voltage: the slope changes by -" in flat.caveats[0]
    assert numbers(flat)["amplitude_per_volt"] == approx(2e-6 * 150 / 3820)  # sum of V times 2 um over that of V^2
    few = proportion_sheet(made[:2])
    assert few.not_found[0].startswith("proportion: three pairs")


def test_charts_of_vibration_show_shape_phase_assurance_and_proportion() -> None:
    operating = operating_deflection_shape(np.array([1.0, -2.0, 0.5j]))
    shape, phase = chart_of(shape_figure(["a", "b", "c"], operating)).panels
    (line,) = (part for part in shape.parts if isinstance(part, Line))
    assert line.x.tolist() == [1, 2, 3]
    assert line.y == approx(operating.shape)
    (points,) = phase.parts
    assert isinstance(points, Points)
    assert points.y == approx([180.0, 0.0, -90.0]) or points.y == approx([180.0, 0.0, 270.0 - 360])
    assert points.sources == ("a", "b", "c")
    assert shape.x.ticks == (1.0, 2.0, 3.0)
    many = chart_of(shape_figure([str(k) for k in range(13)], operating_deflection_shape(np.arange(1.0, 14)))).panels
    assert many[0].x.ticks == ()
    (panel,) = chart_of(assurance_figure(np.array([0.9, 0.2]))).panels
    (bars,) = panel.parts
    assert isinstance(bars, Bars)
    assert (bars.places.tolist(), bars.lengths.tolist()) == ([1, 2], [0.9, 0.2])
    volts, amplitudes = np.array([1.0, 2.0, 4.0]), 1e-6 * np.array([1.1, 1.9, 4.1])
    fit = amplitude_per_volt(voltage_peak_to_peak=volts, vibration_amplitude=amplitudes)
    (panel,) = chart_of(proportion_figure(["a", "b", "c"], volts, amplitudes, fit)).panels
    (line,) = (part for part in panel.parts if isinstance(part, Line))
    (points,) = (part for part in panel.parts if isinstance(part, Points))
    assert line.x == approx([0.0, 4.2])
    assert line.y == approx([0.0, 4.2e6 * fit.amplitude_per_volt])
    assert points.y == approx([1.1, 1.9, 4.1])


def test_a_calibrated_gauge_states_its_deviation_energy_and_stiffness_and_gives_forces(tmp_path: Path) -> None:
    x = np.concatenate([np.linspace(0, 10, 60), np.linspace(10, 0, 60)[1:]])  # um
    force = 2 + 0.5 * x
    path = written(
        tmp_path / "loop.csv", **{"time (s)": np.arange(x.size), "displacement (um)": x, "friction_force (N)": force}
    )
    settings = CalibrationSettings(degree=1, levels=4, displacement_uncertainty=0.1e-6)
    sheet = calibration_sheet(path, settings=settings)
    found = numbers(sheet)
    assert found["mean_stiffness"] == approx(5.0 / 10e-6)
    assert found["hysteresis_deviation"] == approx(0.0, abs=1e-9)
    assert found["relative_deviation"] == approx(0.0, abs=1e-9)
    assert found["dissipated_energy"] == approx(0.0, abs=1e-9)
    assert [row[0] for row in sheet.tables[0].rows] == [0.0, 1.0]
    assert sheet.tables[0].rows[0][1:] == approx((2.0, 2.0))
    assert sheet.tables[0].rows[1][1:] == approx((0.5e6, 0.5e6))
    gauge = calibrated_hysteresis(path, settings=settings)
    read = written(tmp_path / "read.csv", **{"time (s)": np.arange(4.0), "displacement (um)": np.array([0.0, 4, 8, 4])})
    estimate = force_sheet(read, calibration=gauge, settings=settings)
    mean, highest = estimate.values
    assert mean.value == approx(2 + 0.5 * 4)
    assert mean.uncertainty == approx(0.05)
    assert highest.value == approx(6.0)
    assert highest.uncertainty == approx(0.05)


def test_the_rotation_of_a_probe_has_speed_distance_and_missing_pulses(tmp_path: Path) -> None:
    t = np.arange(0, 20, 0.005)
    at = np.delete(0.5 + np.arange(19.0), [4, 9, 14])
    field = np.exp(-(((t[:, np.newaxis] - at) / 0.02) ** 2)).sum(axis=1)
    path = written(tmp_path / "hall.csv", **{"time (s)": t, "magnetic_flux_density (T)": field})
    sheet = rotation_sheet(path, settings=RotationSettings(groove_diameter=0.04))
    found = numbers(sheet)
    assert found["rotation_speed"] == approx(1.0, rel=1e-3)
    assert found["sliding_speed"] == approx(np.pi * 0.04, rel=1e-3)
    assert found["revolutions"] == approx(18.0)
    assert found["sliding_distance"] == approx(18 * np.pi * 0.04)
    assert (found["pulses"], found["repaired_pulses"]) == (19, 3)
    assert found["speed_variation"] == approx(0.0, abs=1e-3)
    assert sheet.caveats == ("3 of 19 pulses were missing; lower the prominence or move the probe",)
    speed, pulses = (chart_of(figure) for figure in sheet.figures)
    (rule,) = (part for part in speed.panels[0].parts if isinstance(part, Rule))
    assert rule.value == approx(1.0, rel=1e-3)
    assert speed.panels[0].y.proportional == (approx(np.pi * 0.04), "Speed at the groove [m/s]")
    seen, inserted = (part for part in pulses.panels[0].parts if isinstance(part, Points))
    assert seen.x == approx([0.5, 1.5, 2.5, 3.5, 5.5, 6.5], abs=1e-3)  # of the first six turns
    assert inserted.x == approx([4.5], abs=1e-3)
    fewer = np.exp(-(((t[:, np.newaxis] - (0.5 + np.delete(np.arange(19.0), [4]))) / 0.02) ** 2)).sum(axis=1)
    other = written(tmp_path / "one.csv", **{"time (s)": t, "magnetic_flux_density (T)": fewer})
    assert rotation_sheet(other, settings=RotationSettings(groove_diameter=0.04)).caveats == ()
    # of 21 pulses two are less than a tenth
    tenth = np.exp(-(((t[:, np.newaxis] - 0.25 - 0.9 * np.delete(np.arange(21.0), [4, 9])) / 0.02) ** 2)).sum(axis=1)
    other = written(tmp_path / "two.csv", **{"time (s)": t, "magnetic_flux_density (T)": tenth})
    two = rotation_sheet(other, settings=RotationSettings(groove_diameter=0.04))
    assert (numbers(two)["pulses"], numbers(two)["repaired_pulses"]) == (21, 2)
    assert two.caveats == ()


def test_a_temperature_has_its_rise_time_constant_and_difference_to_a_test_without(tmp_path: Path) -> None:
    t = np.arange(0.0, 120.0, 1.0)
    heated = 20 + 8 * (1 - np.exp(-np.clip(t - 20, 0, None) / 15))
    path = written(tmp_path / "with.csv", **{"time (s)": t, "temperature (degC)": heated})
    without = written(tmp_path / "without.csv", **{"time (s)": t, "temperature (degC)": heated - 3})
    settings = TemperatureSettings(start_time=20.0, exponentials=1, without_vibration=without)
    sheet = temperature_sheet(path, settings=settings)
    found = numbers(sheet)
    assert found["final_temperature_rise"] == approx(8.0, rel=1e-4)
    assert found["temperature_rise"] == approx(3.0, rel=1e-6)
    assert found["temperature_deviation"] == approx(0.0, abs=1e-6)
    (row,) = sheet.tables[0].rows
    assert row[0] == approx(15.0, rel=1e-4)
    assert row[3] == approx(8.0, rel=1e-4)
    samples, fit = (part for part in chart_of(sheet.figures[0]).panels[0].parts if isinstance(part, Line))
    assert samples.y[0] == approx(0.0, abs=1e-4)
    assert fit.y[-1] == approx(8 * (1 - np.exp(-99 / 15)), rel=1e-4)
    with raises(InvalidInput, match=r"with\.csv: 20 s to 26 s holds fewer than 8 temperatures"):
        temperature_sheet(path, settings=TemperatureSettings(start_time=20.0, end_time=26.0))
    assert temperature_sheet(path, settings=TemperatureSettings(start_time=20.0, end_time=27.0, exponentials=1)).tables
    with pytest.raises(InvalidInput, match="0 s to 5 s holds fewer than 8"):
        temperature_sheet(path, settings=TemperatureSettings(end_time=5.0))
