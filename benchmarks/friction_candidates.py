"""Candidates for what asperity stick-slip misses in D Table 4.2, fitted to sets A to G and to each six of them.

Run: python benchmarks/friction_candidates.py          (3 minutes)
It prints the table of docs/validation.md, and what an exact model would get. Those that stay are variants of
`sonolube compare`.
"""

import sys
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
from scipy.optimize import brentq

from sonolube.models.contact import GaussianHeights, separation
from sonolube.models.friction import sine_stick_slip_ratio
from sonolube.validation.assessment import FITTED_SETS, assess_variant, leave_one_set_out_fits, root_mean_square
from sonolube.validation.comparison import compared_models
from sonolube.validation.model_variant import MEMORY_LENGTH, FreeParameter, ModelVariant, per_rig
from sonolube.validation.published_tests import FrictionTest, friction_tests, with_printed_roughness

PHASES = np.cos(2 * np.pi * np.arange(240) / 240)
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(15)
_KEPT = ("asperity-stick-slip-fitted", "asperity-stick-slip-decay-constant", "spring-flat-on-roughness")
_IN_PLANE = ("asperity-stick-slip-in-plane",)
NOMINALLY_EQUAL = (
    "A-1",
    "C-1",
    "D-1",
    "E-1",
    "F-1",
)  # 2.5 um, 13.5 to 20.3 mm/s, 3 N and the same contact in the records
UNSTATED = 0.045  # uncertainty of the ratio where D states none: the mean of the others


def sine(test: FrictionTest, memory_length: float, decay_length: float | None = None) -> float:
    return float(
        sine_stick_slip_ratio(
            decay_length=test.contact.roughness.rms_height / 3 if decay_length is None else decay_length,
            vibration_amplitude=test.vibration_amplitude,
            frequency=test.frequency,
            sliding_speed=test.sliding_speed,
            memory_length=memory_length,
        )
    )


def population(test: FrictionTest, heights: Any, weights: Any, gap: float, memory_length: float, rigid: bool) -> float:
    """Return the friction ratio of springs of any heights about the balanced gap: elastic, or of a slid distance."""
    a, slide = test.vibration_amplitude, test.sliding_speed / test.frequency / PHASES.size
    load = float(weights @ np.maximum(heights - gap, 0))

    def excess(mean: float) -> float:
        pressed = np.maximum(heights[:, None] - mean - a * PHASES[None, ::4], 0)
        return float(np.mean(weights @ pressed)) - load

    gaps = brentq(excess, gap - a, gap + a + 1e-9) + a * PHASES
    length = test.contact.roughness.rms_height / 3 / memory_length
    state = np.where(heights > gaps[0], np.inf, 0.0) if rigid else np.maximum(heights - gaps[0], 0.0)
    for _ in range(2):
        total = 0.0
        for x in gaps:
            depth = np.maximum(heights - x, 0.0)
            if rigid:  # friction grows with the distance slid since contact
                state = np.where(depth > 0, state + slide / memory_length, 0.0)
                force = np.minimum(state, 1.0) * depth
            else:
                state = force = np.minimum(state + length * slide, depth)
            total += float(weights @ force)
    return total / load / PHASES.size


def distributed(test: FrictionTest, memory_length: float, spread: float) -> float:
    lengths = memory_length * np.exp(spread * NODES)
    return float(np.average([sine(test, float(length)) for length in lengths], weights=WEIGHTS))


def zero_error(test: FrictionTest, memory_length: float, zero_error: float = 0.0) -> float:
    read = test.friction_coefficient * test.normal_load
    return (sine(test, memory_length) * (read + zero_error) - zero_error) / read


def wearing_in(test: FrictionTest, memory_length: float, wear_in_length: float = np.inf) -> float:
    level = int(test.label[-1]) if test.set_name == "B" else 0
    slid = test.sliding_speed * (12.5 + 4 * (level - 0.5)) * (level > 0)  # D 4.1.2: 12.5 s, then 4 s at each voltage
    return sine(test, memory_length, test.contact.roughness.rms_height / 3 * np.exp(-slid / wear_in_length))


def nominal_amplitude(test: FrictionTest, memory_length: float, power: float = 1.0) -> float:
    share = test.vibration_amplitude / 2.5e-6 if test.set_name == "B" else 1.0  # of that at 28 V, D appendix A 3.1.3
    return sine(replace(test, vibration_amplitude=test.vibration_amplitude * share ** (power - 1)), memory_length)


def mindlin_like(test: FrictionTest, memory_length: float, exponent: float) -> float:
    return sine(test, memory_length * (test.friction_coefficient / 0.3) ** exponent)


def of_speed(test: FrictionTest, memory_length: float, exponent: float) -> float:
    return sine(test, memory_length * (test.sliding_speed / 0.05) ** exponent)


@cache
def gaussian_gap(test: FrictionTest) -> float:
    return float(separation(replace(test.contact, heights=GaussianHeights()), normal_load=test.normal_load))


def gaussian(test: FrictionTest, memory_length: float) -> float:
    deviation, gap = test.contact.roughness.rms_height, gaussian_gap(test)
    heights = np.linspace(gap - test.vibration_amplitude, 6 * deviation, 140)
    return population(test, heights, np.exp(-((heights / deviation) ** 2) / 2), gap, memory_length, rigid=False)


def exponential(test: FrictionTest, memory_length: float, cap: float = 16.0, *, rigid: bool = False) -> float:
    length = test.contact.roughness.rms_height / 3
    heights = np.linspace(-test.vibration_amplitude, cap * length, 140)
    return population(test, heights, np.exp(-heights / length), 0.0, memory_length, rigid=rigid)


def number(name: str, start: float, low: float, high: float, default: float | None = None) -> FreeParameter:
    return FreeParameter(
        name=name,
        default=start if default is None else default,
        initial_values=(start,),
        low=low,
        high=high,
        reason="to see whether the data ask for it",
    )


def named(name: str, ratio: Any, *parameters: FreeParameter) -> ModelVariant:
    return ModelVariant(name, name, ratio, (MEMORY_LENGTH, *parameters))


(ZERO,) = per_rig((number("zero_error", 0.2, 0.0, 2.0, default=0.0),), "power map")
(POWER,) = per_rig((number("power", 1.2, 0.5, 3.0, default=1.0),), "power map")
(WEAR_IN,) = per_rig((number("wear_in_length", 3.0, 0.3, 1e3, default=1e9),), "power map")
CANDIDATES = (
    *compared_models(_KEPT),
    *compared_models(_IN_PLANE),
    named("zero of the load cell in B", zero_error, ZERO),
    named("amplitude of B with voltage^p", nominal_amplitude, POWER),
    named("plates of B smooth with distance", wearing_in, WEAR_IN),
    named("lognormal memory lengths", distributed, number("spread", 0.5, 0.01, 3.0)),
    named("memory length with friction^p", mindlin_like, number("exponent", 0.1, -2.0, 2.0)),
    named("memory length with speed^p", of_speed, number("exponent", 0.1, -2.0, 2.0)),
    named("Gaussian heights", gaussian),
    named("exponential heights, capped", exponential, number("cap", 5.0, 0.3, 14.0)),
    named("friction grows with the slid distance", partial(exponential, rigid=True)),
)


def row(variant: ModelVariant) -> str:
    known = assess_variant(variant, FITTED_SETS)
    printed = assess_variant(variant, FITTED_SETS, tests=with_printed_roughness(friction_tests()))
    others = leave_one_set_out_fits(variant, FITTED_SETS)
    found = []
    for index, parameter in enumerate(variant.parameters):
        left = [
            fit.values[index]
            for letter, fit in zip(FITTED_SETS, others, strict=True)
            if parameter.applies_to(FITTED_SETS.replace(letter, ""))
        ]
        scale, unit = (1e6, " um") if parameter.unit == "m" else (1.0, "")
        values = [f"{scale * value:.3g}" for value in (known.fit.values[index], min(left), max(left))]
        found.append(f"{parameter.name.replace('_', ' ')} {values[0]}{unit} ({values[1]} to {values[2]})")
    fit, unseen, worst = known.fit_errors, known.cross_validation_errors, printed.cross_validation_errors
    absolute = np.median([abs(e) for e in unseen_errors(others)])
    median = f"{100 * unseen.median_relative:.0f} % | {absolute:.3f}"
    criterion = known.information.aicc if known.information else np.nan
    return (
        f"| {variant.name} | {len(variant.parameters)} | {fit.rms:.3f} | {unseen.rms:.3f} | "
        f"{median} | {criterion:.1f} | {worst.rms:.3f} | {'; '.join(found)} |"
    )


def unseen_errors(others: Any) -> list[float]:
    return [
        (fit.predict(test) or 0.0) - test.friction_ratio
        for letter, fit in zip(FITTED_SETS, others, strict=True)
        for test in friction_tests(letter)
    ]


def mean_of_closures() -> str:
    """Errors of the mean of the unseen predictions of the two closures of `sonolube predict`."""
    closures = compared_models(("asperity-stick-slip-fitted", "spring-flat-on-roughness"))
    errors = np.mean([unseen_errors(leave_one_set_out_fits(each, FITTED_SETS)) for each in closures], axis=0)
    return f"mean of two closures: unseen rms {root_mean_square(errors):.3f}, median {np.median(np.abs(errors)):.3f}"


def exact_model(collections: int = 4000) -> str:
    """Unseen errors of stick-slip were it exact but for the scatter between equal tests and that which is stated."""
    tests = friction_tests(FITTED_SETS)
    lengths = np.geomspace(0.3e-6, 12e-6, 400)
    ratios = np.array([[sine(test, length) for length in lengths] for test in tests])
    measured = np.array([test.friction_ratio for test in tests])
    exact = ratios[:, np.argmin(np.sum((ratios - measured[:, None]) ** 2, axis=0))]
    stated = np.array([test.uncertainty or UNSTATED for test in tests])
    equal = [test.label in NOMINALLY_EQUAL for test in tests]
    total = float(np.std((measured - exact)[equal], ddof=1))
    between = np.sqrt(total**2 - np.mean(stated[equal] ** 2))
    names = np.array([test.set_name for test in tests])
    rng, found = np.random.default_rng(0), []
    for _ in range(collections):
        of_rig = dict(zip(FITTED_SETS, between * rng.standard_normal(len(FITTED_SETS)), strict=True))
        drawn = exact + [of_rig[name] for name in names] + stated * rng.standard_normal(len(tests))
        best = {name: np.argmin(np.sum((ratios - drawn[:, None])[names != name] ** 2, axis=0)) for name in FITTED_SETS}
        errors = np.array([ratios[i, best[name]] for i, name in enumerate(names)]) - drawn
        found.append((root_mean_square(errors), np.median(np.abs(errors))))
    (low, middle, high), medians = np.quantile(found, (0.1, 0.5, 0.9), axis=0).T
    return (
        f"exact model, scatter of equal tests {total:.3f}: unseen rms {middle:.3f} (80 %: {low:.3f} to {high:.3f}), at "
        f"most 0.10 in {np.mean(np.array(found)[:, 0] <= 0.1):.0%}, median error {medians[1]:.3f}"
    )


if __name__ == "__main__":
    for candidate in CANDIDATES:
        sys.stdout.write(row(candidate) + "\n")
        sys.stdout.flush()
    for line in (mean_of_closures(), exact_model()):
        sys.stdout.write(line + "\n")
