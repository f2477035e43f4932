"""Command plan: what it prints and writes, what a filled table and its protocols read back, and what it refuses."""

import csv
import io
import itertools
import tomllib
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.cli.conftest import Program
from tests.same import same

from sonolube.facts.protocol import duration, flattened, protocol_from, protocol_text, read_protocol
from sonolube.measurement.measured_runs import read_runs

pytestmark = pytest.mark.usefixtures("compiled_kernels")

ROOT = Path(__file__).parents[3]
POWER_MAP = ROOT / "examples" / "rigs" / "power_map.toml"
TRIBOMETER = ROOT / "examples" / "rigs" / "tribometer.toml"
FEW = ("--speed", "20:200:4mm/s", "--vibration", "0.5,1.4,2.3um", "--points", "2")
MATERIALS = ("--pin", "stainless_steel_304", "--disc", "stainless_steel_304")


@dataclass(frozen=True)
class Planned:
    """Plan of few points: the answer of the command and the folder of its files."""

    answer: dict[str, Any]
    folder: Path


@pytest.fixture(scope="module")
def plans() -> list[Planned]:
    """Plans made for the tests of this file."""
    return []


@pytest.fixture
def planned(plans: list[Planned], sonolube: Program, tmp_path_factory: pytest.TempPathFactory) -> Planned:
    """Plan that several tests read, made by the first; none changes its files."""
    if not plans:
        folder: Path = tmp_path_factory.mktemp("planned")
        answer = sonolube("plan", POWER_MAP, *FEW, "--out", folder, "--json").answer
        plans.append(Planned(answer=answer, folder=folder))
    return plans[0]


def rows_of(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))


def test_the_table_has_every_point_once_in_every_block_and_no_results(planned: Planned) -> None:
    answer, rows = planned.answer, rows_of(planned.folder / "power_map-plan-runs.csv")
    assert len(rows) == len(answer["runs"]) == 2 * answer["replicates"]
    assert [row["run"] for row in rows] == [str(number) for number in range(1, len(rows) + 1)]
    points = Counter((row["block"], row["sliding_speed [mm/s]"], row["vibration_amplitude [um]"]) for row in rows)
    assert set(points.values()) == {1}
    assert all(row["friction_force [N]"] == row["intrinsic_friction_force [N]"] == "" for row in rows)


def test_a_filled_table_updates_the_prediction_and_the_next_plan(
    sonolube: Program, planned: Planned, tmp_path: Path
) -> None:
    first, table = planned.answer, tmp_path / "power_map-plan-runs.csv"
    head, *lines = (planned.folder / table.name).read_text(encoding="utf-8").splitlines()
    rng = np.random.default_rng(1)
    filled = [f"{line[:-1]}{0.4 + 0.02 * rng.standard_normal():.3f},0.89" for line in lines]
    table.write_text("\n".join([head, *filled]), encoding="utf-8")
    runs = read_runs(table)
    assert runs.sizes["run"] == len(lines)
    assert set(np.round(1e3 * runs["sliding_speed"].to_numpy(), 1)) == {
        round(1e3 * each["sliding_speed"]["value"], 1) for each in first["points"]
    }
    second = sonolube("plan", POWER_MAP, *FEW, "--runs", table, "--out", tmp_path / "next", "--json").answer
    assert "repeats of the own runs" in second["scatter"]["source"]
    assert second["scatter"]["value"] == pytest.approx(0.02 / 0.89, rel=0.5)
    assert second["friction_models"] != first["friction_models"]


def test_a_table_with_results_is_not_replaced_by_an_empty_one(
    sonolube: Program, planned: Planned, tmp_path: Path
) -> None:
    table = tmp_path / "power_map-plan-runs.csv"
    filled = (planned.folder / table.name).read_text(encoding="utf-8").replace(",,\n", ",0.4,\n", 1)
    table.write_text(filled, encoding="utf-8")
    refusal = sonolube("plan", POWER_MAP, *FEW, "--seed", "1", "--out", tmp_path)
    assert "holds results, which would be lost" in refusal.err
    assert table.read_text(encoding="utf-8") == filled


def test_every_run_has_a_protocol_that_reads_back_and_lasts_as_planned(sonolube: Program, tmp_path: Path) -> None:
    options = ("--running-in", "2m", "--measuring-time", "10s")
    answer = sonolube("plan", POWER_MAP, *FEW, *options, "--out", tmp_path, "--json").answer
    paths = sorted((tmp_path / "power_map-plan").glob("*.toml"))
    assert len(paths) == len(answer["runs"])
    speeds = [float(row["sliding_speed [mm/s]"]) / 1e3 for row in rows_of(tmp_path / "power_map-plan-runs.csv")]
    for path, speed in zip(paths, speeds, strict=True):
        protocol = read_protocol(path)
        assert protocol_from(tomllib.loads(protocol_text(protocol))) == protocol
        assert duration(protocol) == pytest.approx(0.5 + 3 * np.ceil(2 / speed) + 2 * 10)
        assert max(point.sliding_speed or 0.0 for point in flattened(protocol)) == pytest.approx(speed, rel=1e-5)


def test_the_protocols_drive_the_voltage_of_the_table(planned: Planned) -> None:
    paths = sorted((planned.folder / "power_map-plan").glob("*.toml"))
    rows = rows_of(planned.folder / "power_map-plan-runs.csv")
    assert paths
    for path, row in zip(paths, rows, strict=True):
        highest = max(flattened(read_protocol(path)), key=lambda point: point.voltage_peak_to_peak)
        assert highest.voltage_peak_to_peak == pytest.approx(float(row["voltage_peak_to_peak [V]"]), rel=1e-5)
        assert highest.voltage_offset == pytest.approx(highest.voltage_peak_to_peak / 2)


def test_the_plan_and_its_runs_begin_with_the_rigs_own_operating_point(planned: Planned) -> None:
    # D Table 4.1 and 4.2: 5 N, 65.5 mm/s, 2.31 um at 25.9 V, none of the speeds asked for
    first, run = planned.answer["points"][0], rows_of(planned.folder / "power_map-plan-runs.csv")[0]
    for name, value in {"normal_load": 5, "sliding_speed": 65.5e-3, "vibration_amplitude": 2.31e-6}.items():
        assert first[name]["value"] == pytest.approx(value, rel=1e-3)
    assert (run["sliding_speed [mm/s]"], run["normal_load [N]"]) == ("65.5", "5")
    assert planned.answer["points"][1]["sliding_speed"]["value"] != pytest.approx(65.5e-3, rel=1e-3)


def test_a_drift_over_a_run_by_its_protocol_leaves_the_difference_of_the_states(planned: Planned) -> None:
    path = sorted((planned.folder / "power_map-plan").glob("*.toml"))[0]
    protocol = read_protocol(path)
    windows: dict[bool, list[tuple[float, float]]] = {True: [], False: []}
    for point, end in itertools.pairwise(flattened(protocol)):
        step = protocol.steps[int(point.step) - 1] if point.step else None
        if step is not None and step.kind == "wait" and step.reason.endswith("measured"):
            windows[point.voltage_peak_to_peak > 0].append((point.time, end.time))
    mean_times = []
    for each in windows.values():
        ends = np.array(each)
        lengths = np.diff(ends, axis=1)[:, 0]
        assert lengths.sum() == pytest.approx(12.0)
        mean_times.append(np.sum(lengths * ends.mean(axis=1)) / 12.0)
    assert mean_times[0] == pytest.approx(mean_times[1], abs=1e-9)


def test_separate_runs_have_a_protocol_without_and_one_with_vibration(sonolube: Program, tmp_path: Path) -> None:
    answer = sonolube("plan", POWER_MAP, *FEW, "--comparison", "separate", "--out", tmp_path, "--json").answer
    folder = tmp_path / "power_map-plan"
    without, vibrated = (sorted(folder.glob(f"*{letter}-of-*.toml")) for letter in ("-without", "-with"))
    assert len(without) == len(vibrated) == len(answer["runs"])
    assert all(not any(point.voltage_peak_to_peak for point in flattened(read_protocol(path))) for path in without)
    assert all(any(point.voltage_peak_to_peak for point in flattened(read_protocol(path))) for path in vibrated)


def test_the_same_seed_gives_the_same_order_and_another_seed_another(
    sonolube: Program, planned: Planned, tmp_path: Path
) -> None:
    again, other = (
        sonolube("plan", POWER_MAP, *FEW, "--seed", seed, "--out", tmp_path, "--json").answer["runs"] for seed in (0, 4)
    )
    same(again, planned.answer["runs"])
    assert [run["point"] for run in other] != [run["point"] for run in again]


def test_points_beyond_the_amplifier_are_left_out_and_said(sonolube: Program, tmp_path: Path) -> None:
    # 2.31 um take 37.5 W, which the motion turns into heat, and the power rises with the square of the amplitude
    answer = sonolube("plan", POWER_MAP, *FEW, "--amplifier-power", "30W", "--out", tmp_path, "--json").answer
    assert {round(each["vibration_amplitude"]["value"], 8) for each in answer["left_out"]} == {2.3e-6, 2.31e-6}
    assert all("amplifier would supply 37." in each["reason"] for each in answer["left_out"])
    assert all(each["vibration_amplitude"]["value"] < 2e-6 for each in answer["points"])
    assert any("5 of 13 points exceed a limit" in caveat for caveat in answer["caveats"])
    assert any("the rig's own operating point is none of the plan" in caveat for caveat in answer["caveats"])


def test_points_that_heat_the_contact_beyond_a_limit_are_left_out(sonolube: Program, tmp_path: Path) -> None:
    limit = ("--temperature-rise", "2K")
    answer = sonolube("plan", POWER_MAP, *FEW, *MATERIALS, *limit, "--out", tmp_path, "--json").answer
    assert answer["left_out"]
    assert all(each["mean_temperature_rise"]["value"] <= 2 for each in answer["points"])
    fastest = max(each["sliding_speed"]["value"] for each in answer["points"])
    assert fastest < min(each["sliding_speed"]["value"] for each in answer["left_out"])


def test_the_sheet_has_empty_cells_limits_and_what_a_report_states(sonolube: Program, tmp_path: Path) -> None:
    answer = sonolube("plan", POWER_MAP, *FEW, *MATERIALS, "--out", tmp_path, "--json").answer
    page = (tmp_path / "power_map-plan.html").read_text(encoding="utf-8")
    assert page.count("<td></td>") >= 4 * len(answer["runs"])
    assert "@page { size: A4" in page
    for text in (
        "ASTM G99",
        "Atmosphere",
        "Departures from procedure",
        "stainless_steel_304",
        "Friction without (N or coefficient)",
    ):
        assert text in page


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--power", "1"), "power must lie between 0 and 1, got 1"),
        (("--power", "0.01"), "power 0.01 must be above the significance 0.05"),
        (("--difference", "-10%"), "difference must lie between 0 and 1 of the friction, got -0.1"),
        (("--difference", "99%", "--vibration", "0.2:0.4um"), "--difference 0.99 is larger than the effect"),
        (("--difference", "0.01%"), "needs more than 1000 replicates"),
        (("--scatter", "-3%"), "scatter must lie between 0 and 1"),
        (("--speed", "20:200"), "--speed 20 has no unit; expected a speed, such as 20.3mm/s"),
        (("--speed", "200:20mm/s"), "the first value must be above 0 and below the last"),
        (("--speed", "20:200:100000mm/s"), "a range has 2 to 200 values"),
        (("--speed", "20:200:150mm/s", "--load", "1:9:150N"), "points, but at most 200 are compared"),
        (("--speed", "20:200:lots mm/s"), "the third part is a number of values"),
        (("--speed", ",".join(["20"] * 300) + "mm/s"), "300 values; at most 200"),
        (("--speed", "0,20mm/s"), "values must be above 0"),
        (("--speed", "20N"), "--speed 20 N is a force"),
        (("--vibration", "1um", "--voltage", "3V"), "--vibration and --voltage both set the amplitude"),
        (("--points", "99"), "99 points to choose among 13"),
        (
            ("--amplifier-power", "1mW"),
            "points to choose among 0 that the rig can make; of the others: amplifier would",
        ),
        (("--pin", "stainless_steel_304"), "needs both materials"),
        (("--points", "400"), "a plan has 1 to 1000 runs"),
        (("--measuring-time", "0s"), "measuring_time must be positive"),
    ],
)
def test_impossible_wishes_are_refused_in_one_line(
    sonolube: Program, tmp_path: Path, options: tuple[str, ...], message: str
) -> None:
    assert message in sonolube("plan", POWER_MAP, *FEW, *options, "--out", tmp_path).refusal
    assert not list(tmp_path.iterdir())


def test_runs_that_cannot_be_read_are_refused_by_file_and_line(sonolube: Program, tmp_path: Path) -> None:
    table = tmp_path / "runs.csv"
    table.write_text("sliding_speed [mm/s],friction_ratio\n30,much\n", encoding="utf-8")
    refusal = sonolube("plan", POWER_MAP, *FEW, "--runs", table, "--out", tmp_path / "out").refusal
    assert f"{table}: line 2: friction_ratio 'much' is no number" in refusal


def test_a_rig_without_a_drive_voltage_is_planned_by_amplitude(sonolube: Program, tmp_path: Path) -> None:
    text = TRIBOMETER.read_text(encoding="utf-8")
    kept = text[: text.index("[actuator]")].replace('voltage_peak_to_peak = "28 V"\nvoltage_offset = "14 V"\n', "")
    rig = tmp_path / "bare.toml"
    rig.write_text(f'{kept}[vibration]\nvibration_amplitude = "2.5 um"\n', encoding="utf-8")
    answer = sonolube("plan", rig, "--points", "2", "--out", tmp_path, "--json").answer
    assert answer["points"][0]["voltage_peak_to_peak"]["value"] is None
    protocol = read_protocol(next((tmp_path / "bare-plan").glob("*.toml")))
    assert any(step.kind == "prompt" and "Switch the vibration on" in step.text for step in protocol.steps)
