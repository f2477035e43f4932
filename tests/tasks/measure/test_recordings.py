"""Tasks that measure recordings by stand-ins of their sheets: what is compared, joined, refused, and which settings."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pytest import MonkeyPatch, approx, raises
from tests.tasks.running import running

from sonolube.errors import InvalidInput, NoGroove
from sonolube.measurement.friction.stated_parts import StatedParts
from sonolube.report.blocks import Rows
from sonolube.report.measured.sheet import Sheet, Value
from sonolube.report.measurement import PinOnDiscSheet
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.measure import measured_files, recordings, spectra, worn_groove
from sonolube.tasks.measure.measured_files import MeasuredFiles, column_mapping, each_file
from sonolube.tasks.measure.recordings import friction
from sonolube.tasks.measure.spectra import StiffnessAnswer, stiffness
from sonolube.tasks.parameters import Call, File, Parameter
from sonolube.tasks.progress import watched


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("a", "b", "c"):
        (tmp_path / f"{name}.csv").write_text(name)
    return tmp_path


def sheet_of(path: Path, **_: Any) -> Sheet:
    if path.name == "b.csv":
        raise InvalidInput(f"{path}:\n is empty")
    return Sheet(title=path.name)


def titles(answer: MeasuredFiles) -> list[str]:
    return [sheet.title for sheet in answer.sheets]


def test_each_file_is_measured_by_itself_and_a_single_one_is_refused(folder: Path) -> None:
    told: list[tuple[str, int, int]] = []
    with watched(lambda *each: told.append(each), None):
        sheets, refused = each_file([folder], sheet_of, title="measuring")
    assert [sheet.title for sheet in sheets] == ["a.csv", "c.csv"]
    assert refused == {str(folder / "b.csv"): f"{folder / 'b.csv'}: is empty"}
    assert told == [(f"measuring: {name}.csv", place, 3) for place, name in enumerate("abc")]
    with raises(InvalidInput, match="is empty"):
        each_file(folder / "b.csv", sheet_of, title="")
    assert each_file([folder / "b.csv"], sheet_of, title="")[0] == []


def test_a_defect_at_one_file_loses_no_other_and_is_one_at_a_single_file(folder: Path) -> None:
    def measure(path: Path) -> Sheet:
        if path.name == "b.csv":
            raise ZeroDivisionError("by  zero")
        return Sheet(title=path.name)

    _, refused = each_file(folder, measure, title="")
    line = refused[str(folder / "b.csv")]
    assert line.startswith("a fault of sonolube itself, not of your input: ZeroDivisionError (by zero) in sonolube/")
    assert "please report it with this line" in line
    with raises(ZeroDivisionError):
        each_file([folder / "b.csv"], measure, title="")


def test_columns_are_read_by_a_mapping_or_by_the_parts_that_are_named() -> None:
    assert column_mapping(None) is None
    found = column_mapping(None, group="g", channels=["x"])
    assert found is not None
    assert (found.selection.group, found.selection.channels, found.selection.sections) == ("g", ("x",), ())
    own = column_mapping("umt", sections=["1"])
    bare = column_mapping("umt")
    assert own is not None
    assert bare is not None
    assert own.selection.sections == ("1",)
    assert own.selection.group == bare.selection.group


def test_settings_of_an_answer_are_the_arguments_that_change_its_numbers() -> None:
    arguments = {
        "files": ["a.csv"], "apply": [NamedBytes("x.csv", b""), Path("f/y.csv")], "window_time": 2.0, "count": 3,
        "text": "2 s", "flag": True, "off": False, "none": None, "empty": (), "step": {"1s": "2V"}, "names": ("a", "b"),
        "progress": print, "one": NamedBytes("z.csv", b""),
    }  # fmt: skip
    marks = {name: Parameter("") for name in arguments} | {
        "apply": File(""), "window_time": Parameter("", unit="s"), "text": Parameter("", unit="s"),
    }  # fmt: skip
    answer = MeasuredFiles(title="friction", sheets=(), refused={})
    assert answer._settings() == {}
    object.__setattr__(answer, "call", Call("friction", arguments, frozenset(), marks))
    assert answer._settings() == {
        "applied to": "x.csv, y.csv", "window time": "2.0 s", "count": "3", "text": "2 s", "flag": "True",
        "step": "1s=2V", "names": "a, b", "one": "z.csv",
    }  # fmt: skip


def test_an_answer_has_a_result_where_any_file_was_measured_and_the_conditions_of_its_test() -> None:
    value = Value("friction_force", "Friction", 1.5, "N")
    one = MeasuredFiles(title="friction", sheets=[Sheet(title="a", values=(value,))], refused={"b": "is empty"})
    assert (one.has_result, one.refusals()) == (True, {"b": "is empty"})
    assert one.dataset().attrs["refused"] == "is empty"
    assert one.dataset().attrs["measured"] == "friction"
    empty = MeasuredFiles(title="friction", sheets=[], refused={})
    assert (empty.has_result, empty.blocks()) == (False, [])
    test = PinOnDiscSheet(entries={"parameters": {"normal_load": "3N"}})
    stated = MeasuredFiles(title="friction", sheets=one.sheets, refused={}, test=test).blocks()
    place = stated.index("  Test parameters")
    assert stated[place - 1] == ""
    rows = stated[place + 1]
    assert isinstance(rows, Rows)
    assert rows.rows[0] == ("Load", "3N")
    assert MeasuredFiles(title="friction", sheets=[], refused={}, test=test).blocks() == []


@pytest.mark.parametrize("text", ["5s", "1s:2s:3s"])
def test_a_part_has_a_begin_and_an_end(text: str) -> None:
    assert recordings._span("5s: 55s", "part") == (5.0, 55.0)
    with raises(InvalidInput, match=f"^part '{text}' needs a begin and an end, such as 5s:55s$") as refused:
        recordings._span(text, "part")
    assert refused.value.key == "part"


def test_parts_of_a_recording_are_sorted_and_a_rest_may_be_alone() -> None:
    found = recordings._stated_parts("1s:9s", "0s:1s", {"6s:8s": "28V", "2s:4s": "0V"})
    assert (found.part, found.rests) == ((1.0, 9.0), ((0.0, 1.0),))
    assert found.steps == (((2.0, 4.0), 0.0), ((6.0, 8.0), 28.0))
    assert recordings._stated_parts(None, (), None) == StatedParts()
    assert recordings._stated_parts(None, ["0s:1s", "2s:3s"], None).rests == ((0.0, 1.0), (2.0, 3.0))


def test_a_motor_needs_its_constant_current_and_groove() -> None:
    with running(friction, torque_constant=0.5, idle_current=1.0, groove_diameter=0.05):
        found = recordings._motor(0.5, 1.0, 0.05)
        assert found is not None
        assert (found.torque_constant, found.idle_current, found.groove_diameter) == (0.5, 1.0, 0.05)
        for missing in ((0.5, None, 0.05), (0.5, 1.0, None)):
            with raises(InvalidInput, match=r"^torque_constant needs idle_current and groove_diameter"):
                recordings._motor(*missing)
        with raises(InvalidInput, match=r"^idle_current has no meaning without torque_constant"):
            recordings._motor(None, 1.0, 0.05)
    with running(friction):
        assert recordings._motor(None, None, None) is None


@pytest.fixture
def measured(folder: Path, monkeypatch: MonkeyPatch) -> Path:
    """Folder of files, whose sheets are made by stand-ins."""
    monkeypatch.setattr(recordings, "friction_sheet", sheet_of)
    monkeypatch.setattr(recordings, "joined_friction_sheet", lambda paths, settings: Sheet(title=f"all {len(paths)}"))
    monkeypatch.setattr(
        recordings, "comparison_sheet",
        lambda ours, others: Sheet(title=f"{[s.title for s in ours]} over {[s.title for s in others]}"),
    )  # fmt: skip
    monkeypatch.setattr(recordings, "calibration_sheet", sheet_of)
    monkeypatch.setattr(recordings, "calibrated_hysteresis", lambda path, settings: path.name)
    monkeypatch.setattr(
        recordings, "force_sheet", lambda path, calibration, settings: Sheet(title=f"{path.name} by {calibration}")
    )
    monkeypatch.setattr(recordings, "vibration_sheet", sheet_of)
    monkeypatch.setattr(recordings, "has_voltage", lambda sheet: sheet.title != "c.csv")
    monkeypatch.setattr(recordings, "proportion_sheet", lambda sheets: Sheet(title=f"of {len(sheets)}"))
    return folder


def test_tests_are_joined_where_none_is_refused_and_compared_as_the_joined_one(measured: Path) -> None:
    a, b, c = (measured / f"{name}.csv" for name in "abc")
    assert titles(friction([a, c])) == ["a.csv", "c.csv"]
    assert titles(friction([a, c], join=True)) == ["a.csv", "c.csv", "all 2"]
    found = friction([a, b], join=True)
    assert (titles(found), list(found.refused)) == (["a.csv"], [str(b)])
    assert titles(friction([a], without_vibration=[c])) == ["a.csv", "c.csv", "['a.csv'] over ['c.csv']"]
    joined = friction([a, c], join=True, without_vibration=[c])
    assert titles(joined) == ["a.csv", "c.csv", "all 2", "c.csv", "['all 2'] over ['c.csv']"]
    alone = friction([a], without_vibration=[b])
    assert (titles(alone), list(alone.refused)) == (["a.csv"], [str(b)])
    with raises(InvalidInput, match=r"^join: part, rest and step are of one recording$"):
        friction([a], join=True, rest=["0s:1s"])


def test_files_that_cannot_be_joined_are_refused_as_one_test(measured: Path, monkeypatch: MonkeyPatch) -> None:
    def refuse(paths: Any, settings: Any) -> Sheet:
        raise InvalidInput("no common\nchannel")

    monkeypatch.setattr(recordings, "joined_friction_sheet", refuse)
    found = friction([measured / "a.csv", measured / "c.csv"], join=True)
    assert found.refused == {"all files as one test": "no common channel"}


def test_forces_are_by_one_calibration(measured: Path) -> None:
    a, c = measured / "a.csv", measured / "c.csv"
    assert titles(recordings.calibration([a], apply=[c])) == ["a.csv", "c.csv by a.csv"]
    assert titles(recordings.calibration([a, c])) == ["a.csv", "c.csv"]
    with raises(InvalidInput, match=r"^apply needs one calibration, got 2 files$"):
        recordings.calibration([a, c], apply=[c])
    with raises(InvalidInput, match=r"^displacement_uncertainty has no meaning without apply"):
        recordings.calibration([a], displacement_uncertainty="1um")
    partly = recordings.calibration([a], apply=[c, measured / "a.csv"])
    assert len(partly.sheets) == 3


def test_proportion_to_the_voltage_needs_two_recordings_of_it(measured: Path) -> None:
    a, c, d = (measured / f"{name}.csv" for name in "acd")
    d.write_text("d")
    assert titles(recordings.vibration([a, c], frequency="1kHz")) == ["a.csv", "c.csv"]
    assert titles(recordings.vibration([a, d], frequency="1kHz")) == ["a.csv", "d.csv", "of 2"]


def test_a_temperature_response_ends_after_its_start(folder: Path, monkeypatch: MonkeyPatch) -> None:
    asked: list[Any] = []

    def sheet(path: Path, *, settings: Any) -> Sheet:
        asked.append(settings)
        return Sheet(title=path.name)

    monkeypatch.setattr(recordings, "temperature_sheet", sheet)
    recordings.temperature([folder / "a.csv"], start_time="2s", end_time="9s", exponentials=2)
    assert (asked[0].start_time, asked[0].end_time, asked[0].exponentials) == (2.0, 9.0, 2)
    assert asked[0].without_vibration is None
    recordings.temperature([folder / "a.csv"], end_time="9s", without_vibration=folder / "c.csv")
    assert asked[1].without_vibration == folder / "c.csv"
    for end in ("2s", "1s"):
        with raises(InvalidInput, match=r"^end_time \d s must be later than start_time 2 s$"):
            recordings.temperature([folder / "a.csv"], start_time="2s", end_time=end)


STIFFNESS: Any = SimpleNamespace(modal_mass_deviation=0.1, vibration_amplitude=None, log_amplitude_deviation=0.05)
OWN: Any = SimpleNamespace(normal_load=5.0, assumptions={"structure.tip_mass": "a", "stack.x": "b", "contact.y": "c"})


def test_a_stiffness_is_at_the_load_given_or_that_of_the_rig() -> None:
    assert spectra._normal_load(OWN, 40.0) == approx(40.0)
    assert spectra._normal_load(OWN, None) == approx(5.0)
    with raises(InvalidInput, match=r"^rig is missing; give the rig, or load and modal_mass$"):
        spectra._normal_load(None, None)


def test_a_stiffness_says_what_to_write_and_what_it_rests_on() -> None:
    sheet = Sheet(title="stiffness", caveats=("drift",), values=(Value("normal_stiffness", "k", 1.5e6, "N/m"),))
    answer = StiffnessAnswer(rig=OWN, sheet=sheet, rig_lines=["k = 1"], name="n", settings=STIFFNESS)
    assert list(answer.blocks())[-2:] == ["  for the rig file:", "    k = 1"]
    assert (answer.object()["rig_lines"], answer.caveats()) == (["k = 1"], ("drift",))
    mass = {"modal mass": "known within 10%; the stiffness is proportional to it"}
    assert answer.assumptions() == mass | {"structure.tip_mass": "a", "stack.x": "b"}
    at: Any = SimpleNamespace(**(vars(STIFFNESS) | {"vibration_amplitude": 1e-6}))
    bare = StiffnessAnswer(rig=None, sheet=sheet, rig_lines=[], name="n", settings=at)
    assert bare.assumptions() == mass | {"amplitude": "known within 5%"}
    assert "  for the rig file:" not in bare.blocks()


def test_a_stiffness_takes_its_uncertainties_or_a_tenth_and_a_twentieth(folder: Path, monkeypatch: MonkeyPatch) -> None:
    asked: list[Any] = []

    def sheet(free: Path, pressed: Path, *, settings: Any, again: Any, large: Any) -> Any:
        asked.append((free.name, pressed.name, settings, again, large))
        return Sheet(title="s"), ["line"]

    monkeypatch.setattr(spectra, "contact_stiffness_sheet", sheet)
    a, b, c = (folder / f"{name}.csv" for name in "abc")
    found = stiffness(a, b, load="40N", modal_mass="2kg")
    free, pressed, settings, again, large = asked[0]
    assert (free, pressed, again, large, found.name) == ("a.csv", "b.csv", None, None, "b-stiffness")
    assert (settings.normal_load, settings.modal_mass, settings.modal_mass_deviation) == approx((40.0, 2.0, 0.1))
    assert (settings.log_amplitude_deviation, settings.structure) == (approx(0.05), None)
    stiffness(a, b, c, load=3.0, modal_mass=1.0, mass_uncertainty="20 %", large=c, amplitude="2.5um",
              amplitude_uncertainty="15 %", mode_near="150Hz", pressed_near="170Hz")  # fmt: skip
    settings = asked[1][2]
    assert (asked[1][3], asked[1][4]) == (c, c)
    assert (settings.modal_mass_deviation, settings.log_amplitude_deviation) == approx((0.2, 0.15))
    assert (settings.vibration_amplitude, settings.mode_near, settings.pressed_near) == approx((2.5e-6, 150.0, 170.0))
    with raises(InvalidInput, match=r"^amplitude is missing; large needs the amplitude at the contact"):
        stiffness(a, b, load=3.0, modal_mass=1.0, large=c)
    with raises(InvalidInput, match=r"^amplitude has no meaning without large, whose amplitude it is"):
        stiffness(a, b, load=3.0, modal_mass=1.0, amplitude="1um")


@pytest.fixture
def scans(folder: Path, monkeypatch: MonkeyPatch) -> Path:
    """Folder of scans, of which b has no groove."""

    def groove_sheet(path: Path, *, settings: Any, track_number: Any) -> Any:
        if path.name == "b.csv":
            raise NoGroove("nothing worn")
        return Sheet(title=path.name), f"groove of {path.name}"

    def ring_sheet(title: str, grooves: Any, *, settings: Any) -> Any:
        return Sheet(title=f"{title}: {[name for name, _ in grooves]} at {settings.tip_radius}"), title

    monkeypatch.setattr(worn_groove, "groove_sheet", groove_sheet)
    monkeypatch.setattr(worn_groove, "ring_sheet", ring_sheet)
    monkeypatch.setattr(worn_groove, "cap_sheet", lambda path, settings, tip_radius: Sheet(title=f"cap {tip_radius}"))
    monkeypatch.setattr(
        worn_groove, "wear_reduction_sheet", lambda without, within: Sheet(title=f"{within} less {without}")
    )
    return folder


RING: dict[str, Any] = {"groove_diameter": "50mm", "sliding_distance": "292m"}


def test_a_ring_needs_its_diameter_and_distance_and_two_rings_are_compared(scans: Path) -> None:
    a, b, c = (scans / f"{name}.csv" for name in "abc")
    assert titles(worn_groove.groove([a])) == ["a.csv"]
    ring = titles(worn_groove.groove([a, b], **RING, tip_radius="5mm"))
    assert ring == ["a.csv", "the ring: ['a.csv', 'b.csv'] at 0.005"]
    assert titles(worn_groove.groove([b], **RING)) == []
    both = titles(worn_groove.groove([a], without_vibration=[c], **RING))
    assert both[-1] == "['the ring'] less ['the ring without vibration']"
    assert titles(worn_groove.groove([a], pin=[c], tip_radius="5mm"))[-1] == "cap 0.005"
    for given in ({"groove_diameter": "50mm"}, {"sliding_distance": "1m"}, {"without_vibration": [c]}):
        with raises(InvalidInput, match=r"^a ring needs groove_diameter and sliding_distance; without_vibration is"):
            worn_groove.groove([a], **given)
    with raises(InvalidInput, match=r"^tip_radius has no meaning without a ring or pin"):
        worn_groove.groove([a], tip_radius="5mm")


def test_a_ring_that_cannot_be_measured_says_why_beside_its_scans(scans: Path, monkeypatch: MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> Any:
        raise InvalidInput("scans differ")

    monkeypatch.setattr(worn_groove, "ring_sheet", refuse)
    found = worn_groove.groove([scans / "a.csv"], **RING)
    assert titles(found) == ["a.csv", "the ring"]
    assert found.sheets[1].not_found == ("scans differ",)
    assert measured_files.reason_of(InvalidInput("two\n lines")) == "two lines"
