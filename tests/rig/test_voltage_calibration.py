"""One pair of voltage and amplitude: in a rig file, as a change of it, in a new rig, and for runs with voltages."""

from dataclasses import replace
from pathlib import Path

import pytest
import xarray as xr
from pytest import approx, raises

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.prediction.inputs import own_runs, rig_inputs
from sonolube.rig import Rig, friction_point, read_rig
from sonolube.rig.voltage_calibration import voltage_calibration
from sonolube.validation.run_conditions import run_conditions

KNOWN = {"pin": "m50", "disc": "m50", "load": "5N", "speed": "0.2m/s", "frequency": "20kHz"}


def new_rig(folder: Path, *changes: str, **known: str) -> Rig:
    path = folder / "rig.toml"
    text = sl.new(**KNOWN, **known).files()["rig.toml"]
    assert isinstance(text, str)
    path.write_text(text)
    return read_rig(path, changes=list(changes))


@pytest.mark.parametrize("text", ["25 V = 2 um", "25V=2um", "25 Vpp = 2 um", "25 V pp = 4 um pp", "0.025kV = 2000nm"])
def test_a_pair_of_voltage_and_amplitude_is_eighty_nanometres_per_volt(text: str) -> None:
    assert voltage_calibration(text).amplitude_per_volt == approx(80e-9)
    assert voltage_calibration(voltage_calibration(text).text).amplitude_per_volt == approx(80e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("25 V", "calibration '25 V' must be such as '25 V = 2 um'"),
        ("25 N = 2 um", "25 N is a force; expected a voltage"),
        ("25 V = 2 V", "2 V is a voltage; expected a length"),
        ("0 V = 2 um", "voltage_peak_to_peak must be positive"),
    ],
)
def test_other_texts_are_refused(text: str, message: str) -> None:
    with raises(InvalidInput, match=message):
        voltage_calibration(text)


def test_a_calibration_beside_a_stated_amplitude_scales_the_voltages_of_runs(tmp_path: Path) -> None:
    rig = new_rig(tmp_path, "vibration.calibration=25V=2um", amplitude="3um")
    assert friction_point(rig).vibration_amplitude == approx(3e-6)
    runs = xr.Dataset({"friction_reduction": ("run", [0.2, 0.4]), "voltage_peak_to_peak": ("run", [12.5, 25.0])})
    fitted = run_conditions(runs, rig)
    assert [one.vibration_amplitude for one in fitted.conditions] == approx([1e-6, 2e-6])
    predicted = own_runs(runs, rig_inputs(rig), title="own")
    assert predicted.tested.at.conditions.vibration_amplitude == approx([1e-6, 2e-6])
    said = "amplitudes of runs that state a voltage are taken as proportional to it, by the calibration of 80 nm/V"
    assert said in fitted.caveats
    assert said in predicted.caveats
    stated = runs.assign(vibration_amplitude=("run", [1e-6, 2e-6]))
    assert said not in run_conditions(stated, rig).caveats


def test_the_voltage_of_a_measured_amplitude_scales_runs_too(tmp_path: Path) -> None:
    rig = new_rig(tmp_path, "vibration.voltage_peak_to_peak=30V", amplitude="3um")
    runs = xr.Dataset({"friction_reduction": ("run", [0.2]), "voltage_peak_to_peak": ("run", [10.0])})
    found = run_conditions(runs, rig)
    assert found.conditions[0].vibration_amplitude == approx(1e-6)
    assert found.caveats[-1].endswith("by the measured 3 um at 30 V")


def test_runs_with_voltages_of_a_rig_that_knows_none_are_refused_with_a_remedy_that_works(tmp_path: Path) -> None:
    runs = xr.Dataset({"friction_reduction": ("run", [0.2]), "voltage_peak_to_peak": ("run", [10.0])})
    with raises(InvalidInput, match=r'--set vibration\.calibration="25 V = 2 um"'):
        run_conditions(runs, new_rig(tmp_path, amplitude="3um"))
    run_conditions(runs, new_rig(tmp_path, "vibration.calibration=25 V = 2 um", amplitude="3um"))


def test_a_new_rig_by_a_calibration_vibrates_as_it_says_and_by_voltage(tmp_path: Path) -> None:
    assert friction_point(new_rig(tmp_path, calibration="25V = 2um")).vibration_amplitude == approx(2e-6)
    another = new_rig(tmp_path, amplitude="3um", calibration="25V = 2um")
    assert another.drive is not None
    assert another.drive.voltage_peak_to_peak == approx(37.5)
    assert friction_point(another).vibration_amplitude == approx(3e-6)
    halved = new_rig(tmp_path, "drive.voltage_peak_to_peak=12.5V", calibration="25V = 2um")
    assert friction_point(halved).vibration_amplitude == approx(1e-6)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (["vibration.calibration=25V=2um", "drive.voltage_peak_to_peak=30V"], "two of them give the third"),
        (["vibration.calibration=25V=2um", "vibration.voltage_peak_to_peak=30V"], "relate an amplitude to a voltage"),
        (["vibration.calibration=25 V"], "must be such as '25 V = 2 um'"),
    ],
)
def test_two_relations_of_voltage_and_amplitude_are_refused(changes: list[str], message: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match=message):
        new_rig(tmp_path, *changes, amplitude="3um")


def test_a_calibration_beside_that_of_an_actuator_is_refused(tmp_path: Path) -> None:
    with raises(InvalidInput, match="say the same: give one"):
        new_rig(tmp_path, "vibration.calibration=1V=1nm", actuator="sa050510", voltage="40V")
    with raises(InvalidInput, match="give either actuator or calibration, got both"):
        sl.new(**KNOWN, actuator="sa050510", voltage="40V", calibration="25V=2um")
    assert replace(voltage_calibration("1V=1um"), voltage_peak_to_peak=2.0).amplitude_per_volt == approx(5e-7)
