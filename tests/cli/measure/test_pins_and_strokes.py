"""Pins, reciprocating motions and large recordings from the command line."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from pytest import approx

from sonolube.cli import main
from sonolube.report.measured import friction


def results_of(capsys: pytest.CaptureFixture[str], *words: object) -> list[dict[str, Any]]:
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in (*words, "--json")])
    printed = capsys.readouterr()
    assert ended.value.code in (0, None), printed.err
    assert "\x1b" not in printed.err  # no progress bar without a terminal
    results: list[dict[str, Any]] = json.loads(printed.out)["results"]
    return results


@pytest.mark.parametrize("known", [(), ("--tip-radius", "4mm")])
def test_a_pin_with_a_flat_has_lost_the_cap_above_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], known: tuple[str, ...]
) -> None:
    radius, pixel, flat = 4e-3, 8e-6, 0.4e-3
    rng = np.random.default_rng(0)
    x, y = np.meshgrid((np.arange(160) - 75) * pixel, (np.arange(120) - 65) * pixel)
    height = np.minimum(np.sqrt(radius**2 - x**2 - y**2), math.sqrt(radius**2 - flat**2 / 4))
    np.save(tmp_path / "pin.npy", height - radius + 0.02e-6 * rng.standard_normal(height.shape))
    ridge = 1e-6 * np.exp(-(((x + 0.2e-3) / 1e-4) ** 2))
    np.save(tmp_path / "scan.npy", 0.02e-6 * rng.standard_normal(height.shape) - 10 * ridge)
    call = ["measure", "groove", tmp_path / "scan.npy", "--pin", tmp_path / "pin.npy", "--spacing", "8um", *known]
    pin = results_of(capsys, *call)[-1]["values"]
    # a segment of a ball of height h: pi h^2 (R - h/3)
    h = radius - math.sqrt(radius**2 - flat**2 / 4)
    assert pin["pin_volume"]["value"] == approx(math.pi * h**2 * (radius - h / 3), rel=0.03)
    assert pin["scar_diameter"]["value"] == approx(flat, abs=pixel)


def test_a_rubbing_stroke_to_and_fro_costs_its_force_over_its_length(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    time = np.arange(0, 5, 1e-3)
    velocity = 0.02 * np.sin(2 * np.pi * time)
    force = 0.3 * np.sign(velocity) + 0.05  # and a zero error, which a whole loop does not feel
    path = tmp_path / "loops.csv"
    heading = "time (s),relative_velocity (m/s),friction_force (N)"
    np.savetxt(path, np.stack([time, velocity, force], 1), delimiter=",", header=heading, comments="", fmt="%.9g")
    values = results_of(capsys, "measure", "friction", path)[0]["values"]
    assert values["work_per_cycle"]["value"] == approx(0.3 * 4 * 0.02 / (2 * np.pi), rel=2e-3)  # stroke 2 v/omega
    assert values["sliding_distance"]["value"] == approx(5 * 4 * 0.02 / (2 * np.pi), rel=1e-3)


def test_a_recording_too_large_to_hold_gives_the_windows_of_the_whole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path, rng = tmp_path / "long.tdms", np.random.default_rng(1)
    with TdmsWriter(path) as writer:
        for _ in range(10):
            part = 0.4 + 0.02 * rng.standard_normal(2000)
            writer.write_segment([ChannelObject("g", "friction_force", part, {"wf_increment": 1e-3})])
    whole = results_of(capsys, "measure", "friction", path)[0]["values"]
    monkeypatch.setattr(friction, "_LARGE", path.stat().st_size - 1)
    streamed = results_of(capsys, "measure", "friction", path)[0]["values"]
    assert streamed.keys() <= whole.keys()
    assert streamed["mean_force"]["value"] == approx(0.4, abs=1e-3)
    for name, value in streamed.items():
        assert value["value"] == approx(whole[name]["value"], rel=1e-9), name
