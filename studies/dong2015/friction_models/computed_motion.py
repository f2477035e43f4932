"""Published friction tests: rows by the default model with every other beside it, and motions by the dynamics.

Computed motions change the ratios of Tables 2.3 and 4.2 by less than a thousandth, but for the bristle of Table 4.2,
whose ratio time integration lowers by up to 0.003. The contact force, a few newtons, is
small beside the inertia force of the tip, thousands of newtons: higher harmonics stay below 1e-4 of the first. A slow
motion of the arm of any size has no effect: exponential heights have no length scale but the decay length, so that a
shift of the gap multiplies normal force and friction of every asperity by one factor, whose mean is 1 where the mean
force is the load. An error of the dead load cancels in the ratio, unless it occurs with the vibration alone; the last
row of Table 4.2 would require a loss of five sixths of the load.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from dong2015.friction_models.mechanisms import mechanism_predictions
from dong2015.friction_models.variants import DEFAULT, Predictions, is_fitted_to, variant_predictions
from dong2015.plots import axes_row, draw_measured, point_style, report_figure
from dong2015.published_rigs import identified_structure
from dong2015.row import Row, default_model_row
from sonolube.checks import Floats
from sonolube.facts.published import PrintedNumber, PublishedValue, si_value
from sonolube.figure import COLOURS, ReportFigure
from sonolube.models.contact import ContactMotion, decay_length, load_balanced_motion, sinusoidal_motion
from sonolube.models.dynamics import ExponentialGap, contact_motion as motion_of, steady_state, trajectory
from sonolube.models.friction import EMPIRICAL_MEMORY_LENGTH, FRICTION_MODELS
from sonolube.validation.assessment import FITTED_SETS, root_mean_square
from sonolube.validation.friction_model_variants import asperity_stick_slip
from sonolube.validation.published_tests import (
    FLEXTENSIONAL,
    FLEXTENSIONAL_GAINS,
    NORMAL_VIBRATION_SETS,
    FrictionTest,
    friction_tests,
    with_printed_roughness,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOTIONS: Final = {
    "sine": "a prescribed sine of the stated amplitude, balanced",
    "harmonic-balance": "the steady motion of the identified tribometer, all harmonics",
    "swinging-arm": "that motion on an arm that swings by a decay length at 100 Hz",
    "time-integration": "time integration of the tribometer from rest, the last arm period of 0.05 s",
}
"""Motions of the gap, in words."""

TESTS: Final = "AB"
"""Letters of the sets of known voltage: Tables 2.3 and 4.2."""

MODELS: Final = ("asperity_stick_slip", "bristle_with_holder")
"""Friction models with default parameters, the holder rigid."""

_SAMPLES: Final = 256  # in a period of the drive
_SAMPLES_OF_ARM_PERIOD: Final = 64  # in a period of the drive, over an arm period of them
_STEPS: Final = 64  # of the time integration in a period of the drive


@dataclass(frozen=True, kw_only=True, slots=True)
class MotionPredictions:
    """Friction ratios of one test by every model under every motion.

    Parameters
    ----------
    test : FrictionTest
    ratios : mapping of (str, str) to float
        Friction ratio by model and motion.
    """

    test: FrictionTest
    ratios: Mapping[tuple[str, str], float]


@cache
def motion_predictions() -> tuple[MotionPredictions, ...]:
    """Friction ratios by every model under every motion, for each test of both tables."""
    return tuple(
        MotionPredictions(
            test=test,
            ratios={(model, name): _ratio(model, test, moving) for model in MODELS for name, moving in _motions(test)},
        )
        for test in friction_tests(TESTS)
    )


def computed_motion_prediction(test: FrictionTest) -> Predictions:
    """Friction ratio of a test of Table 2.3 or 4.2 by asperity stick-slip on the computed steady motion.

    Empty for a test of another table.
    """
    predictions: Predictions = {}
    for one in motion_predictions():
        if one.test == test:
            ratios = {name: one.ratios["asperity_stick_slip", name] for name in MOTIONS}
            by_motion = "; ".join(f"{MOTIONS[name]} {ratio:.4f}" for name, ratio in ratios.items())
            note = (
                "Friction model asperity_stick_slip with its default parameters. "
                f"Ratio measured {test.friction_ratio:.3f}; on {by_motion}."
            )
            predictions["asperity-stick-slip on computed motion"] = (ratios["harmonic-balance"], note)
    return predictions


def computed_motion_figures() -> Iterator[ReportFigure]:
    """Figure of friction on computed motions."""
    yield report_figure(
        "friction-models-on-computed-motion",
        _ratios_and_changes,
        motions="; ".join(f"{name.replace('-', ' ')}, {motion}" for name, motion in MOTIONS.items()),
    )


def swinging_arm_motion(test: FrictionTest, moving: ContactMotion, *, swing: float, cycles: int) -> ContactMotion:
    """Gap motion superimposed on a slow oscillation of the arm, load-balanced over the period of the arm."""
    one = moving.resampled(_SAMPLES_OF_ARM_PERIOD).displacement
    slow = swing * np.cos(2 * np.pi * np.arange(cycles * one.size) / (cycles * one.size))
    return load_balanced_motion(
        test.contact, _gap_motion(np.tile(one, cycles) + slow, np.ones(slow.size), test, cycles=cycles)
    )


def _motions(test: FrictionTest) -> Iterator[tuple[str, ContactMotion]]:
    """Yield every motion of a test by name."""
    about_rest = sinusoidal_motion(
        test.contact,
        normal_load=test.normal_load,
        vibration_amplitude=test.vibration_amplitude,
        frequency=test.frequency,
    )
    steady = _steady_motion(test)
    yield "sine", load_balanced_motion(test.contact, about_rest)
    yield "harmonic-balance", steady
    arm = swinging_arm_motion(test, steady, swing=_gap_law(test).decay_length, cycles=_arm_cycles(test))
    yield "swinging-arm", arm
    yield "time-integration", _integrated_motion(test)


def _ratio(model: str, test: FrictionTest, moving: ContactMotion) -> float:
    """Friction ratio of a test by a friction model on a motion. []"""
    speed, mu = test.sliding_speed, test.friction_coefficient
    return float(FRICTION_MODELS[model]().ratio(test.contact, moving, sliding_speed=speed, friction_coefficient=mu))


def _steady_motion(test: FrictionTest) -> ContactMotion:
    """Steady motion of the identified tribometer by harmonic balance."""
    states = steady_state(
        identified_structure(),
        _gap_law(test),
        normal_load=test.normal_load,
        frequency=test.frequency,
        voltage_amplitude=_voltage(test) / 2,
    )
    period = motion_of(states, (), samples=_SAMPLES)
    return _gap_motion(period.displacement, period.normal_force, test)


def _integrated_motion(test: FrictionTest) -> ContactMotion:
    """Last arm period of the tribometer by time integration from rest."""
    cycles = _arm_cycles(test)
    periods = round(si_value("3.3.4-settling-time") * test.frequency)
    contact = trajectory(
        identified_structure(),
        _gap_law(test),
        normal_load=test.normal_load,
        frequency=test.frequency,
        voltage_peak_to_peak=_voltage(test),
        periods=periods,
        steps_per_period=_STEPS,
    ).contact
    last = slice(-cycles * _STEPS, None)
    return _gap_motion(contact.displacement[last], contact.normal_force[last], test, cycles=cycles)


def _gap_motion(displacement: Floats, force: Floats, test: FrictionTest, *, cycles: int = 1) -> ContactMotion:
    """Gap motion of a test over one or several periods of the drive."""
    return ContactMotion(
        displacement=displacement, normal_force=force, frequency=test.frequency / cycles, normal_load=test.normal_load
    )


def _gap_law(test: FrictionTest) -> ExponentialGap:
    """Exponential gap law of the contact of a test."""
    return ExponentialGap(decay_length=float(decay_length(test.contact)))


def _arm_cycles(test: FrictionTest) -> int:
    """Number of periods of the drive in a period of the arm."""
    return round(test.frequency / si_value("3.3.4-residual-frequency"))


def _voltage(test: FrictionTest) -> float:
    """Voltage peak to peak by the amplitude per volt of Table 4.1. [V]"""
    per_volt = si_value("table-4.1-vibration_amplitude-15") / si_value("table-4.1-voltage_peak_to_peak-15")
    return test.vibration_amplitude / per_volt


def _ratios_and_changes() -> "Figure":
    """Draw friction ratios on the steady motion, and their changes by motion against the prescribed sine."""
    figure, (ratios, changes) = axes_row(2, (8.6, 4.4))
    predictions = motion_predictions()
    labels = [one.test.label for one in predictions]
    draw_measured(ratios, friction_tests(TESTS), lambda test: labels.index(test.label), "measured")
    for index, model in enumerate(MODELS):
        label, style = model.replace("_", "-"), point_style(index + 1) | {"color": COLOURS[index]}
        computed = [one.ratios[model, "harmonic-balance"] for one in predictions]
        ratios.plot(range(len(labels)), computed, **style, label=label)
        for name, fill in zip(tuple(MOTIONS)[1:], ("none", COLOURS[index], "0.85"), strict=True):
            change = [max(abs(one.ratios[model, name] - one.ratios[model, "sine"]), 1e-6) for one in predictions]
            changes.plot(range(len(labels)), change, **style, mfc=fill, label=f"{label}, {name.replace('-', ' ')}")
    for axes in (ratios, changes):
        axes.set_xticks(range(len(labels)), labels=labels)
        axes.set_xlabel("Test")
    ratios.set(ylabel="Friction with over without vibration [-]", ylim=(-0.03, 1.08))
    changes.set(yscale="log", ylim=(5e-7, 1), ylabel="Change against the prescribed sine [-]")
    changes.axhspan(0.04, 0.06, color="0.9", zorder=0, label="scatter of the measured ratios")
    for axes, columns in ((ratios, 1), (changes, 2)):
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=columns)
    return figure


POWER_MAP: Final = "B"
"""Letter of the set of Table 4.2, of chapter 4; all others are of chapter 2."""


def tribometer_test_rows() -> Iterator[Row]:
    """Yield the rows of the friction tests of chapter 2."""
    yield from _rows_of_sets("".join(NORMAL_VIBRATION_SETS).replace(POWER_MAP, ""))


def power_map_test_rows() -> Iterator[Row]:
    """Yield the rows of the friction tests of Table 4.2."""
    yield from _rows_of_sets(POWER_MAP)


def roughness_caveat() -> str:
    """Doubt on the roughness of the friction tests, with the error that the printed one would leave."""
    recorded, printed = (
        root_mean_square(
            [
                float(asperity_stick_slip(test, memory_length=EMPIRICAL_MEMORY_LENGTH)) - test.friction_ratio
                for test in tests
            ]
        )
        for tests in (friction_tests(FITTED_SETS), with_printed_roughness(friction_tests(FITTED_SETS)))
    )
    return (
        "friction tests: all sets but B are computed with R_q = 6 um, which D took from comparison standards for other"
        f" tests; with what D prints of the worn surfaces of C and G, rms errors grow from {recorded:.3f} to"
        f" {printed:.3f} (asperity stick-slip, memory length 1.5 um)"
    )


def within_scatter(test: FrictionTest) -> PublishedValue:
    """Friction reduction of a test with the interval of its measurement.

    D derives a reduction from forces and prints both, the forces with their scatter. The interval is that of the
    printed reduction and that of the forces together: where they differ (E16, E17, E27) they are two readings of one
    test.
    """
    assert test.published is not None
    number, scatter = test.published.number, test.uncertainty or 0.0
    low, high = (1 - test.friction_ratio + side * scatter for side in (-1, 1))
    measured: PrintedNumber = replace(number, low=min(number.low, low), high=max(number.high, high))
    return replace(test.published, number=measured, id=f"friction-model-{DEFAULT}-{test.label}")


def _rows_of_sets(sets: str) -> Iterator[Row]:
    """Yield the rows of the tests of some sets, given by their letters, that have a printed reduction."""
    for test in friction_tests(sets):
        if test.published is None:
            continue
        predictions = _predictions(test)
        ratio, note = predictions.pop(DEFAULT)
        yield default_model_row(
            within_scatter(test),
            1 - ratio,
            note,
            fitted="the memory length, with other tests" if is_fitted_to(test) else "",
            possible=_possible(test),
            alternatives={name: (1 - other, other_note) for name, (other, other_note) in predictions.items()},
        )


def _possible(test: FrictionTest) -> tuple[float, float] | None:
    """Limits of the reduction of a flextensional test over the gain at resonance, not printed. []"""
    if test.set_name != FLEXTENSIONAL:
        return None
    least, most = (
        variant_predictions(replace(test, vibration_amplitude=gain * test.vibration_amplitude))[DEFAULT][0]
        for gain in FLEXTENSIONAL_GAINS
    )
    return 1 - least, 1 - most


def _predictions(test: FrictionTest) -> Predictions:
    """Friction ratios of a test by all variants, mechanisms and motions, each with its note, by name."""
    return variant_predictions(test) | mechanism_predictions(test) | computed_motion_prediction(test)
