"""Impedance files: every format against one known circuit, and refusals of invalid files by name and line."""

from pathlib import Path

import numpy as np
from pytest import approx, mark, raises, skip

from sonolube.errors import InvalidInput, UnknownName
from sonolube.measurement.impedance.headings import parse_heading
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum, read_impedance

CORPUS = Path(__file__).parent / "corpus"
RB5100 = Path(__file__).parents[4] / "shared" / "data" / "impedance" / "RB5100.txt"


def known_impedance(frequency: np.ndarray) -> np.ndarray:
    """2 nF beside 40 ohm, 80 mH and 660 pF in series: what all files of the corpus hold."""
    s = 2j * np.pi * frequency
    return np.asarray(1 / (s * 2e-9 + 1 / (40 + s * 0.08 + 1 / (s * 6.6e-10))))


@mark.parametrize(
    ("name", "sweep"),
    [
        ("magnitude-phase.4294a", None),
        ("real-imaginary.4294a", None),
        ("magnitude-phase.e4990a", None),
        ("inductance.e4990a", None),
        ("scattering.s1p", None),
        ("decibels.s1p", None),
        ("normalized.s1p", None),
        ("version-2.s1p", None),
        ("one-sweep.mfia", None),
        ("two-sweeps.mfia", "0"),
        ("resistance-reactance.csv", None),
        ("decimal-comma.csv", None),
        ("parallel.csv", None),
    ],
)
def test_every_format_gives_the_impedance_of_its_circuit(name: str, sweep: str | None) -> None:
    found = read_impedance(CORPUS / name, sweep=sweep)
    assert found.frequency == approx(np.linspace(20e3, 24e3, 9))
    assert np.abs(found.impedance / known_impedance(found.frequency) - 1).max() < 2e-6
    assert found.file_name == name
    assert len(found.sha256) == 64


@mark.parametrize(
    ("name", "sweep"),
    [("magnitude-phase.4294a", "memory"), ("magnitude-phase.e4990a", "memory"), ("two-sweeps.mfia", "1")],
)
def test_a_named_sweep_of_a_file_is_read(name: str, sweep: str) -> None:
    found = read_impedance(CORPUS / name, sweep=sweep)
    assert found.impedance * 1.02 == approx(known_impedance(found.frequency), rel=2e-6)
    assert found.sweep == sweep


def test_an_ambiguous_sweep_is_refused() -> None:
    with raises(InvalidInput, match=r"two-sweeps\.mfia: holds 2 sweeps; name one of them: 0, 1"):
        read_impedance(CORPUS / "two-sweeps.mfia")
    with raises(UnknownName, match=r"has no sweep '7'; it has '0', '1'"):
        read_impedance(CORPUS / "two-sweeps.mfia", sweep="7")


def test_a_measured_hp_4294a_file_is_read_whole() -> None:
    if not RB5100.is_file():
        skip(f"{RB5100.name} is not here")
    found = read_impedance(RB5100)
    assert found.frequency.size == 601
    assert (found.frequency[0], found.frequency[-1]) == (74e3, 316.4e3)
    assert abs(found.impedance[0]) == approx(910.0274)
    assert np.degrees(np.angle(found.impedance[-1])) == approx(-88.80548)


@mark.parametrize(
    ("text", "unit"),
    [("|Z|(Ohm)", 1.0), ("|Z| [kOhm]", 1e3), ("abs(z)", 1.0), ("Z (mΩ)", 1e-3), ('"zmod / Mohm"', 1e6)],
)
def test_a_heading_gives_quantity_and_unit(text: str, unit: float) -> None:
    found = parse_heading(text)
    assert found is not None
    assert found.symbol == "|Z|"
    assert found.scale == approx(unit)


@mark.parametrize("text", ["phase", "theta-z", "|Z| (V)", "frequency (rad)", "Z (bananas)", "depth (m)", ""])
def test_a_heading_with_a_missing_or_wrong_unit_is_none(text: str) -> None:
    assert parse_heading(text) is None


def test_a_path_may_be_a_text(tmp_path: Path) -> None:
    (tmp_path / "three.csv").write_text("f,R,X\n1,2,3\n2,3,4\n3,4,5\n")
    assert read_impedance(str(tmp_path / "three.csv")).impedance.tolist() == [2 + 3j, 3 + 4j, 4 + 5j]


WRONG = {
    "empty.csv": ("", r"empty\.csv: is empty"),
    "cells.csv": ("f,R,X\n1,2,3\n2,3\n", r"line 3: has 2 cells where column 3 is required"),
    "word.csv": ("f,R,X\n1,2,3\n2,three,4\n", r"line 3: 'three' is not a finite number"),
    "far.csv": ("f,R,X\n1,2,3\n2,-1e308,4\n", r"line 3: '-1e308' lies beyond any instrument"),
    "nan.csv": ("f,R,X\n1,nan,3\n", r"line 2: 'nan' is not a finite number"),
    "zero.csv": ("f,R,X\n1,1,1\n2,0,0\n", r"line 3: the impedance of 0 ohm is none that an instrument reads"),
    "unsorted.csv": ("f,R,X\n1,1,1\n3,1,1\n2,1,1\n4,1,1\n", r"line 4: the frequency is not monotonic"),
    "negative.csv": ("f,R,X\n-1,1,1\n", r"line 2: the frequency must be positive"),
    "phase.csv": ("f,|Z|,phase\n1,1,1\n", r"line 1: 'phase' needs a unit, 'phase \(deg\)'"),
    "cut.csv": ("!Keysight Technologies,E4990A\nFrequency(Hz), R(Ohm)-data, X(Ohm)-data\n1,2,3\n", "ends without END"),
    "no-options.s1p": ("1 2 3\n", r"line 1: values before the option line"),
    "two-ports.s1p": ("# HZ S RI R 50\n1 2 3 4 5 6 7 8 9\n", r"line 2: a point of one port is three numbers"),
    "options.s1p": ("# HZ H RI R 50\n", r"line 1: unknown option 'H'"),
    "reference.s1p": ("# HZ S RI R -50\n", r"line 1: the reference resistance must be positive, got '-50'"),
    "keyword.s1p": ("[Version] 1.0\n", r"line 1: version '1\.0' is not known"),
    "open.s1p": ("# HZ S RI R 50\n1000 1 0\n", r"line 2: the impedance of (?:inf|nan) ohm is none"),
    "short.mfia": ("chunk;timestamp;size;fieldname\n0;1\n", r"line 2: has 2 cells"),
    "lacking.mfia": ("chunk;timestamp;size;fieldname\n0;1;1;frequency;5\n", r"line 2: chunk '0' lacks"),
    "uneven.mfia": (
        "chunk;timestamp;size;fieldname\n0;1;2;frequency;5;6\n0;1;2;realz;5\n0;1;2;imagz;5;6\n",
        r"line 3: realz has 1 values, frequency 2 and imagz 2",
    ),
}


@mark.parametrize("name", WRONG)
def test_a_wrong_file_is_refused_with_its_name_the_line_and_the_reason(name: str, tmp_path: Path) -> None:
    text, message = WRONG[name]
    (tmp_path / name).write_text(text)
    with raises(InvalidInput, match=message) as refused:
        read_impedance(tmp_path / name)
    assert str(refused.value).startswith(f"{tmp_path / name}: ")


def changed(old: str, new: str, tmp_path: Path) -> Path:
    path = tmp_path / "changed.txt"
    path.write_text((CORPUS / "magnitude-phase.4294a").read_text().replace(old, new))
    return path


def test_a_4294a_file_cut_short_or_of_another_sweep_is_refused(tmp_path: Path) -> None:
    with raises(InvalidInput, match=r"line \d+: the trace ends after 9 of 601 points"):
        read_impedance(changed("POINTS: 9", "POINTS: 601", tmp_path))
    with raises(InvalidInput, match=r"line 7: sweeps 'LIN BIAS', not frequency"):
        read_impedance(changed("LIN FREQ", "LIN BIAS", tmp_path))
    with raises(InvalidInput, match=r"line 5: measures 'CS-D'; known: IMPEDANCE MAG PHASE \(DEG\)"):
        read_impedance(changed("IMPEDANCE MAG PHASE (DEG)", "CS-D", tmp_path))
    whole = (CORPUS / "magnitude-phase.4294a").read_text()
    path = tmp_path / "half.txt"
    path.write_text(whole[: whole.index('"TRACE: B"')])
    with raises(InvalidInput, match="holds 1 traces where A and B are required"):
        read_impedance(path)


def test_an_invalid_spectrum_is_refused() -> None:
    with raises(InvalidInput, match="frequency must increase, got 1 Hz"):
        ImpedanceSpectrum(frequency=np.array([1.0, 1.0]), impedance=np.array([1.0, 1j]))
    with raises(InvalidInput, match="impedance must not be zero, as it is at 2 Hz"):
        ImpedanceSpectrum(frequency=np.array([1.0, 2.0]), impedance=np.array([1.0, 0j]))
    with raises(InvalidInput, match="one-dimensional and equal in length"):
        ImpedanceSpectrum(frequency=np.array([1.0, 2.0]), impedance=np.array([1.0 + 0j]))


def test_a_table_of_magnitudes_is_a_spectrum_without_phase(tmp_path: Path) -> None:
    path = tmp_path / "magnitude.csv"
    path.write_text("frequency (kHz),|Y| (mS)\n20,1\n21,2\n")
    found = read_impedance(path)
    assert not found.has_phase
    assert found.impedance == approx([1000, 500])


@mark.parametrize(("name", "ports"), [("device.s2p", "2"), ("device.S4P", "4"), ("device.ts", "2")])
def test_a_network_of_several_ports_is_refused_with_what_it_is(name: str, ports: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text("[Version] 2.0\n# Hz S RI R 50\n[Number of Ports] 2\n1 0 0 0 0 0 0 0 0\n")
    with raises(InvalidInput, match=f"is a network of {ports} ports, and an impedance has one.*save it as .s1p"):
        read_impedance(path)
