"""Section 2.4: figures of the welder rig with its force gauge, and of the mechanisms of metal forming.

No reading of the gauge is printed. A waveguide with Preisach's hysteresis, of assumed stiffness and loss, stands for
the one of D: its readings are calibrated as a measured file is, and converted by that calibration.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.optimize import brentq

from dong2015.chapter2 import flextensional
from dong2015.chapter2.welder import printed_forces
from dong2015.plots import axes_row, line_style, report_figure, single_axes
from sonolube.checks import Floats
from sonolube.execution.compilation import few_points
from sonolube.facts.published import si_value
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure, subplots
from sonolube.measurement.gauge.calibration import PreisachCalibration, fit_branches, fit_preisach, force_from_preisach
from sonolube.measurement.gauge.preisach import PreisachPlane
from sonolube.models.friction import (
    acoustic_softening_ratio,
    parallel_vibration_ratio,
    reference_intensity_from_test,
    superposed_mean_stress,
    transverse_vibration_ratio,
)
from sonolube.validation.published_tests import friction_tests

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ROUND_TIP: Final = 1  # rows of Table 2.9
_FLAT_TIP: Final = 2
_LARGEST_DEFLECTION: Final = 80e-6  # m, assumed
_STIFFNESS: Final = 0.45e6  # N/m, assumed: of the first pull
_LOSS: Final = 0.35  # of the stiffness, which relays take away by the largest deflection; assumed
_LEVELS: Final = 8
_NOISE: Final = 0.15  # N, of the load cell in a pull by hand, assumed
_PULLS: Final = (1.0, 0.8, 0.6, 0.4, 0.2)  # deflections at which the pull is released, over the largest
_READINGS: Final = 40  # of each pull and of each release
_START: Final = 0.2  # s in which the motor takes up the slack, assumed
_VIBRATED: Final = (3.0, 8.0)  # s, assumed: D says a few seconds
_GAUGE: Final = (
    f"a waveguide of {1e-6 * _STIFFNESS:g} N/µm, of whose force hysteresis takes {100 * _LOSS:g} % at "
    f"{1e6 * _LARGEST_DEFLECTION:g} µm, "
    f"and a load cell that scatters by {_NOISE:g} N"
)


def welder_figures() -> Iterator[ReportFigure]:
    """Figures of section 2.4."""
    yield report_figure("figure-2-32-calibration", _calibration, gauge=_GAUGE)
    yield report_figure(
        "figure-2-33-welder-friction", _friction_in_time, gauge=_GAUGE, first=_VIBRATED[0], last=_VIBRATED[1]
    )


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Readings:
    """Readings of the calibration: deflection, and force of the pull.

    Parameters
    ----------
    deflection : ndarray, shape (n,)
        In the order of time, in m.
    applied_force : ndarray, shape (n,)
        Of the load cell. [N]
    """

    deflection: Floats
    applied_force: Floats


@cache
def waveguide() -> PreisachCalibration:
    """Assumed waveguide: a spring with relays of one density over the plane of Preisach."""
    plane = PreisachPlane(lowest=0.0, highest=_LARGEST_DEFLECTION, levels=_LEVELS)
    up, down = np.tril_indices(_LEVELS)
    share = np.where(up == down, 0.5, 1.0)  # cells on the diagonal are triangles
    return PreisachCalibration(
        plane=plane,
        reversible=np.full(_LEVELS, _STIFFNESS * _LARGEST_DEFLECTION / _LEVELS),
        weights=share / share.sum() * _LOSS * _STIFFNESS * _LARGEST_DEFLECTION,
        resting_force=0.0,
        force_deviation=_NOISE,
    )


@cache
def readings() -> Readings:
    """Generated readings of pulls that are released at five deflections, with scatter of the load cell."""
    turns = [0.0]
    for pull in _PULLS:
        turns += [pull * _LARGEST_DEFLECTION, 0.0]
    legs = [np.linspace(start, end, _READINGS, endpoint=False) for start, end in pairwise(turns)]
    x = np.concatenate([*legs, [0.0]])
    noise = _NOISE * np.random.default_rng(20).standard_normal(x.size)
    return Readings(deflection=x, applied_force=force_from_preisach(waveguide(), displacement=x).applied_force + noise)


@cache
def calibration() -> PreisachCalibration:
    """Preisach's calibration by the readings."""
    found = readings()
    return fit_preisach(displacement=found.deflection, applied_force=found.applied_force, levels=_LEVELS)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TipRecord:
    """Deflection and friction in time of the test with a tip.

    Parameters
    ----------
    time : ndarray, shape (n,)
        From the first deflection on. [s]
    deflection : ndarray, shape (n,)
        Of the waveguide, in m.
    friction_force : ndarray, shape (n,)
        By the calibration. [N]
    """

    time: Floats
    deflection: Floats
    friction_force: Floats


def tip_record(tip: int, *, samples: int = 401) -> TipRecord:
    """Record of the test with a tip: 1 round, 2 flat, rows of Table 2.9.

    Of the duration of the printed revolutions.
    """
    slow, fast = (si_value(f"table-2.8-rotation_speed-{row}") for row in (2 * tip - 1, 2 * tip))
    first, last = _VIBRATED
    turns = si_value(f"table-2.8-revolutions-{2 * tip - 1}")
    end = last - first + (turns - fast * (last - first)) / slow
    time = np.linspace(0.0, end, samples)
    vibrated = (time >= first) & (time < last)
    turned = slow * time + (fast - slow) * (np.clip(time, first, last) - first)
    without, with_vibration = printed_forces(tip)
    highest = _deflection(without.high)
    lowest = _deflection(with_vibration.low, highest)
    off = _deflection(without.low, highest), highest
    on = lowest, _deflection(with_vibration.high, highest, lowest)
    low, high = (np.where(vibrated, of_on, of_off) for of_off, of_on in zip(off, on, strict=True))
    started = np.minimum(time / _START, 1.0)
    x = started * ((low + high) / 2 + (high - low) / 2 * np.sin(2 * np.pi * turned))
    force = force_from_preisach(calibration(), displacement=x).applied_force
    return TipRecord(time=time, deflection=x, friction_force=force)


def _deflection(force: float, *before: float) -> float:
    """Deflection at which the assumed waveguide carries a force, after others that it had. [m]"""

    def excess(x: float) -> float:
        return float(force_from_preisach(waveguide(), displacement=[0.0, *before, x]).applied_force[-1]) - force

    return float(brentq(excess, 0.0, _LARGEST_DEFLECTION, xtol=1e-9))


def _calibration() -> "Figure":
    """Draw the readings with Preisach's model, and with one curve for loading and one for unloading."""
    figure, axes = single_axes()
    with few_points():
        found, fitted = readings(), calibration()
        model = force_from_preisach(fitted, displacement=found.deflection).applied_force
    branches = fit_branches(displacement=found.deflection, applied_force=found.applied_force)
    um = 1e6 * found.deflection
    axes.plot(um, found.applied_force, ".", color="0.55", markersize=3, label="readings, generated")
    axes.plot(um, model, color=COLOURS[1], linewidth=1.1, label="Preisach's model")
    order = np.linspace(0.0, um.max(), 101)
    for name, curve in (("loading and unloading", branches.loading), (None, branches.unloading)):
        axes.plot(order, curve(1e-6 * order), LINES[1], color=COLOURS[0], label=name)
    axes.set(xlabel="Deflection of the waveguide [µm]", ylabel="Pulling force [N]", xlim=(-2, 82), ylim=(-1, 27))
    axes.locator_params(axis="x", nbins=5)
    axes.legend(loc="upper left")
    return figure


def _friction_in_time() -> "Figure":
    """Draw deflection and friction in time of the flat and of the round tip."""
    figure, panels = subplots(2, 2, figsize=(7.2, 4.6), sharex="col", sharey="row")
    for (deflected, rubbed), (tip, name) in zip(
        panels.T, ((_FLAT_TIP, "Flat tip"), (_ROUND_TIP, "Round tip")), strict=True
    ):
        with few_points():
            record = tip_record(tip)
        deflected.plot(record.time, 1e6 * record.deflection, **line_style(0))
        rubbed.plot(record.time, record.friction_force, **line_style(0), label="by the gauge")
        first, last = _VIBRATED
        off, on = printed_forces(tip)
        for number, spans in ((off, ((0.0, first), (last, record.time[-1]))), (on, ((first, last),))):
            for start, end in spans:
                rubbed.fill_between([start, end], number.low, number.high, color="0.8", linewidth=0, zorder=0)
        rubbed.fill_between([], [], [], color="0.8", label="range of Table 2.9")
        rubbed.plot(
            [first, last],
            np.full(2, off.value * stick_slip_ratio(tip)),
            LINES[1],
            color=COLOURS[1],
            label="asperity stick-slip",
        )
        deflected.set_title(name, fontsize=9)
        rubbed.set(xlabel="Time [s]", xlim=(0, record.time[-1]), xticks=(0, 3, 8))
    panels[0, 0].set(ylabel="Deflection [µm]", ylim=(0, 70), yticks=(0, 20, 40, 60))
    panels[1, 0].set(ylabel="Friction force [N]", ylim=(0, 23))
    figure.legend(*panels[1, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def stick_slip_ratio(tip: int) -> float:
    """Friction ratio of the test with a tip by asperity stick-slip: 1 round, 2 flat. []"""
    return float(flextensional.stick_slip_ratio(friction_tests("G")[tip - 1]))


def metal_forming_figures() -> Iterator[ReportFigure]:
    """Figure of section 2.4.1."""
    yield report_figure("figures-2-28-2-29-metal-forming", _mechanisms)


def zinc_intensity() -> float:
    """Intensity over that of flow without load at which acoustic softening has the 40 % on zinc. []"""
    ratio = 1 - si_value("2.4.1-blaha-force-reduction")
    return 1 / float(reference_intensity_from_test(stress_ratio=ratio, acoustic_intensity=1.0))


def _mechanisms() -> "Figure":
    """Draw mean stress over stress amplitude, flow stress over intensity, and friction over speed."""
    figure, (stress, softening, friction) = axes_row(3, (7.8, 3.3), sharey=True)
    amplitude = np.linspace(0.0, 1.5, 151)
    mean = superposed_mean_stress(yield_strength=1.0, youngs_modulus=1.0, strain_amplitude=amplitude)
    stress.plot(amplitude, mean, **line_style(0), label="superposition")
    stress.plot([0.5, 0.5], [0, 1.1], ":", color="0.4", linewidth=1)
    stress.set(xlabel="Stress amplitude\nover yield strength [1]", ylabel="Over the value without vibration [1]")
    intensity = np.linspace(0.0, 1.2, 241)
    ratio = acoustic_softening_ratio(acoustic_intensity=intensity, reference_intensity=1.0)
    softening.plot(intensity, ratio, **line_style(0), label="acoustic softening")
    zinc = zinc_intensity(), 1 - si_value("2.4.1-blaha-force-reduction")
    softening.plot(*zinc, MARKERS[3], color="black", ms=7, label="zinc crystal, D 2.4.1")
    softening.set(xlabel="Intensity over that of\nflow without load [1]")
    speed = np.linspace(1e-3, 1.5, 151)
    for index, (name, model) in enumerate(
        (("along", parallel_vibration_ratio), ("across", transverse_vibration_ratio))
    ):
        friction.plot(speed, model(sliding_speed=speed, vibration_velocity=1.0), **line_style(index), label=name)
    without = si_value("2.4.1-lucas-coefficient-static")
    for index, name in enumerate(("vibrated", "none"), start=2):
        coefficient = si_value(f"2.4.1-lucas-coefficient-{name}")
        style: dict[str, Any] = {"color": COLOURS[index], "linestyle": LINES[index], "clip_on": False, "zorder": 3}
        friction.axhline(coefficient / without, **style, label=f"extrusion, {coefficient:g}")
    friction.set(xlabel="Sliding speed over peak\nvibration velocity [1]")
    for axes in (stress, softening, friction):
        axes.set(ylim=(0, 1.5), yticks=(0, 0.5, 1))
        axes.set_xlim(left=0)
        axes.legend(loc="upper left")
    return figure
