"""Refusals of rig files: all faults at once, each in one line, with guidance for what is missing."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest
from pytest import CaptureFixture, raises

from sonolube.cli import main
from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.rig import read_rig, rig_from, rig_schema
from sonolube.rig.file.section import Section, guidance
from sonolube.rig.file.sections import RigFile
from sonolube.text.units import to_si
from sonolube.vocabulary import quantity

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
TRIBOMETER = (RIGS / "tribometer.toml").read_text(encoding="utf-8")


def faults_of(content: dict[str, Any]) -> tuple[str, ...]:
    with raises(SeveralFaults) as refusal:
        rig_from(content)
    return refusal.value.faults


def sections(annotation: Any = RigFile) -> Iterator[type[Section]]:
    if isinstance(annotation, type) and issubclass(annotation, Section):
        yield annotation
        for field in annotation.model_fields.values():
            yield from sections(field.annotation)
    for part in get_args(annotation):
        yield from sections(part)


REQUIRED = sorted(
    {
        name
        for section in sections()
        for name, field in section.model_fields.items()
        if field.is_required() and section.quantity_of(name)
    }
)


def test_the_search_finds_required_numbers_of_every_table() -> None:
    assert {"normal_load", "summit_radius", "tip_mass", "free_capacitance", "viscous_damping"} <= set(REQUIRED)


@pytest.mark.parametrize("name", REQUIRED)
def test_every_required_number_has_guidance_in_a_unit_of_its_kind(name: str) -> None:
    advice = guidance()[name]
    assert advice.obtain
    low, _, high = advice.typical.partition(" to ")
    ends = [end.partition(" for ")[0].partition(" at ")[0] for end in (low, high)]
    unit = quantity(name).unit
    assert 0 < to_si(ends[0], unit=unit, name=name) < to_si(ends[1], unit=unit, name=name)


def test_the_schema_tells_how_to_obtain_a_number() -> None:
    entry = rig_schema()["$defs"]["RoughnessSection"]["properties"]["summit_radius"]
    assert entry["description"].endswith("from a scan by `sonolube measure surface`; typically 1 um to 20 um")


def test_missing_misspelt_and_wrong_entries_are_reported_together() -> None:
    content = tomllib.loads(
        TRIBOMETER.replace("rms_height", "rms_heigth")
        .replace('summit_radius = "1.5 um"', "")
        .replace('"20.3 mm/s"', '"20.3 mm"')
        .replace("friction_coefficient = 0.341", "friction_coefficient = -1")
    )
    found = faults_of(content)
    assert [fault.partition(":")[0] for fault in found] == [
        "contact.roughness.rms_heigth",
        "contact.roughness.summit_radius",
        "friction",
        "sliding.sliding_speed",
    ]
    assert found[1] == (
        "contact.roughness.summit_radius: missing: mean radius of asperity summits; from a scan by `sonolube measure"
        " surface`; typically 1 um to 20 um"
    )


def test_a_missing_table_is_reported_by_the_keys_that_it_needs() -> None:
    content = tomllib.loads(TRIBOMETER)
    del content["contact"]["roughness"], content["sliding"]
    names = [fault.partition(":")[0] for fault in faults_of(content)]
    assert names == [
        *(f"contact.roughness.{name}" for name in ("rms_height", "summit_radius", "summit_density")),
        "sliding.sliding_speed",
    ]


def test_one_fault_stays_one_line() -> None:
    content = tomllib.loads(TRIBOMETER)
    del content["sliding"]
    with raises(InvalidInput, match=r"^sliding\.sliding_speed: missing: sliding speed; from 2 pi") as refusal:
        rig_from(content)
    assert not isinstance(refusal.value, SeveralFaults)


def test_a_file_of_many_faults_is_refused_in_twenty_and_their_number(
    tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("\n".join(f"key{number} = 1" for number in range(3000)) + "\n" + TRIBOMETER, encoding="utf-8")
    with raises(SystemExit) as end:
        main(["friction", str(path)])
    out, err = capsys.readouterr()
    assert (end.value.code, out) == (2, "")
    lines = err.splitlines()
    assert lines[0].endswith("rig.toml: 3000 faults")
    assert len(lines) == 22
    assert lines[-1] == "  ... and 2980 more"
    assert len(err) < 8000


def test_several_faults_name_their_file() -> None:
    with raises(SeveralFaults, match=r"tribometer\.toml: 2 faults; .* drive\.frequency: 2m is") as refusal:
        read_rig(RIGS / "tribometer.toml", changes=["drive.frequency=2m", "sliding.sliding_speed=1s"])
    assert "\n" not in str(refusal.value)
