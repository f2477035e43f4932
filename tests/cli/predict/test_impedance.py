"""Command `impedance compute`: coupled modes, and a table that reads back as a measured spectrum."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.facts.materials import piezo_ceramic, piezo_ceramic_names
from sonolube.measurement.impedance.spectrum import read_impedance

Program = Callable[..., Any]


def test_the_impedance_of_a_ring_reads_back_as_a_measured_one(sonolube: Program, tmp_path: Path) -> None:
    sizes = ("--set", "outer_radius=5mm", "--set", "inner_radius=2.5mm", "--set", "length=12mm")
    common = ("--from", "10kHz", "--to", "105kHz", "--points", "191", "--tolerance", "0.05")
    out = ("--out", tmp_path, "--vtu", "--json")
    run = sonolube("impedance", "compute", "stack", *sizes, *common, "--clamp", "ring1.-z", *out)
    answer = run.answer
    free, clamped = (answer["spectra"][name]["modes"][0] for name in ("free", "clamped"))
    assert free["parallel_frequency"]["value"] > free["series_frequency"]["value"]
    assert clamped["series_frequency"]["value"] < free["series_frequency"]["value"]  # a quarter against half a wave
    table = tmp_path / "stack-impedance-free.csv"
    spectrum = read_impedance(table)
    least = spectrum.frequency[np.argmin(np.abs(spectrum.impedance))]
    assert least == approx(free["series_frequency"]["value"], rel=0.02)
    grid = ElementTree.parse(tmp_path / "stack-modes-free.vtu").getroot()
    assert grid.attrib["type"] == "UnstructuredGrid"
    again = sonolube("impedance", "compute", "stack", *sizes, *common, "--measured", table, "--out", tmp_path / "again")
    assert again.code == 0, again.err
    assert "measured: least impedance" in again.out


@pytest.mark.parametrize("ceramic", piezo_ceramic_names())
def test_a_stack_of_any_ceramic_has_its_capacitance_and_half_wave(
    ceramic: str, sonolube: Program, tmp_path: Path
) -> None:
    outer, inner, length, layers = 5e-3, 2.5e-3, 40e-3, 80
    sizes = ("outer_radius=5mm", "inner_radius=2.5mm", "length=40mm", "stack_layers=80")
    options = [option for size in sizes for option in ("--set", size)]
    span = ("--from", "1kHz", "--to", "60kHz", "--points", "60", "--tolerance", "0.05", "--out", tmp_path, "--json")
    answer = sonolube("impedance", "compute", "stack", *options, "--ceramic", ceramic, *span).answer
    assert answer["ceramic"] == ceramic
    known = piezo_ceramic(ceramic)
    s33, free = known.compliance_short_circuit[2, 2], known.permittivity_free[2]
    density = known.material.value("density")
    # thin layers between electrodes are a bar at constant field: N^2 eps^T A/L far below resonance, and half a wave of
    # the compliance s^E at the series resonance; the width lowers it by Rayleigh's correction
    area = np.pi * (outer**2 - inner**2)
    nu = -known.compliance_short_circuit[0, 2] / s33
    rayleigh = 1 - (nu * np.pi / length) ** 2 * (outer**2 + inner**2) / 4
    half_wave = rayleigh / (2 * length * np.sqrt(density * s33))
    found = answer["spectra"]["free"]["modes"][0]
    assert found["series_frequency"]["value"] == approx(half_wave, rel=0.01)
    spectrum = read_impedance(tmp_path / "stack-impedance-free.csv")
    capacitance = 1 / (2 * np.pi * spectrum.frequency[0] * np.abs(spectrum.impedance[0]))
    assert capacitance == approx(layers**2 * free * area / length, rel=0.01)
    text = sonolube("impedance", "compute", "stack", *options, "--ceramic", ceramic, *span[:-1]).out
    assert text.startswith(f"stack of {ceramic}: ")


def test_an_unknown_ceramic_is_refused_with_a_suggestion(sonolube: Program) -> None:
    for part in ("stack", "tribometer_actuator", "cylinder"):
        sizes = ("--set", "radius=5mm", "--set", "length=2mm") if part == "cylinder" else ()
        refusal = sonolube("impedance", "compute", part, *sizes, "--ceramic", "pzt-44").refusal
        assert "unknown piezoelectric ceramic 'pzt-44'; did you mean pzt4?" in refusal, part


def test_a_ceramic_without_a_complete_set_is_refused_with_those_that_have_one(sonolube: Program) -> None:
    refusal = sonolube("impedance", "compute", "stack", "--ceramic", "pic151").refusal
    assert "pic151 has no complete set of constants: its maker prints no s12" in refusal
    assert "take one of pic255, pzt4" in refusal


def test_wiring_that_a_stack_has_of_its_own_is_refused(sonolube: Program) -> None:
    assert "--poled x: stack has its own" in sonolube("impedance", "compute", "stack", "--poled", "x").refusal
