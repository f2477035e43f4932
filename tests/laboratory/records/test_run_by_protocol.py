"""A protocol run on devices with the recorder of the laboratory: the record holds what was done, and is measured."""

from pathlib import Path

import numpy as np
import pytest
from tests.laboratory.records.test_recorder import judge
from tests.laboratory.simulated_rig import Fault, SimulatedRig

from sonolube.facts.protocol import protocol_from, protocol_text
from sonolube.laboratory import run_protocol
from sonolube.laboratory.catalogue import catalogued_runs, query_from, query_runs
from sonolube.laboratory.records import RunRecorder, new_run, read_run

PROTOCOL = protocol_from(
    {
        "title": "Voltage steps",
        "source": "test",
        "limits": {"voltage_maximum": "60 V", "duration_maximum": "1 h", "friction_force_maximum": "10 N"},
        "metadata": {"pin_material": "brass", "normal_load": "5 N", "groove_diameter": "50 mm"},
        "steps": [
            {
                "kind": "acquire",
                "channels": ["friction_force", "temperature"],
                "sample_rate": "200 Hz",
                "duration": "12 s",
            },
            {"kind": "motor_speed", "sliding_speed": "20 mm/s"},
            {"kind": "wait", "duration": "4 s"},
            {"kind": "drive", "voltage_peak_to_peak": "50 V", "frequency": "22 kHz"},
            {"kind": "wait", "duration": "8 s"},
        ],
    }
)


def recorder_in(parent: Path) -> RunRecorder:
    return new_run(parent, title=PROTOCOL.title, protocol=protocol_text(PROTOCOL), facts={"rig": "simulated"})


def test_a_protocol_run_is_recorded_found_and_measured(tmp_path: Path) -> None:
    rig, recorder = SimulatedRig(), recorder_in(tmp_path)
    result = run_protocol(PROTOCOL, rig.devices(), recorder, operator=lambda prompt: True)
    assert result.outcome == "completed"
    run = read_run(recorder.folder)
    judge(recorder.folder)
    recording = run.dataset()
    assert recording.sizes["time"] == 2400
    voltage = recording["voltage_peak_to_peak"].to_numpy()
    assert np.array_equal(recording["friction_force"].to_numpy() == 0.4, voltage == 50.0)
    (entry,) = query_runs(tmp_path, query_from({"material": ["brass"], "speed": ["20mm/s"]})).entries
    assert entry.normal_load == 5.0
    runs = catalogued_runs(f"catalogue:in={tmp_path}")
    assert np.allclose(runs["friction_reduction"], 0.6)
    assert np.allclose(runs["voltage_peak_to_peak"], 50.0)


@pytest.mark.parametrize("call", [6, 20, 100])
def test_a_run_that_a_device_ends_is_kept_up_to_there(tmp_path: Path, call: int) -> None:
    rig, recorder = SimulatedRig(fault=Fault(call=call)), recorder_in(tmp_path)
    run_protocol(PROTOCOL, rig.devices(), recorder, operator=lambda prompt: True)
    summary = read_run(recorder.folder).summary
    judge(recorder.folder)
    assert summary.outcome == "failed"
    assert "answers no more" in summary.reason
    assert 0 <= summary.samples < 2400
