"""Closures against experiment: every measured friction ratio predicted, without a fit and with one, and how far off.

No fit sees a test it is judged by where it says so: each set in turn is predicted by a fit to the others. A closure
that reaches Table 4.2 must move the surfaces along each other: with dry friction at the normal force of a balanced load
the ratio stays above exp(-beta)/I0(beta), 0.23 at 2.31 um, whatever the stiffness, where 0.04 was measured, and falls
ever more slowly as the amplitude grows, where the measured one falls evenly. Even with decay length and memory length
both free, stick-slip misses the five ratios by 0.13 rms. A parasitic in-plane motion, a fraction of the normal one and
with its own phase, gives them; so would a zero error of 0.35 N. The printed data cannot decide which.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from sonolube.checks import Floats
from sonolube.reproduce.closure_variants import VARIANTS, ClosureVariant
from sonolube.reproduce.experiments import FrictionTest, friction_tests
from sonolube.reproduce.row import Row, compare

FITTED_ON: Final = "ACDEFG"
"""Sets on which the memory length and the like are fitted, as in the comparison this reproduces."""

REPORTED: Final = ("as-published", "stick-slip")
"""Variants whose predictions stand in the reproduction report point by point; its figures show all."""

_UNREACHED: Final = 1.0  # error of a test that a closure does not reach, for the fit alone
_RUNS: Final = 2  # of the starts, how many of the best are followed


@dataclass(frozen=True, kw_only=True, slots=True)
class Fit:
    """A closure with values for what it leaves free.

    Parameters
    ----------
    variant : ClosureVariant
    sets : str
        Letters of the sets it was fitted on; empty where nothing was fitted.
    values : tuple of float
        Of the variant's parameters, in SI.
    """

    variant: ClosureVariant
    sets: str
    values: tuple[float, ...]

    def predict(self, test: FrictionTest) -> float | None:
        """Return the friction ratio of a test, None where the model does not reach. []"""
        return self.variant.predict(test, *self.values)


@dataclass(frozen=True, kw_only=True, slots=True)
class Errors:
    """How far predictions are from measured ratios, all pure numbers.

    Parameters
    ----------
    rms, worst : float
        Over the tests that the model reaches, predicted less measured.
    median_relative : float
        Median of the absolute error over the measured ratio.
    count : int
        How many tests it reaches.
    missed : tuple of str
        Labels of those it does not reach.
    """

    rms: float
    worst: float
    median_relative: float
    count: int
    missed: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Information:
    """Akaike's and Schwarz's criteria for one unknown Gaussian error; they compare closures on the same tests only."""

    akaike: float
    schwarz: float


def measured_in(sets: str) -> tuple[FrictionTest, ...]:
    """Return the tests of some sets, by their letters."""
    return tuple(test for test in friction_tests() if test.set_name in sets)


@cache
def fitted(variant: ClosureVariant, sets: str) -> Fit:
    """Return the closure with its free parameters fitted to the measured ratios of some sets by least squares.

    Parameters
    ----------
    variant : ClosureVariant
    sets : str
        Letters of the sets.

    Returns
    -------
    Fit
        Parameters that none of the sets can tell stay at their first start.
    """
    tests = measured_in(sets)
    free = [
        place for place, one in enumerate(variant.parameters) if not one.matters_in or set(one.matters_in) & set(sets)
    ]
    values = np.array([parameter.start[0] for parameter in variant.parameters])
    if not free:
        return Fit(variant=variant, sets="", values=tuple(values.tolist()))
    chosen = [variant.parameters[place] for place in free]

    def errors(scaled: Floats) -> Floats:
        trial = values.copy()
        trial[free] = scaled * [abs(parameter.high) for parameter in chosen]
        predicted = (variant.predict(test, *trial) for test in tests)
        return np.array(
            [
                _UNREACHED if ratio is None else ratio - test.friction_ratio
                for ratio, test in zip(predicted, tests, strict=True)
            ]
        )

    scales = np.array([abs(parameter.high) for parameter in chosen])
    bounds = [parameter.low for parameter in chosen] / scales, [parameter.high for parameter in chosen] / scales
    starts = [np.array(start) / scales for start in product(*(parameter.start for parameter in chosen))]
    starts.sort(key=lambda start: _rms(errors(start)))
    runs = [least_squares(errors, start, bounds=bounds, diff_step=1e-4, xtol=1e-6) for start in starts[:_RUNS]]
    best = min(runs, key=lambda run: float(run.cost))
    values[free] = best.x * scales
    return Fit(variant=variant, sets=sets, values=tuple(values.tolist()))


def errors_of(fit: Fit, tests: Iterable[FrictionTest]) -> Errors:
    """Return how far a closure is off over some tests."""
    return _errors([(test, fit.predict(test)) for test in tests])


def errors_left_out(variant: ClosureVariant, sets: str) -> Errors:
    """Return how far a closure is off where each set is predicted by a fit to the others."""
    pairs: list[tuple[FrictionTest, float | None]] = []
    for left_out in sets:
        fit = fitted(variant, sets.replace(left_out, ""))
        pairs += [(test, fit.predict(test)) for test in measured_in(left_out)]
    return _errors(pairs)


def _errors(pairs: list[tuple[FrictionTest, float | None]]) -> Errors:
    reached = [(test, ratio) for test, ratio in pairs if ratio is not None]
    measured = np.array([test.friction_ratio for test, _ in reached])
    off = np.array([ratio for _, ratio in reached]) - measured
    return Errors(
        rms=_rms(off),
        worst=float(off[np.argmax(np.abs(off))]) if reached else float("inf"),
        median_relative=float(np.median(np.abs(off) / measured)) if reached else float("inf"),
        count=len(reached),
        missed=tuple(test.label for test, ratio in pairs if ratio is None),
    )


def _rms(off: ArrayLike) -> float:
    squares = np.square(off)
    return float(np.sqrt(np.mean(squares))) if squares.size else float("inf")


def information(fit: Fit, tests: tuple[FrictionTest, ...]) -> Information | None:
    """Return the criteria of a closure on some tests; None where it does not reach them all.

    References
    ----------
    .. [1] H. Akaike, IEEE Trans. Autom. Control 19, 716 (1974). doi:10.1109/TAC.1974.1100705
    .. [2] G. Schwarz, Ann. Stat. 6, 461 (1978). doi:10.1214/aos/1176344136
    """
    errors, n = errors_of(fit, tests), len(tests)
    if errors.missed:
        return None
    sets = {test.set_name for test in tests}
    told = [one for one in fit.variant.parameters if fit.sets and (not one.matters_in or set(one.matters_in) & sets)]
    free = len(told) + 1  # and the error itself
    surprise = 2 * n * np.log(errors.rms)
    return Information(akaike=float(surprise + 2 * free), schwarz=float(surprise + free * np.log(n)))


def fits() -> tuple[Fit, ...]:
    """Return every closure, fitted where it leaves something free: on sets A and C to G, in-plane motion on B too."""
    return tuple(fitted(variant, _sets_of(variant)) for variant in VARIANTS)


def _sets_of(variant: ClosureVariant) -> str:
    more = {letter for parameter in variant.parameters for letter in parameter.matters_in}
    return "".join(sorted(set(FITTED_ON) | more))


def rows() -> Iterator[Row]:
    """Yield one row for each published friction reduction, by the printed closure and by the default one."""
    for fit in fits():
        if fit.variant.name not in REPORTED:
            continue
        for test in friction_tests():
            ratio = fit.predict(test)
            if test.published is None or ratio is None:
                continue
            published = replace(test.published, id=f"closure-{fit.variant.name}-{test.label}")
            yield compare(published, 1 - ratio, _note(fit, test))


def _note(fit: Fit, test: FrictionTest) -> str:
    told = ", ".join(
        f"{parameter.name} {value:.3g} {parameter.unit}".rstrip()
        for parameter, value in zip(fit.variant.parameters, fit.values, strict=True)
        if not parameter.matters_in or test.set_name in parameter.matters_in
    )
    seen = f"; fitted on sets {', '.join(fit.sets)}: {told}" if fit.sets else "; nothing fitted"
    return f"{fit.variant.meaning[0].upper()}{fit.variant.meaning[1:]}{seen}."
