"""Command `impedance compute`: coupled modes, and a table that reads back as a measured spectrum."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.measurement.impedance.reader import read_impedance

Program = Callable[..., Any]


def test_the_impedance_of_a_ring_reads_back_as_a_measured_one(sonolube: Program, tmp_path: Path) -> None:
    sizes = ("--set", "outer_radius=5mm", "--set", "inner_radius=2.5mm", "--set", "length=12mm")
    common = ("--from", "10kHz", "--to", "105kHz", "--points", "191", "--tolerance", "0.05", "--out", str(tmp_path))
    run = sonolube("impedance", "compute", "stack", *sizes, *common, "--clamp", "ring1.-z", "--vtu", "--json")
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
    again = sonolube("impedance", "compute", "stack", *sizes, *common, "--measured", str(table))
    assert again.code == 0, again.err
    assert "measured: least impedance" in again.out
