"""Tables of runs as programs save them: encodings, separators, headings, mappings, and refusals in one line."""

import csv
from pathlib import Path

import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.measured_runs import read_runs, run_caveats
from sonolube.measurement.recordings.mapping import mapping_toml, read_mapping
from sonolube.measurement.run_headings import likely_statements, meaning, meaning_at_stake, run_heading
from sonolube.measurement.run_numbers import cell_number, decimal_sign_of
from sonolube.measurement.run_table import run_table
from sonolube.text.units import to_si
from sonolube.vocabulary import quantities

EXAMPLES = Path(__file__).parents[2] / "examples"
SHARED = Path(__file__).parents[3] / "shared" / "data" / "friction"
ROWS = (
    ("Versuch", "Geschwindigkeit (mm/s)", "Amplitude [µm]", "Normalkraft / N", "friction ratio"),
    ("a", "20.5", "2.25", "3", "0.5"),
    ("b", "41", "", "3", "0.75"),
)


def text(separator: str, sign: str) -> str:
    return "\n".join(separator.join(cell.replace(".", sign) for cell in row) for row in ROWS) + "\n"


def written(folder: Path, content: str | bytes, name: str = "runs.csv") -> Path:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize(("separator", "sign"), [(",", "."), (";", "."), (";", ","), ("\t", ",")])
@pytest.mark.parametrize("preamble", ["", '# Messung 3\n\n% "a;b"\n', "sep={}\n"])
def test_a_table_is_the_same_however_it_was_saved(
    encoding: str, separator: str, sign: str, preamble: str, tmp_path: Path
) -> None:
    content = preamble.format(separator) + text(separator, sign)
    runs = read_runs(written(tmp_path, content.encode(encoding)))
    assert runs["sliding_speed"].to_numpy() == approx([0.0205, 0.041])
    assert runs["vibration_amplitude"].to_numpy() == approx([2.25e-6, float("nan")], nan_ok=True)
    assert runs["normal_load"].to_numpy() == approx([3, 3])
    assert runs["friction_reduction"].to_numpy() == approx([0.5, 0.25])
    assert list(runs["run"].to_numpy()) == ["a", "b"]
    assert all("Windows-1252" in caveat for caveat in run_caveats(runs))


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*-runs.csv")), ids=lambda path: path.name)
def test_example_tables_have_the_numbers_of_a_plain_reading(path: Path) -> None:
    with path.open(newline="") as stream:
        heads, *rows = csv.reader(stream)
    runs = read_runs(path)
    for place, head in enumerate(heads):
        name, _, unit = head.rstrip("]").partition(" [")
        expected = [to_si(f"{row[place]} {unit}", unit=quantities()[name].unit, name=name) for row in rows]
        assert runs[name].to_numpy().tolist() == approx(expected, rel=1e-15)


@pytest.mark.skipif(not SHARED.is_dir(), reason="files of instruments are not here")
def test_a_table_of_an_instrument_without_runs_is_refused_in_one_line() -> None:
    for path in sorted(SHARED.glob("*.csv")):
        with raises(InvalidInput, match=str(path)) as refusal:
            read_runs(path)
        assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("label", "name", "unit"),
    [
        ("sliding_speed [mm/s]", "sliding_speed", "mm/s"),
        ("Load [N]", "normal_load", "N"),
        ("Normal force (N)", "normal_load", "N"),
        ("normal_force [N]", "normal_force", "N"),
        ("Geschwindigkeit (mm/s)", "sliding_speed", "mm/s"),
        ("speed / mm s-1", "sliding_speed", "mm s-1"),
        ("speed, mm/s", "sliding_speed", "mm/s"),
        ("speed mm/s", "sliding_speed", "mm/s"),
        ("Reibkraft in mN", "friction_force", "mN"),
        ("load_N", "normal_load", "N"),
        ("SLIDING SPEED (mm·s⁻¹)", "sliding_speed", "mm·s⁻¹"),
        ("µ", "friction_coefficient", ""),
        ("μ [-]", "friction_coefficient", "-"),
        ("Friction reduction (%)", "friction_reduction", "%"),
        ("Reibungsminderung %", "friction_reduction", "%"),
        ("Friction-ratio", "friction_ratio", ""),
        ("Reibkraft (ohne Ultraschall)", "intrinsic_friction_force", ""),
        ("Flächenpressung [MPa]", "nominal_pressure", "MPa"),
        ("Reibkraft (ohne Ultraschall) [N]", "intrinsic_friction_force", "N"),
        ("Temperatur [°C]", "temperature", "°C"),
        ("COF on", "friction_coefficient", ""),
        ("mu_0", "intrinsic_friction_coefficient", ""),
        ("Reibkraft ohne [N]", "intrinsic_friction_force", "N"),
        ("Friction w/o US [N]", "intrinsic_friction_force", "N"),
        ("F on / N", "friction_force", "N"),
        ("[Vpp]", "voltage_peak_to_peak", "V"),
        ("Spannung [Vss]", "voltage_peak_to_peak", "V"),
    ],
)
def test_headings_name_their_quantity_and_unit(label: str, name: str, unit: str) -> None:
    found = run_heading(label)
    assert found is not None
    assert (found.name, found.unit) == (name, unit)


@pytest.mark.parametrize(
    ("label", "statement"),
    [
        ("Amplitude pp [um]", "vibration_amplitude um pp"),
        ("Amplitude zero-to-peak [um]", "vibration_amplitude um"),
        ("Auslenkung Spitze-Spitze (µm)", "vibration_amplitude µm pp"),
        ("a [um p-p]", "vibration_amplitude um pp"),
        ("Drive voltage 0-p [V]", "voltage_peak_to_peak V 0-p"),
    ],
)
def test_headings_say_between_which_peaks_and_their_statements_are_read_back(label: str, statement: str) -> None:
    found = run_heading(label)
    assert found is not None
    assert found.statement == statement
    assert meaning(statement, label) == found


def test_statements_that_are_no_quantity_are_answered_by_likely_ones() -> None:
    with raises(InvalidInput, match=r"'voltage V' is no quantity; did you mean voltage_peak_to_peak V\?") as refusal:
        meaning("voltage V", "Spannung")
    assert len(str(refusal.value)) < 100
    assert likely_statements("applied load")[0] == "normal_load N"


@pytest.mark.parametrize(
    ("cell", "sign", "value", "digit"),
    [
        ("0.30", ".", 0.3, 0.01),
        ("28", ".", 28.0, 1.0),
        ("1,50e3", ",", 1500.0, 10.0),
        ("5'000.0", ".", 5000.0, 0.1),
        ("1.000,5", ",", 1000.5, 0.1),
        ("38 %", ".", 38.0, 1.0),
    ],
)
def test_numbers_have_the_worth_of_their_last_digit(cell: str, sign: str, value: float, digit: float) -> None:
    found = cell_number(cell, sign=sign)
    assert found is not None
    assert (found.value, found.digit) == approx((value, digit))


@pytest.mark.parametrize(
    ("cells", "sign"),
    [
        (["5,000", "200.0"], "."),
        (["5.000", "0,52"], ","),
        (["1.000.000", "5.000"], ","),
        (["1,000.125"], "."),
        (["0.125", "5"], "."),
        (["1.2.3"], "."),
        ([], "."),
    ],
)
def test_the_decimal_sign_is_that_of_numbers_that_cannot_have_thousands(cells: list[str], sign: str) -> None:
    assert decimal_sign_of(cells, Path("runs.csv")) == sign


@pytest.mark.parametrize("cell", ["", "x", "<0.1", "2.1.3", "1 2", "12.03.2026", "0.2 ± x"])
def test_other_cells_hold_no_number(cell: str) -> None:
    assert cell_number(cell, sign=".") is None


def test_digits_of_forces_give_the_resolution_of_their_ratio(tmp_path: Path) -> None:
    # half a digit over sqrt(3) is 0.0028868 N for 0.52 and 0.028868 N for 1.0; r = 0.52:
    # u = sqrt(0.0028868^2 + (0.52 * 0.028868)^2) / 1.0 = 0.015286
    runs = read_runs(written(tmp_path, "friction_force [N],intrinsic_friction_force [N]\n0.52,1.0\n"))
    assert float(runs["friction_reduction_resolution"][0]) == approx(0.015286, rel=1e-4)
    ratios = read_runs(written(tmp_path, "friction_ratio\n0.30\n"))
    assert float(ratios["friction_reduction_resolution"][0]) == approx(0.005 / 3**0.5)


HEADS = "Load [N],Speed [mm/s],Amplitude [um],COF on,COF off"


@pytest.mark.parametrize(
    "content",
    [
        f"# {HEADS}\n5.0,200,1.0,0.3,0.4\n",  # as numpy writes headings
        "Normal load FN [N],sliding velocity v_s [mm/s],amplitude a [um],COF on,COF off\n5.0,200,1.0,0.3,0.4\n",
        f"time,{HEADS}\n12:03,5.0,200,1.0,0.3,0.4\n",
        "Load [N],Speed [mm/s],Amplitude [um],Mode,COF\n5.0,200,1.0,without US,0.4\n5.0,200,1.0,with US,0.3\n",
        "Load [N],Speed [mm/s],Amplitude [um],F on [N],F off [N]\n5.0,200,1.0,-1.5,-2.0\n",
    ],
)
def test_other_habits_of_tables_are_read(content: str, tmp_path: Path) -> None:
    runs = read_runs(written(tmp_path, content))
    found = {name: float(runs[name][0]) for name in ("normal_load", "sliding_speed", "vibration_amplitude")}
    assert found == approx({"normal_load": 5.0, "sliding_speed": 0.2, "vibration_amplitude": 1e-6})
    assert 1 - runs["friction_reduction"].to_numpy() == approx([0.75])


def test_turned_signs_and_times_of_the_day_are_said(tmp_path: Path) -> None:
    text = "time,F on [N],F off [N]\n12:03,-1.5,-2.0\n"
    said = run_caveats(read_runs(written(tmp_path, text)))
    assert said == (
        "1 column is left out: 'time'",
        "no friction force is positive: the sign is taken as that of the sensor, and turned",
    )


def test_other_headings_of_the_vocabulary_belong_to_one_quantity_each() -> None:
    every = [each.casefold() for known in quantities().values() for each in known.also]
    assert len(every) == len(set(every))
    assert not set(every) & set(quantities())


def test_unknown_columns_are_left_out_with_one_caveat(tmp_path: Path) -> None:
    content = "Operator,friction_ratio,Humidity [%],#\nAnn,0.5,40,1\n"
    runs = read_runs(written(tmp_path, content))
    assert run_caveats(runs) == ("3 columns are left out: 'Operator', 'Humidity [%]', '#'",)
    assert set(runs.data_vars) == {"friction_ratio", "friction_reduction", "friction_reduction_resolution"}


@pytest.mark.parametrize(
    ("head", "row", "message"),
    [
        ("Richtung", "längs", "line 1: column 'Richtung' .* looks like a direction; map it"),
        ("Direction", "along", "column 'Direction' .* a direction"),
        ("Schmierstoff", "PAO", "column 'Schmierstoff' .* a lubricant"),
        ("Oil", "PAO", "column 'Oil' .* a lubricant"),
        ("Einheit", "N", "column 'Einheit' .* a unit"),
        ("mm/s", "3", "column 'mm/s' .* a unit"),
        ("Voltage [V]", "3", r"a setting.* --column 'Voltage \[V\]=voltage_peak_to_peak V'\)"),
        ("Schwingweite [um]", "3", r"'Schwingweite \[um\]=vibration_amplitude um pp' or '.*=vibration_amplitude um'"),
        ("F [N]", "3", r"looks like a force; map it .*'F \[N\]=normal_load N'"),
        ("Load", "3", "line 1: column 'Load' has no unit; expected a force"),
        ("Load [kilo]", "3", r"line 1: column 'Load \[kilo\]'.*unknown unit 'kilo'"),
        ("speed [rpm]", "3", r"line 1: column 'speed \[rpm\]'.* a frequency; expected a speed"),
        ("Load [N]", "x", r"line 2: column 'Load \[N\]' 'x' is no number"),
        ("Load [N]", "1e31", r"line 2: column 'Load \[N\]' '1e31' lies beyond any run"),
        ("Load [N];normal_load [N]", "1;2", "two columns are named normal_load, 'Load "),
        ("", "1", "column 1 has no heading"),
    ],
)
def test_columns_that_change_a_run_are_refused_by_name(head: str, row: str, message: str, tmp_path: Path) -> None:
    path = written(tmp_path, f"{head};friction_ratio\n{row};0.5\n")
    with raises(InvalidInput, match=message) as refusal:
        read_runs(path)
    assert str(refusal.value).startswith(f"{path}: ")
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"PK\x03\x04" + bytes(100), "save the table as CSV"),
        (bytes(100), "not a table"),
        (b"friction_ratio\n", "needs a head and at least one run"),
        (b"", "is empty"),
        (b"# only a comment\n", "no column names"),
        (b"friction_ratio\n0.5\n0,7\n", "line 3: friction_ratio '0,7' is no number with the decimal sign"),
    ],
)
def test_what_is_no_table_is_refused(content: bytes, message: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match=message):
        read_runs(written(tmp_path, content))


def test_a_mapping_names_columns_calibrates_them_and_leaves_others_out(tmp_path: Path) -> None:
    path = written(tmp_path, "Nummer;Kraft MW;Kraft 0;v [mm/s];Richtung\n1;0,5;1,0;20;x\n")
    mapping = written(
        tmp_path,
        '[channels.run]\ncolumn = "Nummer"\n[channels.friction_force]\ncolumn = ["F", "Kraft MW"]\nunit = "N"\n'
        'gain = 2.0\noffset = -0.4\n[channels.intrinsic_friction_force]\ncolumn = "Kraft 0"\nunit = "kN"\n'
        '[channels.sliding_speed]\ncolumn = "v [mm/s]"\n[selection]\nwithout = ["Richtung"]\n',
        "mapping.toml",
    )
    with raises(InvalidInput, match="column 'Richtung'"):
        read_runs(path)
    runs = read_runs(path, mapping=mapping)
    assert float(runs["friction_force"][0]) == approx(0.6)
    assert float(runs["intrinsic_friction_force"][0]) == approx(1000)
    assert float(runs["sliding_speed"][0]) == approx(0.02)
    assert str(runs["run"][0].item()) == "1"
    assert run_caveats(runs) == ("1 column is left out: 'Richtung'",)


def test_a_mapping_of_a_column_that_is_not_there_is_refused_by_name(tmp_path: Path) -> None:
    mapping = written(tmp_path, '[channels.friction_force]\ncolumn = "Kraft"\n', "mapping.toml")
    with raises(InvalidInput, match="has no column 'Kraft'"):
        read_runs(written(tmp_path, "friction_ratio\n0.5\n"), mapping=mapping)


@pytest.mark.parametrize("path", sorted((EXAMPLES / "mappings").glob("*.toml")), ids=lambda path: path.name)
def test_a_mapping_that_is_written_is_read_back(path: Path, tmp_path: Path) -> None:
    known = read_mapping(path)
    assert read_mapping(written(tmp_path, mapping_toml(known), path.name)) == known


@given(label=st.text(max_size=60))
def test_any_heading_is_known_or_not(label: str) -> None:
    found = run_heading(label)
    assert found is None or found.name
    assert isinstance(meaning_at_stake(label), str)


TABLE = "Versuch;Normalkraft [N];v [mm/s];Amplitude [um];Reibkraft [N]\n"


def test_rows_that_summarise_others_are_no_runs_and_said(tmp_path: Path) -> None:
    rows = "1;5,0;200;0;2,10\n2;5,0;200;1,0;1,72\nMittelwert;5,0;200;0,5;1,91\nStd.;0;0;0,5;0,19\n"
    table = run_table(written(tmp_path, TABLE + rows))
    assert table.columns["friction_force"] == approx([2.10, 1.72])
    assert table.caveats[:2] == ("line 4 is no run and left out: 'Mittelwert'", "line 5 is no run and left out: 'Std.'")
    with raises(InvalidInput, match="needs a head and at least one run"):
        read_runs(written(tmp_path, f"{TABLE}Mean;5,0;200;0,5;1,91\n"))


def test_a_mark_that_may_separate_thousands_is_refused_with_both_readings(tmp_path: Path) -> None:
    path = written(tmp_path, "Normalkraft [mN];v [um/s];Amplitude [nm];Reibkraft [mN]\n5.000;200.000;1.000;1.720\n")
    with raises(InvalidInput, match=r"'5\.000' may be 5 or 5000: .* sonolube mapping FILE --decimal-sign ','"):
        read_runs(path)
    for sign, load in ((",", 5.0), (".", 5e-3)):
        mapping = written(tmp_path, f'[text]\ndecimal_sign = "{sign}"\n', "sign.toml")
        assert run_table(path, mapping=read_mapping(mapping)).columns["normal_load"] == approx([load])


def test_thousands_beside_a_decimal_sign_are_read(tmp_path: Path) -> None:
    table = run_table(written(tmp_path, "Normalkraft [mN];v [mm/s];Reibkraft [mN]\n5.000,5;200,0;1.720,0\n"))
    assert table.columns["normal_load"] == approx([5.0005])
    assert table.columns["friction_force"] == approx([1.72])


COEFFICIENTS = "Normalkraft in N\tGeschwindigkeit in mm/s\tAmplitude in \u00b5m\tReibungszahl\n"


def test_coefficients_of_friction_give_ratios_by_the_rows_without_vibration(tmp_path: Path) -> None:
    rows = "5,000\t200,0\t0,00\t0,4200\n5,000\t200,0\t1,00\t0,3440\n5,000\t200,0\t2,00\t0,2600\n"
    runs = read_runs(written(tmp_path, COEFFICIENTS + rows))
    assert runs["friction_reduction"].values == approx([1 - 0.344 / 0.42, 1 - 0.26 / 0.42])


def test_coefficients_without_a_load_and_in_two_columns_give_ratios(tmp_path: Path) -> None:
    runs = read_runs(written(tmp_path, "v [mm/s],Amplitude [um],COF on,COF off\n20,1,0.2,0.5\n20,2,0.1,0.4\n"))
    assert runs["friction_reduction"].values == approx([0.6, 0.75])
    assert "friction_force" not in runs
    with raises(InvalidInput, match=r"line 2: intrinsic_friction_coefficient must be positive, got -0\.5"):
        read_runs(written(tmp_path, "v [mm/s],Amplitude [um],COF on,COF off\n20,1,0.2,-0.5\n"))


def test_a_row_of_units_below_the_headings_gives_them(tmp_path: Path) -> None:
    text = "Versuch;Normalkraft;Geschwindigkeit;Amplitude;Reibkraft\n;N;mm/s;\u00b5m;mN\nV1;5,0;200,0;1,0;2100,0\n"
    table = run_table(written(tmp_path, text))
    found = {name: float(values[0]) for name, values in table.columns.items()}
    assert found == approx({"normal_load": 5, "sliding_speed": 0.2, "vibration_amplitude": 1e-6, "friction_force": 2.1})
    assert table.texts["run"] == ["V1"]


def test_an_amplitude_named_zero_to_peak_is_that_of_the_vibration(tmp_path: Path) -> None:
    text = "Last [N];v [mm/s];Amplitude zero-to-peak [um];FR [N]\n5,0;200,0;1,5;1,9\n"
    found = run_table(written(tmp_path, text)).columns
    assert (float(found["vibration_amplitude"][0]), float(found["friction_force"][0])) == approx((1.5e-6, 1.9))
