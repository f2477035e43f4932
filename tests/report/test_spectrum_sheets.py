"""Sheets of spectra: a known spring of a contact and known circuits, and what their figures show."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx

from reliability import virtual_contact as virtual
from sonolube.charts import Chart, Line, Points, Rule
from sonolube.measurement.contact_stiffness.resonance_fit import Resonance
from sonolube.measurement.contact_stiffness.stiffness_estimate import ContactStiffness, LogEstimate
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.models.actuator import ButterworthVanDyke, MotionalBranch
from sonolube.report.measured.sheet import Figure, Sheet
from sonolube.report.measured.spectra import (
    ImpedanceSettings,
    StiffnessSettings,
    _stiffness_values,
    admittance_circle_figure,
    circuit_chart,
    contact_stiffness_sheet,
    impedance_sheet,
    resonances_figure,
    rig_lines,
)

LOAD, LENGTH = 3.0, 2e-6


def values(sheet: Sheet) -> dict[str, float]:
    return {value.name: value.value for value in sheet.values}


def chart_of(figure: Figure) -> Chart:
    assert figure.drawing.chart is not None
    return figure.drawing.chart()


# -- contact stiffness


def mobility(frequency: NDArray[np.float64], spring: float) -> NDArray[np.complex128]:
    """Velocity over force of 105 g that resonate at 22 kHz, with a spring added."""
    omega = 2 * np.pi * frequency
    mass, damper = 0.105, 40.0
    own = mass * (2 * np.pi * 22e3) ** 2
    return np.asarray(1j * omega / (own + spring - mass * omega**2 + 1j * omega * damper))


def spectrum_file(path: Path, spring: float, *, seed: int) -> Path:
    f = np.linspace(21.8e3, 22.6e3, 401)
    v = virtual.noisy(np.random.default_rng(seed), mobility(f, spring), 1e-3)
    rows = [f"{a},{abs(b)},{np.degrees(np.angle(b))}" for a, b in zip(f, v, strict=True)]
    path.write_text("\n".join(["frequency (Hz),velocity (m/s),phase (deg)", *rows]))
    return path


def test_a_spring_between_pin_and_disc_is_found_by_the_shift_with_its_entry_of_a_rig(tmp_path: Path) -> None:
    free, pressed, again = (
        spectrum_file(tmp_path / f"{name}.csv", spring, seed=seed)
        for seed, (name, spring) in enumerate((("free", 0.0), ("pressed", LOAD / LENGTH), ("again", 0.0)))
    )
    settings = StiffnessSettings(normal_load=LOAD, modal_mass=0.105, modal_mass_deviation=0.05)
    sheet, lines = contact_stiffness_sheet(free, pressed, settings=settings, again=again)
    found = values(sheet)
    assert found["normal_stiffness"] == approx(LOAD / LENGTH, rel=0.05)
    assert found["decay_length"] == approx(LENGTH, rel=0.05)
    assert found["free_frequency"] == approx(22e3, rel=1e-4)
    assert found["frequency_shift"] == approx(found["pressed_frequency"] - found["free_frequency"])
    assert abs(found["drift"]) < 1.0
    assert found["normal_load"] == approx(3.0)
    assert sheet.title == "pressed.csv against free.csv"
    assert sheet.source == {"free": "free.csv", "pressed": "pressed.csv", "free again": "again.csv"}
    assert lines[0::2] == ("[contact]", "[uncertainty]")
    assert float(lines[1].split('"')[1].removesuffix(" N/m")) == approx(LOAD / LENGTH, rel=0.05)
    assert float(lines[3].rpartition(" ")[2].strip('"')) == approx(np.exp(0.05), rel=0.02)


def test_a_stiffness_is_stated_by_its_median_and_the_factor_of_its_deviation() -> None:
    assert rig_lines(LogEstimate(median=1.23456e6, log_deviation=np.log(1.25))) == (
        "[contact]",
        'normal_stiffness = "1.235e+06 N/m"',
        "[uncertainty]",
        '"contact.normal_stiffness" = "lognormal factor 1.25"',
    )


STIFFNESS = ContactStiffness(
    free_frequency=100.0,
    pressed_frequency=160.0,
    free_uncertainty=3.0,
    pressed_uncertainty=4.0,
    drift=None,
    mode=1,
    normal_stiffness=LogEstimate(median=2e6, log_deviation=0.1),
    stiffness_ratio=0.5,
)


def test_what_was_found_comes_first_with_intervals_of_estimates_and_uncertainties_of_frequencies() -> None:
    settings = StiffnessSettings(normal_load=2.0)
    told = {each.name: each for each in _stiffness_values(STIFFNESS, settings)}
    assert list(told) == [
        *("normal_stiffness", "stiffness_ratio", "free_frequency", "pressed_frequency"),
        *("frequency_shift", "normal_load"),
    ]
    interval = told["normal_stiffness"].interval
    assert interval is not None
    assert interval == approx((2e6 * np.exp(-0.196), 2e6 * np.exp(0.196)), rel=1e-3)
    assert told["stiffness_ratio"].value == approx(0.5)
    assert told["stiffness_ratio"].interval is None
    assert told["free_frequency"].uncertainty == approx(3.0)
    assert told["pressed_frequency"].uncertainty == approx(4.0)
    assert (told["frequency_shift"].value, told["frequency_shift"].uncertainty) == approx((60.0, 5.0))
    floating = replace(STIFFNESS, free_frequency=0.0, free_uncertainty=0.0, drift=1.5)
    told = {each.name: each for each in _stiffness_values(floating, settings)}
    assert told["free_frequency"].uncertainty is None
    assert told["drift"].value == approx(1.5)
    assert told["drift"].uncertainty is None


def fit(kind: str, frequency: list[float], peak: float) -> Any:
    response = peak * np.array([0.5, 1j, -0.25])
    spectrum = SimpleNamespace(frequency=np.array(frequency), response=response, quantity=kind)
    resonance = Resonance(frequency=frequency[1], frequency_uncertainty=0.0, quality_factor=9.0, relative_height=1.0)
    other = replace(resonance, frequency=frequency[2], frequency_uncertainty=0.1)
    return SimpleNamespace(spectrum=spectrum, fitted=0.5 * response, resonances=(resonance, other))


@pytest.mark.parametrize(("top", "scale", "unit"), [(10e3, 1.0, "Hz"), (11e3, 1e-3, "kHz")])
def test_spectra_are_drawn_over_their_maxima_and_the_resonances_that_were_compared_marked(
    top: float, scale: float, unit: str
) -> None:
    free, again, pressed, large = (
        fit(kind, [100.0, 200.0 + place, top], 3.0 + place)
        for place, kind in enumerate(("velocity", "velocity", "displacement", "velocity"))
    )
    chosen = tuple(each.resonances[0] for each in (free, again, pressed, large))
    found: Any = SimpleNamespace(free=(free, again), pressed=pressed, large=large, chosen=chosen)
    chart = chart_of(resonances_figure(found))
    (panel,) = chart.panels
    assert panel.x.unit == unit
    assert panel.y.logarithmic
    assert panel.y.label == "Response by displacement, velocity over its maximum"
    lines = [part for part in panel.parts if isinstance(part, Line)]
    assert [line.label for line in lines] == ["free", "free again", "pressed", "large drive"]
    assert lines[2].x == approx([scale * 100.0, scale * 202.0, scale * top])
    assert all(line.y == approx([0.25, 0.5, 0.125]) for line in lines)
    points = [part for part in panel.parts if isinstance(part, Points)]
    assert all(each.y == approx([0.5, 1.0, 0.25]) for each in points)
    marks = [part.value for part in panel.parts if isinstance(part, Rule)]
    assert marks == approx([scale * 200.0, scale * 201.0, scale * 202.0, scale * 203.0])
    alone: Any = SimpleNamespace(free=(free,), pressed=pressed, large=None, chosen=chosen)
    labels = [part.label for part in chart_of(resonances_figure(alone)).panels[0].parts if isinstance(part, Line)]
    assert labels == ["free", "pressed"]


# -- impedance

F_S, C_0, C_1, QUALITY = 22e3, 2e-9, 3e-10, 150.0
OMEGA = 2 * np.pi * F_S
CIRCUIT = ButterworthVanDyke(
    parallel_capacitance=C_0,
    branches=(
        MotionalBranch(resistance=1 / (OMEGA * C_1 * QUALITY), inductance=1 / (OMEGA**2 * C_1), capacitance=C_1),
    ),
)


def admittance(frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Of a capacitor beside a series resonance. [S]"""
    s = 2j * np.pi * frequency
    ratio = frequency / F_S
    return np.asarray(s * (C_0 + C_1 / (1 - ratio**2 + 1j * ratio / QUALITY)))


def impedance_file(path: Path) -> Path:
    f = np.linspace(18e3, 27e3, 361)
    z = 1 / admittance(f)
    rows = [f"{a},{abs(b)},{np.degrees(np.angle(b))}" for a, b in zip(f, z, strict=True)]
    path.write_text("\n".join(["frequency (Hz),impedance (ohm),phase (deg)", *rows]))
    return path


def test_an_impedance_gives_its_circuit_with_each_branch_by_its_number(tmp_path: Path) -> None:
    sheet = impedance_sheet(impedance_file(tmp_path / "z.csv"), settings=ImpedanceSettings(branches=1))
    told = {each.name: each for each in sheet.values}
    assert told["parallel_capacitance"].value == approx(C_0, rel=1e-3)
    assert told["capacitance_1"].value == approx(C_1, rel=1e-3)
    assert told["capacitance_1"].label.endswith(", branch 1")
    assert told["capacitance_1"].unit == "F"
    assert told["series_frequency_1"].value == approx(F_S, rel=1e-5)
    assert told["mechanical_quality_factor_1"].value == approx(QUALITY, rel=1e-3)
    assert told["residual_rms"].value < 1e-3
    assert told["residual_rms"].label == "Root mean square of the log-complex residual"
    interval = told["series_frequency_1"].interval
    assert interval is not None
    assert interval[0] <= told["series_frequency_1"].value <= interval[1]
    assert sheet.source["points"] == "361, 18 kHz to 27 kHz"
    assert sheet.source["residual"] == "log-complex"
    assert [each.title for each in sheet.figures] == ["Impedance with the fitted circuit", "Admittance circle"]


def test_a_lossy_capacitance_and_leads_have_their_values_and_labels(tmp_path: Path) -> None:
    f = np.linspace(180e3, 270e3, 241)
    s = 2j * np.pi * f
    motional = 2e-10 / (1 - (f / 220e3) ** 2 + 1j * f / (220e3 * 150))
    z = 1 / (s * (2e-9 * (1 - 0.03j) + motional)) + 4.0 + s * 9e-6
    z = z * (1 + 0.003 * np.random.default_rng(6).standard_normal((2, f.size)).T @ np.array([1, 1j]))
    rows = [f"{a / 1e3:.9g};{b.real:.9g};{b.imag:.9g}".replace(".", ",") for a, b in zip(f, z, strict=True)]
    (tmp_path / "z.csv").write_bytes(
        "\n".join(["Gerät", "Frequenz (kHz);Realteil (Ohm);Imaginärteil (Ohm)", *rows]).encode("cp1252")
    )
    sheet = impedance_sheet(tmp_path / "z.csv", settings=ImpedanceSettings(branches=1))
    told = {each.name: each for each in sheet.values}
    for name, value in (("loss_tangent", 0.03), ("series_inductance", 9e-6), ("series_resistance", 4.0)):
        assert told[name].value == approx(value, rel=0.15)
    labels = [each.label for each in sheet.values]
    assert {"Dielectric loss tangent", "Lead inductance", "Lead resistance"} <= set(labels)
    assert "Coupling factor by C/(C0 + C), branch 1" in labels
    assert "Parallel resonance of the whole circuit, branch 1" in labels
    assert sheet.source["columns"] == "Frequenz (kHz), Realteil (Ohm), Imaginärteil (Ohm)"
    assert [caveat for caveat in sheet.caveats if "Windows-1252" not in caveat] == []
    plain = impedance_sheet(tmp_path / "z.csv", settings=ImpedanceSettings(branches=1, parts=()))
    assert not {"loss_tangent", "series_inductance", "series_resistance"} & {each.name for each in plain.values}


def test_leads_of_a_known_resistance_are_taken_off(tmp_path: Path) -> None:
    f = np.linspace(18e3, 27e3, 361)
    z = 1 / admittance(f) + 40.0
    rows = [f"{a},{abs(b)},{np.degrees(np.angle(b))}" for a, b in zip(f, z, strict=True)]
    (tmp_path / "z.csv").write_text("\n".join(["frequency (Hz),impedance (ohm),phase (deg)", *rows]))
    settings = ImpedanceSettings(branches=1, series_resistance=40.0, residual="linear-magnitude")
    sheet = impedance_sheet(tmp_path / "z.csv", settings=settings)
    assert values(sheet)["mechanical_quality_factor_1"] == approx(QUALITY, rel=1e-3)
    assert sheet.source["residual"] == "linear-magnitude"


def test_magnitude_phase_and_residual_are_those_of_both_impedances() -> None:
    f = np.array([20e3, 22e3, 26e3])
    measured = ImpedanceSpectrum(frequency=f, impedance=1 / (1.1 * np.exp(0.2j) * admittance(f)))
    magnitude, phase, residual = (panel.parts for panel in circuit_chart(measured, CIRCUIT).panels)
    points, fitted = magnitude
    assert isinstance(points, Points)
    assert isinstance(fitted, Line)
    assert points.x == approx([20.0, 22.0, 26.0])
    assert points.y == approx(1 / np.abs(1.1 * admittance(f)))
    assert fitted.y == approx(1 / np.abs(admittance(f)))
    points, fitted = phase
    assert isinstance(points, Points)
    assert isinstance(fitted, Line)
    assert fitted.y == approx(-np.degrees(np.angle(admittance(f))))
    assert fitted.y - points.y == approx(np.full(3, np.degrees(0.2)))
    # the logarithm of the fitted over the measured admittance
    by_magnitude, by_phase = residual
    assert isinstance(by_magnitude, Line)
    assert isinstance(by_phase, Line)
    assert by_magnitude.y == approx(np.full(3, -np.log(1.1)))
    assert by_phase.y == approx(np.full(3, -0.2))
    axes = [panel.y for panel in circuit_chart(measured, CIRCUIT).panels]
    assert axes[0].logarithmic
    assert (axes[1].lowest, axes[1].highest, axes[1].ticks) == (-100.0, 100.0, (-90, 0, 90))
    without = circuit_chart(replace(measured, has_phase=False), CIRCUIT).panels
    assert [len(panel.parts) for panel in without] == [2, 1, 1]


def test_a_mode_draws_a_circle_of_its_conductance_in_millisiemens() -> None:
    f = np.linspace(20e3, 24e3, 41)
    measured = ImpedanceSpectrum(frequency=f, impedance=1 / (2 * admittance(f)))
    (panel,) = chart_of(admittance_circle_figure(measured, CIRCUIT)).panels
    points, fitted = panel.parts
    assert isinstance(points, Points)
    assert isinstance(fitted, Line)
    assert points.x == approx(2e3 * admittance(f).real)
    assert points.y == approx(2e3 * admittance(f).imag)
    # at resonance the conductance is one over the resistance
    assert fitted.x.max() == approx(1e3 * OMEGA * C_1 * QUALITY, rel=1e-4)
    assert (fitted.x[0], fitted.y[0]) == approx((1e3 * admittance(f)[0].real, 1e3 * admittance(f)[0].imag))
    assert (fitted.x[-1], fitted.y[-1]) == approx((1e3 * admittance(f)[-1].real, 1e3 * admittance(f)[-1].imag))
