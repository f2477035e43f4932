"""Exports of tribometers by the mappings of the package; synthetic files in the forms that the mappings cite."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping, Selection, TextLayout, read_mapping
from sonolube.measurement.recordings.reader import instrument_mappings, mapping_by_name, read_recording

GRAVITY = 9.80665e-3  # N of a gram-force

UMT_STEP = """Step No. {number}

Step Type Code: 0
Radius       = 4.0
Data Count   = 3
Started at: 12:21:{second} 12 May 2022

Fx,Fz,Z,T,Ff,COF
{unit},{unit},mm,sec,{unit},

{rows}

"""
UMT_HEAD = (
    "Created by CETR Data Viewer ver.2 05/12/22\nCreated by CETR UMT ver.1\nTotal number of steps = 2\n\nRun # 1\n"
)


def umt_file(path: Path, *, unit: str = "g", tail: str = "", newline: str = "\n") -> Path:
    rows = (
        "-10,-100,0.1,0.00,10,0.1\n-20,-100,0.1,0.02,20,0.2\n-30,-100,0.1,0.04,30,0.3",
        "40,-100,0.1,0.00,40,0.4\n50,-100,0.1,0.02,50,0.5",
    )
    steps = [
        UMT_STEP.format(number=number, second=second, unit=unit, rows=part)
        for number, second, part in zip((1, 2), ("58.000", "59.500"), rows, strict=True)
    ]
    path.write_bytes((UMT_HEAD + "".join(steps) + tail).replace("\n", newline).encode())
    return path


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_an_export_of_a_umt_is_recognised_and_its_steps_are_joined_by_their_clock(tmp_path: Path, newline: str) -> None:
    recording = read_recording(umt_file(tmp_path / "run.csv", newline=newline))
    assert recording["time"].to_numpy() == approx([0, 0.02, 0.04, 1.5, 1.52])
    assert recording["friction_force"].to_numpy() == approx(GRAVITY * np.array([10, 20, 30, 40, 50]))
    assert recording["normal_load"].to_numpy() == approx(100 * GRAVITY)
    assert recording["friction_coefficient"].to_numpy() == approx([0.1, 0.2, 0.3, 0.4, 0.5])
    assert recording["friction_force"].attrs["source_unit"] == "g (gf)"
    assert recording.attrs["mapping"] == "umt"
    assert recording.attrs["begun"] == "2022-05-12 12:21:58"


@pytest.mark.parametrize(("sections", "force"), [(("2",), [40, 50]), (("Step No. 1",), [10, 20, 30])])
def test_steps_are_chosen_by_number_or_name(tmp_path: Path, sections: tuple[str, ...], force: list[float]) -> None:
    chosen = RecordingMapping(channels={}, selection=Selection(sections=sections))
    recording = read_recording(umt_file(tmp_path / "run.csv", unit="N"), mapping=chosen)
    assert recording["friction_force"].to_numpy().tolist() == force
    assert recording["time"].to_numpy()[0] == 0


def test_a_step_that_is_not_there_is_refused_with_those_that_are(tmp_path: Path) -> None:
    chosen = RecordingMapping(channels={}, selection=Selection(sections=("3",)))
    with raises(InvalidInput, match=r"has no section '3'; its 2 are Step No\. 1, Step No\. 2"):
        read_recording(umt_file(tmp_path / "run.csv"), mapping=chosen)


def test_tables_after_the_steps_are_not_read_and_that_is_said(tmp_path: Path) -> None:
    path = umt_file(tmp_path / "run.csv", tail="Statistics\nmean,max\n0.3,0.5\n")
    recording = read_recording(path)
    assert recording.sizes["time"] == 5
    assert recording.attrs["caveats"] == "3 lines after the end of a table are not read"


def test_steps_of_other_columns_must_be_chosen(tmp_path: Path) -> None:
    path = umt_file(tmp_path / "run.csv")
    first, second = path.read_text().split("Step No. 2")
    path.write_text(first + "Step No. 2" + second.replace("g,g,mm,sec,g", "N,N,mm,sec,N"))
    with raises(InvalidInput, match=r"section 'Step No\. 2' has other columns or units.*--section"):
        read_recording(path)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
@pytest.mark.parametrize("sign", [".", ","])
def test_an_export_of_an_anton_paar_tribometer_is_recognised(tmp_path: Path, encoding: str, sign: str) -> None:
    labels = (
        "Time [s]\tDistance [m]\tLaps\tSequence ID\tCycle ID\tMax Linear Speed [m/s]\tNominal Load [N]\tµ\tAngle [°]\t"
        "Friction Force [N]\tTemperature [°C]\tHumidity [%]\tPenetration Depth [µm]"
    )
    rows = "".join(f"{t}\t{t}\t1\t1\t1\t0.5\t2.0\t0.2{t}\t9.0\t0.4{t}\t21.5\t40.0\t3.5\n" for t in range(3))
    text = f"TRB3 report\nOperator: Ümit\nSingle-way mode\n\n{labels}\n{rows.replace('.', sign)}"
    path = tmp_path / "export.txt"
    path.write_bytes(text.encode(encoding))
    recording = read_recording(path)
    assert recording.attrs["mapping"] == "anton-paar"
    assert recording["friction_coefficient"].to_numpy() == approx([0.20, 0.21, 0.22])
    assert recording["friction_force"].to_numpy() == approx([0.40, 0.41, 0.42])
    assert recording["normal_load"].to_numpy() == approx(2)
    assert recording["temperature"].to_numpy() == approx(294.65)


def test_a_nano_tribometer_states_millinewton(tmp_path: Path) -> None:
    path = tmp_path / "nano.txt"
    labels = (
        "Time [s]\tDistance [m]\tlaps\tSequence ID\tCycle ID\tMax linear speed [m/s]\tNominal Load [mN]\tµ\t"
        "Linear Position [mm]\tNormal force [mN]\tFriction force [mN]\tPenetration depth [µm]"
    )
    path.write_text(
        f"{labels}\n0\t0\t1\t1\t1\t0.01\t10\t0.5\t1.5\t9\t5\t0\n1\t1\t1\t1\t1\t0.01\t10\t0.5\t-1.5\t9\t5\t0\n"
    )
    recording = read_recording(path)
    assert recording["friction_force"].to_numpy() == approx(5e-3)
    assert recording["normal_load"].to_numpy() == approx(9e-3)  # measured, not nominal
    assert recording["displacement"].to_numpy() == approx([1.5e-3, -1.5e-3])


def test_exports_of_a_t_11_and_an_rtec_are_recognised(tmp_path: Path) -> None:
    (tmp_path / "t11.csv").write_text(
        "T-11\nTime [s];Friction force [N];Displacement [um];Temperature2 [C];Temperature1 [C];Rotational speed [rpm];"
        "Number of revolutions;\n0;1,5;10;20;25;60;0;\n1;2,5;11;20;25;60;1;\n"
    )
    recording = read_recording(tmp_path / "t11.csv")
    assert recording["friction_force"].to_numpy().tolist() == [1.5, 2.5]
    assert recording["displacement"].to_numpy() == approx([1e-5, 1.1e-5])
    assert recording["temperature"].to_numpy() == approx(298.15)
    assert recording["rotation_speed"].to_numpy() == approx(1)
    (tmp_path / "rtec.csv").write_text(
        "Step, Timestamp, RecipeStep, DAQ.Fz (N),DAQ.Fx (N),DAQ.COF (),Rotary.Velocity (rpm),XYZ.Z Depth (mm),\n"
        "1, 0.0, 1, 5.0,1.0,0.2,30,0,\n1, 0.1, 1, 5.0,1.5,0.3,30,0,\n"
    )
    recording = read_recording(tmp_path / "rtec.csv")
    assert recording["friction_force"].to_numpy().tolist() == [1, 1.5]
    assert recording["friction_coefficient"].to_numpy().tolist() == [0.2, 0.3]
    assert recording["normal_load"].to_numpy().tolist() == [5, 5]


def test_a_general_export_of_a_pin_on_disc_is_read_by_the_spellings_of_its_labels(tmp_path: Path) -> None:
    path = tmp_path / "export.csv"
    path.write_text("Pin on disc\nNo. 7\n\n# lab\nZeit [s];Reibkraft [N];Reibwert;Notiz\n0;1,25;0,5;a\n0,5;1,5;0,6;b\n")
    recording = read_recording(path, mapping=mapping_by_name("pin-on-disc"))
    assert recording["friction_force"].to_numpy().tolist() == [1.25, 1.5]
    assert recording["friction_coefficient"].to_numpy().tolist() == [0.5, 0.6]


@pytest.mark.parametrize("name", sorted(instrument_mappings()))
def test_the_mappings_of_the_package_cite_where_their_form_was_seen_or_are_general(name: str) -> None:
    path = Path(str(mapping_by_name(name).name))
    assert path.name == name
    text = (Path(read_mapping.__code__.co_filename).parent / "instruments" / f"{name}.toml").read_text(encoding="utf-8")
    assert "github.com/" in text or name == "pin-on-disc"


def test_an_unknown_mapping_is_refused_with_the_closest_name(tmp_path: Path) -> None:
    with raises(InvalidInput, match="umtt: no mapping of this name and no such file; did you mean umt"):
        mapping_by_name("umtt")
    with raises(InvalidInput, match="mappings are anton-paar, pin-on-disc, rtec, t-11, umt"):
        mapping_by_name("zeiss")
    with raises(InvalidInput, match=r"gone\.toml: no such file"):
        mapping_by_name(str(tmp_path / "gone.toml"))


def test_a_mapping_file_states_units_row_comments_header_and_sections(tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text(
        "[axis]\ncolumn = 'clock'\n[text]\nheader = '^clock'\nunits_row = true\ncomment = '%'\n"
        "section = '^Phase (.+)$'\nseparator = ';'\ndecimal_sign = ','\nencoding = 'cp1252'\n"
        "[selection]\nsections = ['running in', 'wear']\n"
        "[channels.friction_force]\ncolumn = 'F'\n[channels.displacement]\ncolumn = 'x'\n"
    )
    phase = "Phase {}\nnotes\nclock;F;x\nms;mN;µm\n{}\n% end\n"
    text = "".join(
        phase.format(name, f"0;{force},5;1\n10;{force},5;2")
        for name, force in (("running in", 1), ("rest", 2), ("wear", 3))
    )
    (tmp_path / "lab.txt").write_bytes(text.encode("cp1252"))
    recording = read_recording(tmp_path / "lab.txt", mapping=tmp_path / "lab.toml")
    assert recording["friction_force"].to_numpy() == approx([1.5e-3, 1.5e-3, 3.5e-3, 3.5e-3])
    assert recording["displacement"].to_numpy() == approx([1e-6, 2e-6, 1e-6, 2e-6])
    assert recording["time"].to_numpy() == approx([0, 0.01, 0.02, 0.03])  # ms, the second section after the first
    assert "restart" in recording.attrs["caveats"]


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("[text]\nsection = '('", r"section is '\(', which is no regular expression"),
        ("[text]\nunits_row = 3", "units_row must be a bool"),
        ("[text]\nunit_row = true", "did you mean units_row"),
        ("[selection]\nchannels = [1]", r"selection\.channels must be a text or a list of texts"),
        ("[channels.friction_force]\nunit = 'N'", r"friction_force\.column is missing"),
    ],
)
def test_a_wrong_layout_is_refused_with_its_key(tmp_path: Path, text: str, match: str) -> None:
    (tmp_path / "wrong.toml").write_text(text)
    with raises(InvalidInput, match=match):
        read_mapping(tmp_path / "wrong.toml")


def test_a_comma_as_decimal_sign_first_seen_late_is_understood(tmp_path: Path) -> None:
    path = tmp_path / "late.csv"
    path.write_text("time;friction_force;note\n" + "".join(f"{t};1;a.b\n" for t in range(40)) + "40;1,5;c.d\n")
    assert read_recording(path)["friction_force"].to_numpy()[-1] == 1.5


def test_the_layout_of_a_table_needs_no_mapping_of_columns(tmp_path: Path) -> None:
    path = tmp_path / "units.csv"
    path.write_text("time,friction_force\nms,mN\n0,1\n1,2\n")
    recording = read_recording(path, mapping=RecordingMapping(channels={}, text=TextLayout(units_row=True)))
    assert recording["time"].to_numpy() == approx([0, 1e-3])
    assert recording["friction_force"].to_numpy() == approx([1e-3, 2e-3])
