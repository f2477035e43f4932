"""Task `lab try-driver`: counts, rows and exit code from ends of runs that are made by hand."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from pytest import MonkeyPatch, approx

from sonolube.laboratory.driver_trial import DriversToTry, Fault, TriedFault
from sonolube.tasks import lab
from sonolube.tasks.lab import driver_trial

BENCH_SOURCE = str(Path(__file__).parents[3] / "examples" / "lab" / "bench_source.py")
OFF, CUT = "confirmed off, drive and motor by the device's own word, not measured", "cut the power: drive: hangs"


@pytest.fixture
def ends(monkeypatch: MonkeyPatch) -> dict[str, TriedFault]:
    """Ends of runs by call and kind of their fault, in place of runs; all others are off, and said to be."""
    found: dict[str, TriedFault] = {}
    as_ever = TriedFault(
        fault=Fault(), is_on=False, verdict=OFF, recorded=OFF, code=1, output="", error="", seconds_to_off=0.5
    )
    monkeypatch.setattr(driver_trial, "without_fault", lambda drivers: (drivers, ""))
    monkeypatch.setattr(
        driver_trial,
        "try_fault",
        lambda drivers, fault: replace(found.get(f"{fault.where}: {fault.kind}", as_ever), fault=fault),
    )
    return found


def on(verdict: str) -> TriedFault:
    return TriedFault(fault=Fault(), is_on=True, verdict=verdict, recorded=verdict, code=3, output="", error="")


def rows_of(text: str, heads: Sequence[str]) -> list[str]:
    return [line for line in text.splitlines() if line.strip().startswith(tuple(heads))]


def test_outputs_that_are_on_are_right_where_the_verdict_says_so_and_wrong_where_it_calls_them_off(
    ends: dict[str, TriedFault],
) -> None:
    ends["drive.drive: hang"] = on(CUT)
    found = lab.try_driver(BENCH_SOURCE, quick=True)
    assert not found.is_failure
    text = str(found)
    assert [
        line.split()[-1] for line in rows_of(text, ["runs with", "motor and", "on at the end, and", "wrong v"])
    ] == (["10", "9", "1", "0"])
    assert ["drive.drive", "hang", "on", "cut", "the", "power"] in [line.split() for line in text.splitlines()]
    ends["drive.off: acts lies"] = ends["drive.off: raise SystemExit"] = on(OFF)
    found = lab.try_driver(BENCH_SOURCE, quick=True)
    assert found.is_failure
    assert "wrong: drive.off: raise SystemExit: called off with an output on" in str(found)
    assert "on at the end of a device that lies     1 (" in str(found)


def test_the_object_and_the_dataset_have_a_row_a_fault(ends: dict[str, TriedFault]) -> None:
    ends["drive.close: raise ValueError"] = on(CUT)
    found = lab.try_driver(BENCH_SOURCE, quick=True)
    runs = found.json_object()["runs"]
    assert [each["is_on"] for each in runs] == [False] * 9 + [True]
    assert runs[-1]["call"] == "drive.close"
    assert (runs[-1]["outputs"], runs[-1]["wrong"]) == (CUT, "")
    data = found.dataset()
    assert data["seconds_to_off"].values[:9] == approx(0.5)
    assert data.sizes["fault"] == 10


def test_a_driver_without_an_answer_is_tried_with_calls_that_are_pretended_and_that_is_said(
    ends: dict[str, TriedFault], monkeypatch: MonkeyPatch
) -> None:
    def pretended(drivers: DriversToTry) -> tuple[DriversToTry, str]:
        return replace(drivers, is_pretended=True), "no instrument at TCPIP::10.0.0.1"

    monkeypatch.setattr(driver_trial, "without_fault", pretended)
    told = lab.try_driver(BENCH_SOURCE, quick=True).caveats()
    assert told[0].startswith("no instrument answers (no instrument at TCPIP::10.0.0.1): the calls to the devices")
