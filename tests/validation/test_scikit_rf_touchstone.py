"""Touchstone files of one port against scikit-rf: parameters, number formats, units, normalisation and both versions.

scikit-rf 2.2 multiplies the normalised admittances of version 1 by the reference resistance, as it does impedances,
where a normalised admittance is the admittance times that resistance. Admittances of version 1 are therefore compared
with a reference of 1 ohm, and otherwise with the impedances of the same network.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pytest import approx, importorskip, mark

from sonolube.measurement.impedance.spectrum import read_impedance

skrf = importorskip("skrf")

CORPUS = Path(__file__).parents[1] / "measurement" / "impedance" / "corpus"
FREQUENCIES = np.linspace(20e3, 24e3, 7)  # Hz
UNITS = {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6, "GHz": 1e9}
Complexes = NDArray[np.complex128]


def network(frequency: NDArray[np.float64]) -> Complexes:
    """Impedance of 2 nF in parallel with 40 ohm, 80 mH and 660 pF in series, in ohm."""
    s = 2j * np.pi * frequency
    return np.asarray(1 / (s * 2e-9 + 1 / (40 + s * 0.08 + 1 / (s * 6.6e-10))))


def parameters(impedance: Complexes, parameter: str, reference: float, *, normalised: bool) -> Complexes:
    if parameter == "S":
        return np.asarray((impedance - reference) / (impedance + reference))
    unit = reference if normalised else 1.0
    return np.asarray(impedance / unit if parameter == "Z" else unit / impedance)


def pairs(values: Complexes, number_format: str) -> NDArray[np.float64]:
    if number_format == "RI":
        return np.stack([values.real, values.imag], axis=-1)
    magnitude = 20 * np.log10(np.abs(values)) if number_format == "DB" else np.abs(values)
    return np.stack([magnitude, np.degrees(np.angle(values))], axis=-1)


def rows(values: Complexes, number_format: str, unit: str) -> str:
    table = np.column_stack([FREQUENCIES / UNITS[unit], pairs(values, number_format)])
    return "".join(" ".join(f"{value:.15g}" for value in row) + "\n" for row in table)


def by_scikit_rf(path: Path) -> tuple[NDArray[np.float64], Complexes]:
    read = skrf.Network(str(path))
    return read.f, read.z[:, 0, 0]


def assert_both_read_the_network(path: Path) -> None:
    own = read_impedance(path)
    frequency, impedance = by_scikit_rf(path)
    assert own.frequency == approx(frequency, rel=1e-12)
    assert own.impedance == approx(impedance, rel=1e-9)
    assert own.impedance == approx(network(FREQUENCIES), rel=1e-8)


@mark.parametrize("unit", UNITS)
@mark.parametrize("number_format", ["RI", "MA", "DB"])
@mark.parametrize(("parameter", "reference"), [("S", 50.0), ("S", 75.0), ("Z", 50.0), ("Z", 75.0), ("Y", 1.0)])
def test_version_1_agrees_for_every_parameter_format_and_unit(
    parameter: str, reference: float, number_format: str, unit: str, tmp_path: Path
) -> None:
    values = parameters(network(FREQUENCIES), parameter, reference, normalised=True)
    path = tmp_path / "network.s1p"
    path.write_text(
        f"! made\n# {unit} {parameter} {number_format} R {reference:g}\n{rows(values, number_format, unit)}"
    )
    assert_both_read_the_network(path)


@mark.parametrize("reference", [50.0, 75.0])
def test_normalised_admittances_of_version_1_are_the_network_of_the_normalised_impedances(
    reference: float, tmp_path: Path
) -> None:
    for parameter in ("Y", "Z"):
        values = parameters(network(FREQUENCIES), parameter, reference, normalised=True)
        (tmp_path / f"{parameter}.s1p").write_text(f"# Hz {parameter} RI R {reference:g}\n{rows(values, 'RI', 'Hz')}")
    _, impedance = by_scikit_rf(tmp_path / "Z.s1p")
    assert read_impedance(tmp_path / "Y.s1p").impedance == approx(impedance, rel=1e-9)


@mark.parametrize("options", ["# Hz S RI", "# hz s ri r 50"])
def test_options_agree_in_either_case_and_with_the_default_reference(options: str, tmp_path: Path) -> None:
    path = tmp_path / "network.s1p"
    values = parameters(network(FREQUENCIES), "S", 50.0, normalised=True)
    path.write_text(f"{options}\n{rows(values, 'RI', 'Hz')}")
    assert_both_read_the_network(path)


@mark.parametrize("number_format", ["RI", "MA", "DB"])
@mark.parametrize("parameter", ["S", "Z", "Y"])
@mark.parametrize("reference", ["[Reference] 75", "[Reference]\n75"])
def test_version_2_agrees_for_every_parameter_and_format(
    reference: str, parameter: str, number_format: str, tmp_path: Path
) -> None:
    values = parameters(network(FREQUENCIES), parameter, 75.0, normalised=False)
    path = tmp_path / "network.ts"
    path.write_text(
        f"[Version] 2.0\n# Hz {parameter} {number_format} R 50\n[Number of Ports] 1\n"
        f"[Number of Frequencies] {FREQUENCIES.size}\n{reference}\n[Matrix Format] Full\n"
        f"[Network Data]\n{rows(values, number_format, 'Hz')}[End]\n"
    )
    assert_both_read_the_network(path)


@mark.parametrize("name", ["decibels.s1p", "normalized.s1p", "scattering.s1p", "version-2.s1p"])
def test_the_corpus_agrees(name: str, tmp_path: Path) -> None:
    own = read_impedance(CORPUS / name)
    frequency, impedance = by_scikit_rf(CORPUS / name)
    assert own.frequency == approx(frequency, rel=1e-12)
    assert own.impedance == approx(impedance, rel=1e-9)
