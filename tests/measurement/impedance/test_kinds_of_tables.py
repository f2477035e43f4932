"""Tables of one circuit as instruments, spreadsheets and MATLAB write them: the same impedance from every kind."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from pytest import approx, mark, raises

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.headings import parse_heading
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum, read_impedance

F = np.linspace(36e3, 44e3, 33)
W = 2 * np.pi * F


def closed_form() -> Complexes:
    """Capacitor of 1.2 nF beside 90 ohm, 0.4 H and the capacitance that resonates with it at 40 kHz."""
    motional = 1 / ((2 * np.pi * 40e3) ** 2 * 0.4)
    return np.asarray(1 / (1j * W * 1.2e-9 + 1 / (90.0 + 1j * W * 0.4 + 1 / (1j * W * motional))))


Z = closed_form()
Y = 1 / Z
S = (Z - 50) / (Z + 50)
S75 = (Z - 75) / (Z + 75)
DEG, RAD = np.degrees(np.angle(Z)), np.angle(Z)
DISSIPATION = Z.real / np.abs(Z.imag)
SIGNED = Y.real / Y.imag


def text(heading: str, *columns: Floats, separator: str = ",", comma: bool = False, preamble: str = "") -> str:
    """Table of columns, with numbers of twelve digits."""
    rows = [separator.join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True)]
    return "\n".join([preamble + heading, *([row.replace(".", ",") for row in rows] if comma else rows), ""])


def read(folder: Path, content: str, *, name: str = "z.csv", encoding: str = "utf-8") -> ImpedanceSpectrum:
    path = folder / name
    path.write_bytes(content.encode(encoding))
    return read_impedance(path)


MAGNITUDE_AND_PHASE = {
    "ohms": ("Frequency (Hz),|Z| (Ohms),Phase (deg)", (F, np.abs(Z), DEG)),
    "waveforms": ("Frequency (Hz),Trace 1: |Z| (Ohm),Trace 1: Phase (°)", (F, np.abs(Z), DEG)),
    "without number": ("Frequency (Hz),Trace |Z| (Ohm),Trace θ (deg)", (F, np.abs(Z), DEG)),
    "fused": ("Freq. (Hz),Zmod (Ohm),θz (deg)", (F, np.abs(Z), DEG)),
    "bode": ("Frequency (Hz),Trace 1: Impedance: Magnitude (kΩ),Trace 1: Phase (rad)", (F, np.abs(Z) / 1e3, RAD)),
    "decibels": ("freq/kHz,Impedance (dBOhm),Angle (degrees)", (F / 1e3, 20 * np.log10(np.abs(Z)), DEG)),
    "log10": ("f [MHz],log10|Z|,arg(Z) [rad]", (F / 1e6, np.log10(np.abs(Z)), RAD)),
    "matlab": ("omega,log10(abs(Z)/kOhm),theta_Z (mrad)", (W, np.log10(np.abs(Z) / 1e3), 1e3 * RAD)),
    "natural": ("Freq Hz,ln|Z|,phase(Z) deg", (F, np.log(np.abs(Z)), DEG)),
    "admittance": ("Frequency (Hz),|Y| (mS),Phase Y (deg)", (F, 1e3 * np.abs(Y), -DEG)),
    "of its quantity": ("Frequency (Hz),|Y| (µS),Phase (deg)", (F, 1e6 * np.abs(Y), -DEG)),
    "negative": ("freq/Hz,|Z|/Ohm,-Phase(Z)/deg", (F, np.abs(Z), -DEG)),
}
REAL_AND_IMAGINARY = {
    "matlab": ("Frequencies,Z_real,Z_imag", (F, Z.real, Z.imag)),
    "prefixed": ("f_Hz,Re_Z,Im_Z", (F, Z.real, Z.imag)),
    "biologic": ("freq/Hz,Re(Z)/Ohm,-Im(Z)/Ohm", (F, Z.real, -Z.imag)),
    "words": ("Frequency (kHz),Z Real (kOhm),Z Imag (kOhm)", (F / 1e3, Z.real / 1e3, Z.imag / 1e3)),
    "by unit": ("Frequency (Hz),Real (Ohm),Imaginary (Ohm)", (F, Z.real, Z.imag)),
    "primes": ("Freq(Hz),Z' (Ohm),Z'' (Ohm)", (F, Z.real, Z.imag)),
    "series": ("Freq (Hz),Rs (ohm),Xs (ohm)", (F, Z.real, Z.imag)),
    "conductance": ("Frequency (Hz),G (uS),B (uS)", (F, 1e6 * Y.real, 1e6 * Y.imag)),
    "admittance": ("Frequency (Hz),Y real (S),Y imag (S)", (F, Y.real, Y.imag)),
    "parallel": ("Frequency (Hz),Rp (kohm),Xp (ohm)", (F, 1e-3 / Y.real, -1 / Y.imag)),
}
CIRCUITS = {
    "cp d": ("Frequency (Hz),Cp (F),D", (F, Y.imag / W, Y.real / np.abs(Y.imag))),
    "cp signed d": ("Frequency (Hz),Cp (pF),Tan delta", (F, 1e12 * Y.imag / W, SIGNED)),
    "cp percent": ("Frequency (Hz),Cp (nF),tan δ (%)", (F, 1e9 * Y.imag / W, 100 * SIGNED)),
    "cp q": ("Frequency (Hz),Cp (F),Q", (F, Y.imag / W, 1 / SIGNED)),
    "cp g": ("Frequency (Hz),Cp [nF],G [mS]", (F, 1e9 * Y.imag / W, 1e3 * Y.real)),
    "named twice": ("Frequency f (Hz),Capacitance Cp (F),Loss factor D []", (F, Y.imag / W, SIGNED)),
    "cp rp": ("f (Hz),Cp (F),Rp (Ohm)", (F, Y.imag / W, 1 / Y.real)),
    "cs d": ("Frequency (Hz),Cs (F),D", (F, -1 / (W * Z.imag), DISSIPATION)),
    "cs rs": ("Frequency (Hz),C_s (nF),R_s (Ohm)", (F, -1e9 / (W * Z.imag), Z.real)),
    "cs q": ("Frequency (Hz),Series capacitance (F),Quality factor", (F, -1 / (W * Z.imag), 1 / DISSIPATION)),
    "ls q": ("Frequency (Hz),Ls (mH),Q", (F, 1e3 * Z.imag / W, 1 / DISSIPATION)),
    "lp d": ("Frequency (Hz),Lp (H),Dissipation factor", (F, -1 / (W * Y.imag), DISSIPATION)),
}
REFLECTION = {
    "vna": ("Freq(Hz),S11(REAL),S11(IMAG)", (F, S.real, S.imag)),
    "decibels": ("Freq (kHz),S11 (dB),S11 (deg)", (F / 1e3, 20 * np.log10(np.abs(S)), np.degrees(np.angle(S)))),
    "log magnitude": (
        "Frequency (Hz),S11 Log Mag(dB),S11 Phase(deg)",
        (F, 20 * np.log10(np.abs(S)), np.degrees(np.angle(S))),
    ),
    "linear": ("Frequency (Hz),|S11|,phase(S11) (rad)", (F, np.abs(S), np.angle(S))),
    "words": ("Frequency (Hz),Re(S11),Im(S11)", (F, S.real, S.imag)),
}
GERMAN = {
    "magnitude": ("Frequenz [Hz];Betrag Z [Ohm];Phasenwinkel [Grad]", (F, np.abs(Z), DEG)),
    "impedance": ("Frequenz in kHz;Impedanz in kOhm;Winkel in °", (F / 1e3, np.abs(Z) / 1e3, DEG)),
    "parts": ("Frequenz (Hz);Realteil Z (Ω);Imaginärteil Z (Ω)", (F, Z.real, Z.imag)),
    "resistance": ("Messfrequenz (Hz);Wirkwiderstand (Ohm);Blindwiderstand (Ohm)", (F, Z.real, Z.imag)),
    "capacitance": ("Frequenz (Hz);Parallelkapazität (nF);Verlustfaktor", (F, 1e9 * Y.imag / W, SIGNED)),
    "named twice": ("Frequenz f [Hz];Kapazität Cs [nF];Serienwiderstand Rs [Ohm]", (F, -1e9 / (W * Z.imag), Z.real)),
    "conductance": ("Kreisfrequenz (rad/s);Wirkleitwert (µS);Blindleitwert (µS)", (W, 1e6 * Y.real, 1e6 * Y.imag)),
}
COMPLEX: dict[str, Callable[[complex], str]] = {
    "i": lambda z: f"{z.real:.12g}{z.imag:+.12g}i",
    "j": lambda z: f"({z.real:.12g} {'+' if z.imag > 0 else '-'} {abs(z.imag):.12g}j)",
    "before": lambda z: f"{z.real:.12e}{'+' if z.imag > 0 else '-'}j{abs(z.imag):.12e}",
    "starred": lambda z: f"{z.real:.12g}{z.imag:+.12g}*i",
    "polar": lambda z: f"{abs(z):.12g}∠{np.degrees(np.angle(z)):.12g}°",
}


@mark.parametrize("kind", [MAGNITUDE_AND_PHASE, REAL_AND_IMAGINARY, CIRCUITS], ids=["polar", "parts", "circuits"])
def test_every_heading_of_a_pair_gives_the_same_impedance(
    kind: dict[str, tuple[str, tuple[Floats, ...]]], tmp_path: Path
) -> None:
    for name, (heading, columns) in kind.items():
        for separator in (",", "\t", ";"):
            content = text(heading.replace(",", separator), *columns, separator=separator)
            found = read(tmp_path, content)
            assert found.has_phase, name
            assert found.frequency == approx(F), name
            assert found.impedance == approx(Z, rel=1e-8), name
            assert found.caveats == (), name


def test_a_reflection_coefficient_is_against_50_ohm_where_the_file_states_no_other(tmp_path: Path) -> None:
    for name, (heading, columns) in REFLECTION.items():
        found = read(tmp_path, text(heading, *columns))
        assert found.impedance == approx(Z, rel=1e-7), name
        assert "does not state the reference impedance" in found.caveats[0], name
    for line in ("Reference impedance: 75 Ohm", "# Z0 = 75,0", "Bezugswiderstand;75 Ω", "System impedance (Ohm) 75"):
        found = read(tmp_path, text("Freq(Hz),S11(REAL),S11(IMAG)", F, S75.real, S75.imag, preamble=f"{line}\n"))
        assert found.impedance == approx(Z, rel=1e-7), line
        assert found.caveats == (), line


@mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
def test_german_headings_with_decimal_commas_are_read_in_every_encoding(encoding: str, tmp_path: Path) -> None:
    for name, (heading, columns) in GERMAN.items():
        if encoding == "cp1252" and "Ω" in heading:
            continue  # has no such letter
        found = read(tmp_path, text(heading, *columns, separator=";", comma=True), encoding=encoding)
        assert found.impedance == approx(Z, rel=1e-8), name
        assumed = encoding == "cp1252" and not heading.isascii()
        assert any("Windows-1252" in caveat for caveat in found.caveats) is assumed, name


def test_complex_numbers_in_one_column_are_read_with_either_mark(tmp_path: Path) -> None:
    for name, written in COMPLEX.items():
        for heading in ("f (Hz);Z (ohm)", "Frequency;Impedance", "freq/Hz;Complex Z"):
            rows = [f"{f:.12g};{written(z)}" for f, z in zip(F, Z, strict=True)]
            for body in (rows, [row.replace(".", ",") for row in rows]):
                found = read(tmp_path, "\n".join([heading, *body]))
                assert found.impedance == approx(Z, rel=1e-8), (name, heading)
    admittances = [f"{f:.12g},{1e3 * y:.12g}" for f, y in zip(F, Y, strict=True)]
    assert read(tmp_path, "\n".join(["f,Y (mS)", *admittances])).impedance == approx(Z, rel=1e-8)


PREAMBLES = {
    "bode": "Bode Analyzer Suite\nDate and time: 2025-01-02 10:11:12\nReceiver bandwidth: 100 Hz\n\n",
    "commas": "Instrument,LCR-6300,SN 1234\nSettings,Level 1 V,Bias 0 V\nOperator,A. N. Other\n",
    "excel": "sep=,\n",
    "comments": "# made by hand\n% freq, none\n! E5061B\n",
    "begin": "!CSV A.01.01\n!Keysight Technologies,E5061B\nBEGIN CH1_DATA\n",
}


@mark.parametrize("name", PREAMBLES)
def test_a_preamble_before_the_headings_and_what_follows_an_end_are_passed_over(name: str, tmp_path: Path) -> None:
    content = text("Frequency (Hz),R (Ohm),X (Ohm)", F, Z.real, Z.imag, preamble=PREAMBLES[name])
    assert read(tmp_path, content + "END\n1,2,3\n").impedance == approx(Z, rel=1e-8)


def test_units_in_a_row_below_the_headings_and_headings_in_a_comment_are_read(tmp_path: Path) -> None:
    for heading, columns in (
        ("Frequency,|Z|,Phase\nkHz,kOhm,deg", (F / 1e3, np.abs(Z) / 1e3, DEG)),
        ("Frequency,Real,Imag\n(kHz),(Ohm),(Ohm)", (F / 1e3, Z.real, Z.imag)),
        ("f,Cp,D\nHz,pF,", (F, 1e12 * Y.imag / W, SIGNED)),
        ("# f (Hz), R (ohm), X (ohm)", (F, Z.real, Z.imag)),
        ('"Frequency (Hz)","R (Ohm)","X (Ohm)"', (F, Z.real, Z.imag)),
    ):
        assert read(tmp_path, text(heading, *columns)).impedance == approx(Z, rel=1e-8), heading


def test_a_phase_without_unit_is_in_degrees_where_its_numbers_exceed_a_turn_in_radians(tmp_path: Path) -> None:
    found = read(tmp_path, text("frequency,|Z|,phase", F, np.abs(Z), DEG))
    assert found.impedance == approx(Z, rel=1e-8)
    (caveat,) = found.caveats
    assert caveat.startswith("'phase' states no unit and was read in degrees, since its numbers reach 89.")
    with raises(InvalidInput, match=r"'phase' needs a unit, 'phase \(deg\)' or '\(rad\)'.*1\.57 may be either"):
        read(tmp_path, text("frequency,|Z|,phase", F, np.abs(Z), RAD))


@mark.parametrize(
    ("heading", "words"),
    [
        ("f (Hz),Capacitance (F),D", "'Capacitance .F.' may be of the series or of the parallel circuit: write Cs or"),
        ("f (Hz),Kapazität (nF),Rp (Ohm)", "series or of the parallel circuit: write Cs or Cp"),
        ("f (Hz),Inductance (H),Q", "write Ls or Lp"),
        ("f (Hz),log|Z|,Phase (deg)", "may be a decimal or a natural logarithm: write log10.Z. or ln.Z."),
        ("f (Hz),Real,Imag", "may be of impedance, admittance or reflection: write 'Z real .ohm.' or 'Y real .S.'"),
        ("f (Hz),Magnitude,Phase (deg)", "may be of impedance, admittance or reflection: write 'Z magnitude"),
        ("f (Hz),S11 (dB),Gain", "names no columns of frequency and impedance"),
        ("f (mhz),R (ohm),X (ohm)", "names no columns of frequency and impedance"),
    ],
)
def test_a_heading_of_two_meanings_is_refused_with_both(heading: str, words: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match=f"z.csv: line 1: .*{words}"):
        read(tmp_path, text(heading, F, np.abs(Z), DEG))


@mark.parametrize("cell", ["60+1.2", "i", "1+2i+3i", "1e40+1i"])
def test_a_cell_that_is_no_complex_number_in_a_column_of_them_is_refused(cell: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match=r"line 3: '.*' is not a complex number"):
        read(tmp_path, f"f,Z\n1000,1+2i\n2000,{cell}\n")


@mark.parametrize("text", ["temperature (K)", "log10(colour)", "Z X", "real imag (ohm)", "-R (ohm)", "x" * 300])
def test_what_is_no_quantity_of_an_impedance_is_none(text: str) -> None:
    assert parse_heading(text) is None


def test_the_columns_that_were_read_are_named(tmp_path: Path) -> None:
    found = read(tmp_path, text("Nr,Frequency (Hz),Cp (F),D,note", F, F, Y.imag / W, SIGNED, F))
    assert found.columns == "Frequency (Hz), Cp (F), D"


@mark.parametrize(
    "heading",
    ["frequency [Hz]  R [ohm]  X [ohm]", "frequency(Hz) R(ohm) X(ohm)", "# f[Hz]   R[ohm]   X[ohm]", "Sweep 3\nf R X"],
)
def test_a_table_between_blanks_is_read(heading: str, tmp_path: Path) -> None:
    rows = [f"  {1000 + 10 * k:8.1f}   {3 + k:6.2f}  {-4.5:6.2f}" for k in range(12)]
    path = tmp_path / "blanks.txt"
    path.write_text("\n".join(["Bridge B, 2 V", heading, *rows, ""]))
    spectrum = read_impedance(path)
    assert spectrum.frequency == approx(1000 + 10 * np.arange(12.0))
    assert spectrum.impedance == approx(3 + np.arange(12.0) - 4.5j)
