"""Parts of recordings from the command line: groups, steps, mappings by name, and one test in several files."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from pytest import approx

from sonolube.cli import main


def measured(capsys: pytest.CaptureFixture[str], *words: object, code: int = 0) -> list[dict[str, Any]]:
    with pytest.raises(SystemExit) as ended:
        main(["measure", "friction", *map(str, words), "--json"])
    printed = capsys.readouterr()
    assert (ended.value.code or 0) == code, printed.err
    results: list[dict[str, Any]] = json.loads(printed.out)["results"] if code < 2 else []
    return results


def reciprocating(folder: Path, *, restart: bool, files: int = 12) -> list[Path]:
    """Strokes of 1 s to and fro under 0.3 N, cut every 0.75 s, so that most cycles extend over several files."""
    time = np.arange(0, 0.75 * files, 1e-3)
    velocity = 0.02 * np.sin(np.pi * time)
    force = 0.3 * np.sign(velocity)
    paths = []
    for number in range(files):
        part = slice(750 * number, 750 * (number + 1))
        own = time[part] - (time[part][0] if restart else 0)
        path = folder / f"stroke-{number + 1}.csv"
        heading = "time (s),relative_velocity (m/s),friction_force (N)"
        columns = np.stack([own, velocity[part], force[part]], 1)
        np.savetxt(path, columns, delimiter=",", header=heading, comments="", fmt="%.9g")
        paths.append(path)
    return paths


@pytest.mark.parametrize("restart", [False, True], ids=["continued", "restarting"])
def test_cycles_are_found_over_all_files_of_one_test(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], restart: bool
) -> None:
    reciprocating(tmp_path, restart=restart)
    *each, whole = measured(capsys, tmp_path, "--join")
    assert [sheet["title"] for sheet in each] == [f"stroke-{number}.csv" for number in range(1, 13)]  # 2 before 10
    assert whole["title"] == "12 files as one test"
    stroke = 2 * 0.02 / np.pi
    assert whole["values"]["work_per_cycle"]["value"] == approx(0.3 * 2 * stroke, rel=5e-3)
    assert whole["values"]["sliding_distance"]["value"] == approx(9 * stroke, rel=1e-3)
    rows = whole["tables"]["files"]["rows"] if isinstance(whole["tables"], dict) else whole["tables"][0]["rows"]
    assert len(rows) == 12
    assert any("restart" in caveat for caveat in whole["caveats"]) == restart


def test_a_pattern_names_files_where_the_shell_does_not(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    reciprocating(tmp_path, restart=False, files=3)
    assert len(measured(capsys, tmp_path / "stroke-*.csv")) == 3


def test_a_group_is_measured_and_a_wrong_one_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "groups.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [
                ChannelObject(group, "friction_force", np.full(samples, level), {"wf_increment": 1e-2})
                for group, samples, level in (("fast", 1000, 0.4), ("slow", 500, 0.8))
            ]
        )
    measured(capsys, path, code=2)
    assert measured(capsys, path, "--group", "slow")[0]["values"]["mean_force"]["value"] == approx(0.8)
    assert measured(capsys, path, "--channel", "fast/friction_force")[0]["source"]["samples"] == "1000"
    measured(capsys, path, "--group", "medium", code=2)


def test_settings_list_the_options_that_were_given(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = reciprocating(tmp_path, restart=False, files=1)[0]
    with pytest.raises(SystemExit):
        main(["measure", "friction", str(path), "--channel", "friction_force (N)", "--json"])
    settings = json.loads(capsys.readouterr().out)["settings"]
    assert settings == {"window": "2s", "channel": "friction_force (N)"}


def test_an_unknown_mapping_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = reciprocating(tmp_path, restart=False, files=1)[0]
    with pytest.raises(SystemExit) as ended:
        main(["measure", "friction", str(path), "--mapping", "pin-on-disk"])
    assert ended.value.code == 2
    assert "did you mean pin-on-disc?" in capsys.readouterr().err


def test_a_name_that_is_no_pattern_is_refused_as_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["measure", "friction", "9**9**9"])
    assert ended.value.code == 2
    assert "No such file" in capsys.readouterr().err
