"""A rig in Python: its table, entries replaced, and its file written again."""

from dataclasses import replace
from pathlib import Path

from pytest import approx, mark, raises
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.rig import Rig, read_rig, simulate

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
EXAMPLES = sorted(RIGS.glob("*.toml"))


def tribometer() -> Rig:
    return read_rig(RIGS / "tribometer.toml")


def test_a_replaced_entry_is_that_of_a_file_with_the_other_value() -> None:
    rig = tribometer().replace("drive.voltage_peak_to_peak", "14 V").replace("friction.friction_coefficient", 0.2)
    changes = ["drive.voltage_peak_to_peak=14V", "friction.friction_coefficient=0.2"]
    same(simulate(rig).friction, simulate(read_rig(RIGS / "tribometer.toml", changes=changes)).friction)
    assert tribometer().drive is not None
    assert rig.friction_coefficient == 0.2


def test_a_rig_is_left_as_it_was_when_an_entry_of_it_is_replaced() -> None:
    rig = tribometer()
    rig.replace("contact.normal_load", "5 N")
    assert rig.normal_load == 3.0
    assert rig.table() == tribometer().table()


@mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_a_rig_that_is_written_is_read_as_the_same(path: Path, tmp_path: Path) -> None:
    rig = read_rig(path)
    again = read_rig(rig.to_toml(tmp_path / "rig.toml"))
    assert again.table() == rig.table()
    assert dict(again.assumptions) == dict(rig.assumptions)
    assert {key: one.text for key, one in again.uncertainty.items()} == {
        key: one.text for key, one in rig.uncertainty.items()
    }


@mark.parametrize(
    ("key", "value", "message"),
    [
        ("drive.voltage", "14 V", "drive.voltage: unknown key"),
        ("drive.frequency", "14 V", r"replace\('drive.frequency', '14 V'\): drive.frequency: .* is a voltage"),
        ("title.short", "a", "title is not a table"),
        ("drive.", "a", "no key of a rig file"),
    ],
)
def test_an_entry_that_no_file_may_hold_is_refused_in_one_line(key: str, value: str, message: str) -> None:
    with raises(InvalidInput, match=message) as refused:
        tribometer().replace(key, value)
    assert "\n" not in str(refused.value)


def test_a_rig_changed_in_python_has_no_file() -> None:
    changed = replace(tribometer(), normal_load=5.0)
    with raises(InvalidInput, match="replace entries of the rig that read_rig returns"):
        changed.to_toml("rig.toml")


def test_a_rig_prints_as_a_short_table_with_units() -> None:
    lines = repr(tribometer()).splitlines()
    assert lines[0] == "Modified pin-on-disc tribometer, steel pin on aluminium disc"
    rows = {line[2:28].strip(): line[28:].strip() for line in lines[1:]}
    assert rows["normal load"] == "3 N"
    assert rows["drive"] == "28 V peak to peak, 22 kHz, sine"
    assert "2.5 um measured; computed from stack and structure; 89.3 nm/V" in repr(tribometer())
    assert len(lines) < 15


def test_a_notebook_shows_the_same_rows_as_a_table_with_its_text_escaped() -> None:
    rig = tribometer().replace("title", "<script>alert(1)</script>")
    html = rig._repr_html_()
    assert html.count("<tr>") == len(rig.table())
    assert "<td>3 N</td>" in html
    assert "<script>" not in html


def test_a_file_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with raises(InvalidInput):
        tribometer().to_toml(tmp_path / "file" / "rig.toml")


def test_numbers_survive_as_they_were_typed(tmp_path: Path) -> None:
    written = tribometer().replace("drive.frequency", "21.95 kHz").to_toml(tmp_path / "rig.toml")
    assert 'frequency = "21.95 kHz"' in written.read_text(encoding="utf-8")
    drive = read_rig(written).drive
    assert drive is not None
    assert drive.frequency == approx(21950.0)


def test_a_replaced_finish_is_read_as_a_file_with_the_other_finish(tmp_path: Path) -> None:
    text = (RIGS / "tribometer.toml").read_text(encoding="utf-8")
    start, end = text.index("rms_height"), text.index("[contact.pair]")
    path = tmp_path / "rig.toml"
    path.write_text(f'{text[:start]}finish = "ground N6"\n\n{text[end:]}', encoding="utf-8")
    replaced = read_rig(path).replace("contact.roughness.finish", "N8")
    changed = read_rig(path, changes=["contact.roughness.finish=N8"])
    same(replaced.contact.roughness, changed.contact.roughness)
    assert dict(replaced.assumptions) == dict(changed.assumptions)
    assert {key: one.text for key, one in replaced.uncertainty.items()} == {
        key: one.text for key, one in changed.uncertainty.items()
    }
