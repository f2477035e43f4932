"""Measured files as sheets, pages and JSON: the numbers arrive with their units and caveats, and nothing is lost."""

import json
import re
import tomllib
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from pytest import MonkeyPatch, approx, mark, raises

from sonolube.charts import Field, Line
from sonolube.errors import InvalidInput
from sonolube.figure import render_figure
from sonolube.models.surfaces import GaussianCorrelationSpectrum, HeightMap, gaussian_surface
from sonolube.report import (
    MeasurementReport,
    measurement_object,
    measurement_page,
    pin_on_disc_rows,
    read_pin_on_disc_sheet,
)
from sonolube.report.measured.friction import FrictionSettings, friction_sheet
from sonolube.report.measured.friction_steps import comparison_sheet
from sonolube.report.measured.groove import worn_map_chart
from sonolube.report.measured.sheet import Sheet, Value, quantity_value
from sonolube.report.measured.spectra import ImpedanceSettings, impedance_sheet
from sonolube.report.measured.surface import SurfaceSettings, surface_sheet

RB5100 = Path(__file__).parents[3] / "shared" / "data" / "impedance" / "RB5100.txt"
NPY = SurfaceSettings(spacing_x=1e-6, spacing_y=1e-6)


def recording_file(path: Path, level: float, *, seed: int = 0, duration: float = 60.0) -> Path:
    time = np.arange(0.0, duration, 0.01)
    force = level + 0.02 * np.random.default_rng(seed).standard_normal(time.size)
    lines = [f"{t:.2f},{f:.6f}" for t, f in zip(time, force, strict=True)]
    path.write_text("\n".join(["time (s),friction_force (N)", *lines]) + "\n", encoding="utf-8")
    return path


def values(sheet: Sheet) -> dict[str, float]:
    return {value.name: value.value for value in sheet.values}


def report_of(*sheets: Sheet) -> MeasurementReport:
    return MeasurementReport(
        title="friction", settings=MappingProxyType({}), sheets=sheets, refused=MappingProxyType({})
    )


@pytest.fixture(scope="module")
def plate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    spectrum = GaussianCorrelationSpectrum(correlation_length=5e-6)
    surface = gaussian_surface(
        rms_height=0.4e-6, spectrum=spectrum, shape=(128, 160), spacing_x=1e-6, spacing_y=1e-6, seed=1
    )
    path = tmp_path_factory.mktemp("plates") / "plate.npy"
    np.save(path, surface.height)
    return path


@pytest.fixture
def page(plate: Path, tmp_path: Path) -> str:
    friction = friction_sheet(recording_file(tmp_path / "a<b>.csv", 0.5), settings=FrictionSettings(sliding_speed=0.02))
    report = report_of(friction, surface_sheet(plate, settings=NPY))
    return measurement_page(report)


def test_the_map_of_a_groove_runs_downwards_and_its_line_goes_round_the_worn_rectangle() -> None:
    worn = np.zeros((200, 1500), dtype=bool)
    worn[50:151, 300:1201] = True
    levelled = HeightMap(height=np.where(worn, -5e-6, 0.0), spacing_x=1e-6, spacing_y=2e-6)
    (panel,) = worn_map_chart(levelled, worn).panels
    field, line = panel.parts
    assert isinstance(field, Field)
    assert isinstance(line, Line)
    assert max(field.values.shape) <= 750
    assert field.values.min() == approx(-5.0)
    assert panel.y.lowest == approx(399.0)  # um, the edge of the last row at the bottom, from the centre of the first
    assert panel.y.highest == approx(-1.0)
    x, y = (values[np.isfinite(values)] for values in (line.x, line.y))
    assert (x.min(), x.max()) == approx((1e6 * levelled.x[300] - 0.5, 1e6 * levelled.x[1200] + 0.5))
    assert (y.min(), y.max()) == approx((1e6 * levelled.y[50] - 1, 1e6 * levelled.y[150] + 1))


def test_axes_write_micrometres_as_other_figures_do(plate: Path, tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    texts: list[str] = []

    def read(figure: Figure, form: str, **options: Any) -> bytes:
        texts.extend(text.get_text() for text in figure.findobj(Text))
        return render_figure(figure, form, **options)

    monkeypatch.setattr("sonolube.report.page.render_figure", read)
    measurement_page(report_of(surface_sheet(plate, settings=NPY)))
    assert any("µm" in text for text in texts)
    assert [text for text in texts if re.search(r"\bum", text)] == []


def test_the_page_needs_no_other_file(page: str) -> None:
    assert "data:image/png;base64," in page
    sources = re.findall(r"""(?:src|href|url|import)\s*[=(]\s*["']?([^"')\s>]+)""", page)
    assert all(source.startswith(("data:", "#")) for source in sources)
    assert not re.search(r"https?://|<script|@import|<link", page)


def test_a_file_cannot_write_into_the_page(page: str) -> None:
    assert "a<b>" not in page
    assert "a&lt;b&gt;" in page


def test_a_mean_arrives_with_unit_uncertainty_digest_and_version(tmp_path: Path) -> None:
    sheet = friction_sheet(recording_file(tmp_path / "test.csv", 0.5), settings=FrictionSettings(sliding_speed=0.02))
    content = json.loads(json.dumps(measurement_object(report_of(sheet)), allow_nan=False))
    force = content["results"][0]["values"]["mean_force"]
    assert force["unit"] == "N"
    assert force["value"] == approx(0.5, abs=5 * force["uncertainty"])
    assert force["uncertainty"] == approx(0.02 / 6000**0.5, rel=0.3)
    assert re.fullmatch("[0-9a-f]{64}", content["results"][0]["source"]["sha256"])
    assert content["version"]


def test_a_test_that_is_steady_from_the_start_slid_nothing_before(tmp_path: Path) -> None:
    sheet = friction_sheet(recording_file(tmp_path / "test.csv", 0.5), settings=FrictionSettings(sliding_speed=0.02))
    assert values(sheet)["steady_distance"] == 0.0
    assert values(sheet)["steady_friction_force"] == approx(0.5, rel=0.01)


def test_what_was_sought_and_not_found_is_told_with_its_reason(tmp_path: Path) -> None:
    sheet = friction_sheet(recording_file(tmp_path / "test.csv", 0.5), settings=FrictionSettings())
    assert any(reason.startswith("stick-slip: ") for reason in sheet.not_found)


def test_three_tests_with_and_three_without_give_the_reduction_and_its_interval(tmp_path: Path) -> None:
    without, vibrated = (
        [
            friction_sheet(
                recording_file(tmp_path / f"{name}{i}.csv", mean * factor, seed=i), settings=FrictionSettings()
            )
            for i, factor in enumerate((0.95, 1.0, 1.05))
        ]
        for name, mean in (("off", 1.0), ("on", 0.6))
    )
    found = next(v for v in comparison_sheet(vibrated, without).values if v.name == "friction_reduction")
    assert found.value == approx(0.4, abs=0.005)
    assert found.interval is not None
    assert 0 < found.interval[0] < found.value < found.interval[1] < 1


def test_one_test_of_each_kind_gives_a_reduction_that_nobody_can_vouch_for(tmp_path: Path) -> None:
    one, other = (
        friction_sheet(recording_file(tmp_path / f"{mean}.csv", mean), settings=FrictionSettings())
        for mean in (0.6, 1.0)
    )
    sheet = comparison_sheet([one], [other])
    assert values(sheet)["friction_reduction"] == approx(0.4, abs=0.01)
    assert any("at least two tests" in reason for reason in sheet.not_found)


def test_friction_by_the_motor_balances_its_torque(tmp_path: Path) -> None:
    from sonolube.measurement.friction.rotation import MotorCalibration

    path = tmp_path / "motor.csv"
    lines = [f"{0.1 * i:.1f},{1.5 + 0.001 * (-1) ** i}" for i in range(100)]
    path.write_text("\n".join(["time (s),motor_current (A)", *lines]) + "\n", encoding="utf-8")
    motor = MotorCalibration(torque_constant=0.5, idle_current=1.0, groove_diameter=0.05)
    sheet = friction_sheet(path, settings=FrictionSettings(motor=motor))
    assert values(sheet)["friction_force"] == approx(0.5 * 0.5 / 0.025, rel=1e-3)  # torque over the groove's radius


def test_a_surface_of_known_deviation_has_it(plate: Path) -> None:
    sheet = surface_sheet(plate, settings=NPY)
    found = values(sheet)
    assert found["rms_height"] == approx(0.4e-6, rel=0.1)
    assert found["kurtosis"] == approx(3.0, abs=0.4)
    assert found["summit_density"] > 0
    assert {table.name for table in sheet.tables} >= {"profiles", "sampling", "waviness"}


def test_every_areal_parameter_with_a_label_is_on_the_sheet(plate: Path) -> None:
    text = files("sonolube.report.measured").joinpath("surface_labels.toml").read_text(encoding="utf-8")
    shown = {value.name: value.label for value in surface_sheet(plate, settings=NPY).values}
    assert shown.items() >= tomllib.loads(text)["areal"].items()


def test_cutoffs_in_the_wrong_order_are_refused(plate: Path) -> None:
    settings = SurfaceSettings(spacing_x=1e-6, spacing_y=1e-6, short_cutoff_length=5e-5, long_cutoff_length=1e-5)
    with raises(InvalidInput, match="must be below the long one"):
        surface_sheet(plate, settings=settings)


@pytest.mark.parametrize("column", [False, True])
def test_a_row_or_a_column_is_a_profile_with_parameters_and_spectrum(tmp_path: Path, column: bool) -> None:
    line = 1e-6 * np.sin(2 * np.pi * np.arange(6000.0) / 50)[np.newaxis]  # waves of 50 um
    np.save(tmp_path / "line.npy", line.T if column else line)
    found = surface_sheet(tmp_path / "line.npy", settings=NPY)
    assert values(found)["arithmetic_mean_height"] == approx(2e-6 / np.pi, rel=2e-3)
    assert values(found)["rms_height"] == approx(1e-6 / np.sqrt(2), rel=2e-3)
    assert values(found)["mean_profile_element_spacing"] == approx(50e-6, rel=1e-4)
    assert found.values[0].label.startswith("Ra,")
    assert [figure.title for figure in found.figures] == ["Profile", "Power spectrum"]
    assert found.source["setting class"] == "Sc3 of ISO 21920-3"
    assert found.source["length"] == "6 mm"
    assert "no S-filter" in found.caveats[0]


def test_a_scan_says_its_lateral_unit_and_where_it_is_from_in_text_json_and_page(plate: Path, tmp_path: Path) -> None:
    report = report_of(surface_sheet(plate, settings=NPY))
    stated = "m, given by the user as the distance of pixels"
    assert report.sheets[0].size()["lateral unit"] == stated
    assert measurement_object(report)["results"][0]["source"]["lateral unit"] == stated
    assert stated in measurement_page(report)


def test_a_field_of_metres_has_a_caveat_on_its_sheet(plate: Path) -> None:
    metres = SurfaceSettings(spacing_x=0.01, spacing_y=0.01)
    assert any("beyond the 0.5 m" in caveat for caveat in surface_sheet(plate, settings=metres).caveats)


@pytest.mark.skipif(not RB5100.is_file(), reason="RB5100.txt is not beside the project; see shared/data")
def test_the_linear_residual_on_the_measured_transducer_gives_the_known_circuit() -> None:
    found = values(
        impedance_sheet(RB5100, settings=ImpedanceSettings(residual="linear-magnitude", branches=1, parts=()))
    )
    assert found["parallel_capacitance"] == approx(1.574e-9, rel=0.01)
    assert found["series_frequency_1"] == approx(154_397, rel=0.001)
    assert found["parallel_frequency_1"] == approx(182_966, rel=0.001)
    assert found["mechanical_quality_factor_1"] == approx(73, rel=0.03)


TEST = """
[parameters]
normal_load = "2N"
sliding_speed = "20.3mm/s"
atmosphere = "laboratory air, 22 degC, 40 % relative humidity"

[pin]
material = "AISI 440C"

[disc]
material = "aluminium 2024"
"""


def test_the_test_sheet_keeps_the_order_and_says_what_nobody_stated(tmp_path: Path) -> None:
    (tmp_path / "test.toml").write_text(TEST, encoding="utf-8")
    sheet = Sheet(title="trace.csv", values=(quantity_value("friction_force", 0.5, uncertainty=0.1),))
    table = pin_on_disc_rows(read_pin_on_disc_sheet(tmp_path / "test.toml"), [sheet])
    assert list(table) == ["Test parameters", "Materials and specimens", "Apparatus and procedure", "Wear", "Friction"]
    assert table["Test parameters"][0] == ("Load", "2N")
    assert ("Sliding distance", "not stated") in table["Test parameters"]
    assert ("Coefficient of friction at 2 N, trace.csv", "0.25 ± 0.05") in table["Friction"]


def test_a_misspelt_key_of_a_test_sheet_is_answered_with_the_right_one(tmp_path: Path) -> None:
    (tmp_path / "test.toml").write_text('[parameters]\nnormal_lod = "2N"\n', encoding="utf-8")
    with raises(InvalidInput, match=r"parameters\.normal_lod: unknown key; did you mean normal_load\?"):
        read_pin_on_disc_sheet(tmp_path / "test.toml")


@mark.parametrize(
    ("value", "uncertainty", "text"),
    [(0.705, 0.138, "705 ± 140 mN"), (0.705, 0.0044, "705 ± 4.4 mN"), (2.5, 0.013, "2.5 ± 0.013 N")],
)
def test_an_uncertainty_is_printed_in_plain_digits(value: float, uncertainty: float, text: str) -> None:
    assert Value("friction_force", "Friction", value, "N", uncertainty=uncertainty).text == text
