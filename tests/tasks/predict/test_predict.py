"""Task `predict` in Python: runs as files, bytes and datasets, and rigs of a laboratory."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pytest import raises
from tests.same import same

import sonolube as sl
from sonolube.errors import UnknownName
from sonolube.tasks.files import NamedBytes

Terminal = Callable[..., dict[str, Any]]


@pytest.fixture
def runs(examples: Path) -> Path:
    """Runs on the reference rig."""
    return examples / "tribometer-runs.csv"


def test_a_prediction_with_runs_is_that_of_the_terminal_by_path_bytes_and_dataset(
    tribometer: Path, runs: Path, on_terminal: Terminal
) -> None:
    by_path = sl.predict(tribometer, runs=runs, seed=3)
    same(by_path.json_object(), on_terminal("predict", tribometer, "--runs", runs, "--seed", 3))
    for other in (NamedBytes("runs.csv", runs.read_bytes()), sl.read_runs(runs)):
        same(sl.predict(tribometer, runs=other, seed=3).json_object(), by_path.json_object())
    assert by_path.plot().axes
    assert sl.plot(by_path.dataset()).axes
    same(
        by_path["friction_ratio"].quantile([0.1, 0.9]).to_numpy().tolist(),
        by_path.object()["friction_ratio"]["interval_80"],
    )


def test_a_laboratory_is_a_mapping_of_files_or_pairs_of_rigs_and_runs(
    tribometer: Path, examples: Path, runs: Path, on_terminal: Terminal
) -> None:
    other = examples / "rigs" / "power_map.toml"
    by_path = sl.predict(tribometer, laboratory={str(other): runs})
    same(by_path.json_object(), on_terminal("predict", tribometer, "--laboratory", f"{other}={runs}"))
    pairs = [(sl.read_rig(other), sl.read_runs(runs))]
    same(sl.predict(tribometer, laboratory=pairs).json_object(), by_path.json_object())
    assert by_path.object()["friction_ratio"] != sl.predict(tribometer).object()["friction_ratio"]


def test_materials_are_refused_by_name(tribometer: Path) -> None:
    with raises(UnknownName, match="unknown material 'aluminium_2042'; did you mean aluminium_2024"):
        sl.predict(tribometer, pin="aluminium_2042", disc="m50")


def test_the_operating_point_is_stated_with_its_spread_and_power(tribometer: Path) -> None:
    stated = {each["name"]: each["text"] for each in sl.predict(tribometer, draws=200).object()["operating_point"]}
    assert stated["vibration_amplitude"].startswith("2.5 um within ")  # at 28 V, where it was measured
    assert stated["power_to_supply"] == "43.9 W"
    assert stated["charging_power"] == "6.21 W"
