"""Impedance from every pair of parts by its formula, headings with units, and the records of instruments."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.headings import is_phase_without_unit, parse_heading
from sonolube.measurement.impedance.instruments import Hp4294A, KeysightE4990A, Mfia
from sonolube.measurement.impedance.parts import sweep_of_parts
from sonolube.measurement.impedance.spectrum import (
    ImpedanceSpectrum,
    ImpedanceSweep,
    passive_spectrum,
    read_impedance,
    sorted_by_frequency,
)
from sonolube.measurement.impedance.touchstone import Touchstone

OMEGA = 2 * np.pi * 1000.0
Z = 30 - 40j  # ohm: 50 ohm at -53.13 degrees
Y = 1 / Z  # 0.012 + 0.016j siemens


@pytest.mark.parametrize(
    ("pair", "values"),
    [
        (("R", "X"), (30.0, -40.0)),
        (("|Z|", "theta_Z"), (50.0, np.arctan2(-40, 30))),
        (("G", "B"), (0.012, 0.016)),
        (("|Y|", "theta_Y"), (0.02, np.arctan2(40, 30))),
        (("|Z|", "theta"), (50.0, np.arctan2(-40, 30))),
        (("|Z|", "theta_Y"), (50.0, np.arctan2(40, 30))),
        (("|Y|", "theta"), (0.02, np.arctan2(40, 30))),
        (("|Y|", "theta_Z"), (0.02, np.arctan2(-40, 30))),
        (("Ls", "R"), (-40 / OMEGA, 30.0)),
        (("Cs", "R"), (1 / (40 * OMEGA), 30.0)),
        (("Cs", "D"), (1 / (40 * OMEGA), 0.75)),
        (("Cs", "Q"), (1 / (40 * OMEGA), 4 / 3)),
        (("Ls", "D"), (-40 / OMEGA, 0.75)),
        (("Ls", "D"), (-40 / OMEGA, -0.75)),  # of the sign of the inductance
        (("Ls", "Q"), (-40 / OMEGA, -4 / 3)),
        (("Lp", "Rp"), (-1 / (0.016 * OMEGA), 1 / 0.012)),
        (("Cp", "Rp"), (0.016 / OMEGA, 1 / 0.012)),
        (("Cp", "G"), (0.016 / OMEGA, 0.012)),
        (("Cp", "D"), (0.016 / OMEGA, 0.75)),
        (("Cp", "Q"), (0.016 / OMEGA, 4 / 3)),
        (("Lp", "G"), (-1 / (0.016 * OMEGA), 0.012)),
        (("Lp", "D"), (-1 / (0.016 * OMEGA), 0.75)),
        (("Lp", "D"), (-1 / (0.016 * OMEGA), -0.75)),
        (("Lp", "Q"), (-1 / (0.016 * OMEGA), 4 / 3)),
        (("Rp", "Xp"), (1 / 0.012, -1 / 0.016)),
    ],
)
def test_every_pair_of_parts_gives_the_impedance(pair: tuple[str, str], values: tuple[float, float]) -> None:
    columns = {"f": np.array([1000.0]), pair[0]: np.array([values[0]]), pair[1]: np.array([values[1]])}
    found = sweep_of_parts(columns, pair, lines=np.array([7]))
    assert found.impedance == approx([Z])
    assert found.has_phase
    assert found.frequency.tolist() == [1000.0]
    assert found.lines.tolist() == [7]


def test_a_magnitude_alone_has_no_phase() -> None:
    of_z = sweep_of_parts({"f": np.ones(1), "|Z|": np.array([50.0])}, ("|Z|", "|Z|"), lines=np.array([1]))
    of_y = sweep_of_parts({"f": np.ones(1), "|Y|": np.array([0.02])}, ("|Y|", "|Y|"), lines=np.array([1]))
    assert (of_z.has_phase, of_y.has_phase) == (False, False)
    assert of_z.impedance == approx(of_y.impedance)


@pytest.mark.parametrize(
    ("text", "symbol", "scale"),
    [
        ("Frequency (kHz)", "f", 1e3),
        ("freq. [MHz]", "f", 1e6),
        ("phase (deg)", "theta", np.pi / 180),
        ("θ [°]", "theta", np.pi / 180),
        ("Phase(Z)/deg", "theta_Z", np.pi / 180),
        ("theta-y (rad)", "theta_Y", 1.0),
        ("Cp (pF)", "Cp", 1e-12),
        ("Cs / nF", "Cs", 1e-9),
        ("Ls (µH)", "Ls", 1e-6),
        ("Rp (GOhm)", "Rp", 1e9),
        ("B (mS)", "B", 1e-3),
        ("-Im(Z)", "X", -1.0),
        ("Z' / Ω", "R", 1.0),
        ("omega (rad/s)", "f", 1 / (2 * np.pi)),
    ],
)
def test_a_heading_names_its_quantity_and_the_value_of_its_unit(text: str, symbol: str, scale: float) -> None:
    found = parse_heading(text)
    assert found is not None
    assert found.symbol == symbol
    assert found.scale == approx(scale)


@pytest.mark.parametrize(
    ("text", "bare"),
    [
        ("phase", True),
        ("phase (V)", True),
        ("phase (deg)", False),
        ("|Z|", False),
        ("|Z| (V)", False),
        ("colour", False),
    ],
)
def test_a_phase_needs_an_angle_as_its_unit(text: str, bare: bool) -> None:
    assert is_phase_without_unit(text) == bare


def test_a_sweep_downwards_is_turned_with_its_lines_and_invalid_points_name_theirs() -> None:
    down = ImpedanceSweep(
        frequency=np.array([3.0, 2.0, 1.0]), impedance=np.array([3j, 2j, 1j]), lines=np.array([5, 6, 7])
    )
    up = sorted_by_frequency(down, path=Path("a.csv"))
    assert up.frequency.tolist() == [1, 2, 3]
    assert up.impedance.tolist() == [1j, 2j, 3j]
    assert up.lines.tolist() == [7, 6, 5]
    for frequency, impedance, words in (
        ([1.0, 0.0, 5.0], [1, 1, 1], "line 6: the frequency must be positive"),
        ([1.0, 1.0, 2.0], [1, 1, 1], "line 6: the frequency is not monotonic"),
        ([1.0, 2.0, 3.0], [1, 1, 1e-308], "line 7: the impedance of 1e-308 ohm is none that an instrument reads"),
        ([1.0, 2.0, 3.0], [1e308, 1, 1], "line 5: the impedance of 1e.308 ohm is none that an instrument reads"),
    ):
        sweep = ImpedanceSweep(
            frequency=np.array(frequency), impedance=np.array(impedance, complex), lines=np.array([5, 6, 7])
        )
        with raises(InvalidInput, match=f"a.csv: {words}"):
            sorted_by_frequency(sweep, path=Path("a.csv"))


def spectrum(conductance: list[float], *, has_phase: bool = True) -> ImpedanceSpectrum:
    admittance = np.array(conductance) + 0.5j
    return ImpedanceSpectrum(
        frequency=np.arange(1.0, admittance.size + 1), impedance=1 / admittance, has_phase=has_phase
    )


def test_a_spectrum_is_turned_where_nineteen_twentieths_of_its_conductance_are_negative() -> None:
    given = spectrum([-9.0, -10.0, 0.9, -0.1])  # 19.1 of 20
    turned, caveats = passive_spectrum(given)
    assert turned.impedance == approx(-given.impedance)
    assert "the conductance is negative at 75% of its points" in caveats[0]
    for same in (spectrum([-9.0, -9.9, 1.1]), spectrum([0.0, 0.0]), spectrum([-1.0, -1.0], has_phase=False)):
        kept, none = passive_spectrum(same)
        assert kept is same
        assert none == ()


@pytest.mark.parametrize(
    ("text", "impedance"),
    [
        ("# Hz Z RI R 50\n1 0.6 -0.8\n", 30 - 40j),
        ("# Hz Y RI R 50\n1 0.6 0.8\n", 50 / (0.6 + 0.8j)),
        ("[Version] 2.0\n# Hz Y RI R 50\n[Reference] 75\n[Network Data]\n1 0.012 0.016\n[End]\n1 2 3\n", Z),
        ("[Version] 2.0\n# Hz S RI\n[Reference]\n75 ! ohm\n1 0.5 0\n", 225.0),
        ("# Hz S MA\n! a comment\n\n1 0.5 180\n", 50 / 3),  # 50 ohm where none is stated
        ("# Hz S DB R 10\n1 -6.020599913 180\n", 10 / 3),
        ("# Hz S RI R 50\n# Hz Z RI R 1\n1 0.5 0\n", 150.0),  # the first line of options holds
    ],
)
def test_scattering_parameters_become_impedances_of_their_reference(text: str, impedance: complex) -> None:
    found = Touchstone().read(Path("a.s1p"), text.splitlines())[""]
    assert found.impedance == approx([impedance])
    assert found.frequency.tolist() == [1.0]


@pytest.mark.parametrize(("unit", "scale"), [("", 1e9), ("kHz", 1e3), ("MHz", 1e6), ("GHZ", 1e9), ("hz", 1.0)])
def test_the_frequency_of_touchstone_is_in_its_unit_and_in_gigahertz_without(unit: str, scale: float) -> None:
    found = Touchstone().read(Path("a.s1p"), [f"# {unit} S RI", "2 0.5 0"])[""]
    assert found.frequency == approx([2 * scale])
    assert found.lines.tolist() == [2]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("# " + "Hz " * 17 + "\n1 2 3\n", "line 1: has 17 options"),
        ("# Hz S RI R\n1 2 3\n", "line 1: unknown option 'R'"),
        ("# Hz S RI\n! nothing\n", "line 2: holds no values"),
        ("[Version] 2.0\n# Hz S RI\n[Colour] red\n1 2 3\n", r"line 3: the keyword '\[colour\]' is not known"),
        ("[Version] 2.0\n# Hz S RI\n[Number of Ports] 3\n1 2 3\n", "line 3: is a network of 3 ports"),
        ("# Hz S RI\n1 2 inf\n", "line 2: a point of one port is three numbers"),
        ("# Hz S RI R inf\n1 2 3\n", "line 1: the reference resistance must be positive, got 'INF'"),
    ],
)
def test_what_is_no_touchstone_file_of_one_port_is_refused_with_its_line(text: str, words: str) -> None:
    with raises(InvalidInput, match=words):
        Touchstone().read(Path("a.s1p"), text.splitlines())


def test_information_of_version_two_is_skipped() -> None:
    text = ["[Version] 2.0", "# Hz Z RI", "[Begin Information]", "1 2 x", "[End Information]", "1 5 6"]
    assert Touchstone().read(Path("a.ts"), text)[""].impedance.tolist() == [5 + 6j]


HP = [
    "4294A REV1.1", '"MEASURE PARAMETER: ADMITTANCE REAL IMAG"', '"SWEEP TYPE: LOG FREQ"', '"NUMBER of POINTS: 2"',
    '"TRACE: A"', '"Frequency"\t"Data"', "1000\t0.012\t0\t0.5\t0", "2000\t0.02\t0\t0.25\t0",
    '"TRACE: B"', '"Frequency"\t"Data"', "1000\t0.016\t0\t0\t0", "2000\t0\t0\t0.25\t0",
]  # fmt: skip


def test_the_traces_of_a_4294a_are_the_parts_of_its_parameter_and_of_its_memory() -> None:
    found = Hp4294A().read(Path("a.txt"), HP)
    assert found["data"].impedance == approx([Z, 50.0])
    assert found["memory"].impedance == approx([2.0, 1 / (0.25 + 0.25j)])
    assert found["data"].lines.tolist() == [7, 8]
    silent = [line.replace("\t0.5\t0", "\t0\t0").replace("\t0.25\t0", "\t0\t0") for line in HP]
    assert set(Hp4294A().read(Path("a.txt"), silent)) == {"data"}  # a memory of zeros was not measured
    short = [line if line.startswith('"') or line[0] == "4" else "\t".join(line.split("\t")[:3]) for line in HP]
    assert set(Hp4294A().read(Path("a.txt"), short)) == {"data"}


@pytest.mark.parametrize(
    ("at", "line", "words"),
    [
        (10, "1001\t0.016\t0\t0\t0", "line 10: trace B has other frequencies than trace A"),
        (7, "2000\t0.02\t0", "line 8: has 3 numbers; the trace began with 5"),
        (7, "2000\t0.02\t0\t1", "line 8: must hold 3 or 5 numbers between tabs"),
        (7, "2000\tinf\t0", "line 8: must hold 3 or 5 numbers"),
        (3, '"NUMBER of POINTS: 3"', "line 8: the trace ends after 2 of 3 points"),
        (1, "7", "line 2: values before any heading of columns"),
    ],
)
def test_a_trace_of_a_4294a_that_does_not_fit_is_refused(at: int, line: str, words: str) -> None:
    with raises(InvalidInput, match=words):
        Hp4294A().read(Path("a.txt"), [*HP[:at], line, *HP[at + 1 :]])


def test_traces_of_different_lengths_or_without_values_are_refused() -> None:
    bare = [line for line in HP if "POINTS" not in line]
    with raises(InvalidInput, match="line 10: the traces differ in length"):
        Hp4294A().read(Path("a.txt"), bare[:-1])
    with raises(InvalidInput, match="line 9: no values follow"):
        Hp4294A().read(Path("a.txt"), bare[:-2])


def test_a_trace_file_of_an_e4990a_has_data_and_memory() -> None:
    lines = [
        "!Keysight,E4990A", "BEGIN CH1_DATA", "Frequency(kHz), R(Ohm)-data, X(Ohm)-data, R(Ohm)-mem, X(Ohm)-mem",
        "1,30,-40,3,4", "", "2,1,2,5,6", "END", "9,9,9,9,9",
    ]  # fmt: skip
    found = KeysightE4990A().read(Path("a.csv"), lines)
    assert found["data"].impedance.tolist() == [Z, 1 + 2j]
    assert found["memory"].impedance.tolist() == [3 + 4j, 5 + 6j]
    assert found["data"].frequency == approx([1000.0, 2000.0])
    assert found["data"].lines.tolist() == [4, 6]
    one = [line.replace(", R(Ohm)-mem, X(Ohm)-mem", ", colour-mem, note-mem") for line in lines]
    assert set(KeysightE4990A().read(Path("a.csv"), one)) == {"data"}
    head = b"!Keysight\n!b\n!c\n!E4990A\n"
    assert KeysightE4990A().recognises(head, Path("a.csv"))
    assert not KeysightE4990A().recognises(b"!a\n!b\n!c\n!d\n!E4990A\n", Path("a.csv"))
    assert not KeysightE4990A().recognises(b"a\n!E4990A\n", Path("a.csv"))


def test_an_unfinished_sweep_of_an_mfia_has_its_finished_points() -> None:
    lines = [
        "chunk;timestamp;size;fieldname", "0;1;3;grid;1000;2000;3000", "0;1;3;absz;50;60;",
        "chunk;timestamp;size;fieldname", "0;1;3;phasez;-0.927295218;;", "0;1;3;bandwidth;1;x;3",
    ]  # fmt: skip
    found = Mfia().read(Path("a.csv"), lines)["0"]
    assert found.impedance == approx([Z])
    assert found.lines.tolist() == [3]
    magnitude = Mfia().read(Path("a.csv"), lines[:4])["0"]
    assert not magnitude.has_phase
    assert magnitude.impedance == approx([50.0, 60.0])
    with raises(InvalidInput, match="line 3: 'inf' is not a number"):
        Mfia().read(Path("a.csv"), [*lines[:2], "0;1;3;absz;50;inf;1"])
    with raises(InvalidInput, match="line 3: chunk '0' holds no finished point"):
        Mfia().read(Path("a.csv"), [*lines[:2], "0;1;3;absz;;;"])
    with raises(InvalidInput, match="announces fields, but none is a frequency or an impedance"):
        Mfia().read(Path("a.csv"), [lines[0], lines[5]])
    comma = [line.replace(";", ",") for line in lines]
    assert Mfia().read(Path("a.csv"), comma)["0"].impedance == approx([Z])
    assert Mfia().recognises(b"Chunk, timestamp, size, fieldname\n", Path("a.csv"))
    assert not Mfia().recognises(b"chunk;timestamp;size\n", Path("a.csv"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("f;|Z|;phase\n1;2;3\n", "line 1: 'phase' needs a unit"),
        ("# only a comment\n", "line 2: holds no row"),
        ("f,R,X\n", "line 1: no values follow"),
        ("f,R\n1,2\n", "line 1: names no columns of frequency and impedance"),
        ("R,X\n1,2\n", "line 1: names no columns of frequency and impedance"),
    ],
)
def test_a_table_without_its_columns_is_refused(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text)
    with raises(InvalidInput, match=words):
        read_impedance(path)


def test_a_phase_without_unit_beside_a_whole_pair_is_left_out_and_a_decimal_comma_read(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("f;R;X;phase\n1,5;30;-40;1\n2,5;1;2;3\n")
    found = read_impedance(path)
    assert found.impedance.tolist() == [Z, 1 + 2j]
    assert found.frequency.tolist() == [1.5, 2.5]
    assert found.admittance == approx([Y, 0.2 - 0.4j])
