"""Fitting a closure to measured friction ratios, how far off it is, and how well its parameters are known."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, least_squares

from sonolube.checks import Floats
from sonolube.validation.closures import ClosureVariant
from sonolube.validation.earlier_tests import earlier_tests
from sonolube.validation.friction_tests import Circumstances, FrictionTest, Measured, friction_tests
from sonolube.validation.parameters import Parameter

_UNREACHED: Final = 1.0  # error of a test that a closure does not reach, for the fit alone
_LEVEL: Final = 3.841  # 95 % of chi squared with one degree of freedom


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

    def predict(self, test: Circumstances) -> float | None:
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
    """Criteria for one unknown Gaussian error; they compare closures on the same tests only.

    Parameters
    ----------
    akaike : float
        Akaike's, corrected for few tests.
    schwarz : float
        Schwarz's.
    free : int
        Fitted parameters, the error itself not counted.
    """

    akaike: float
    schwarz: float
    free: int


def measured_in(sets: str) -> tuple[FrictionTest, ...]:
    """Return the tests of some sets, by their letters."""
    return tuple(test for test in friction_tests() if test.set_name in sets)


@cache
def fitted(
    variant: ClosureVariant,
    sets: str,
    *,
    near: tuple[float, ...] | None = None,
    among: tuple[Measured, ...] | None = None,
) -> Fit:
    """Return the closure with its free parameters fitted to the measured ratios of some sets by least squares.

    Parameters
    ----------
    variant : ClosureVariant
    sets : str
        Letters of the sets.
    near : tuple of float, optional
        Values from which to set out, SI; the best of each parameter's starts where absent.
    among : tuple of Measured, optional
        Tests from which the sets are taken; the dissertation's where absent.

    Returns
    -------
    Fit
        Parameters that none of the sets can tell stay at rest.
    """
    tests = taken(sets, among)
    free = [place for place, one in enumerate(variant.parameters) if one.matters_to(sets)]
    if near is None:
        start = _first_guess(variant, tests)
    else:
        start = np.array([parameter.rest for parameter in variant.parameters])
        start[free] = np.array(near)[free]
    values = _least(variant, tests, free, start)
    return Fit(variant=variant, sets=sets if free else "", values=tuple(values.tolist()))


def errors_of(fit: Fit, tests: Iterable[Measured]) -> Errors:
    """Return how far a closure is off over some tests."""
    return errors_between((test, fit.predict(test)) for test in tests)


def left_out(variant: ClosureVariant, sets: str, *, among: tuple[Measured, ...] | None = None) -> tuple[Fit, ...]:
    """Return a fit for each set, in order, to all the others; it sets out from the fit to all."""
    all_of_them = fitted(variant, sets, among=among).values
    return tuple(fitted(variant, sets.replace(one, ""), near=all_of_them, among=among) for one in sets)


def errors_left_out(variant: ClosureVariant, sets: str, *, among: tuple[Measured, ...] | None = None) -> Errors:
    """Return how far a closure is off where each set is predicted by a fit to the others."""
    pairs: list[tuple[Measured, float | None]] = []
    for one, fit in zip(sets, left_out(variant, sets, among=among), strict=True):
        pairs += [(test, fit.predict(test)) for test in taken(one, among)]
    return errors_between(pairs)


def information(fit: Fit, tests: tuple[Measured, ...]) -> Information | None:
    """Return the criteria of a closure on some tests; None where it does not reach them all.

    References
    ----------
    .. [1] C. M. Hurvich and C.-L. Tsai, Biometrika 76, 297 (1989). doi:10.1093/biomet/76.2.297
    .. [2] G. Schwarz, Ann. Stat. 6, 461 (1978). doi:10.1214/aos/1176344136
    """
    errors = errors_of(fit, tests)
    if errors.missed:
        return None
    sets = "".join(test.set_name for test in tests)
    free = sum(one.matters_to(sets) for one in fit.variant.parameters) if fit.sets else 0
    return criteria(errors.rms, count=len(tests), free=free)


def criteria(rms: float, *, count: int, free: int) -> Information:
    """Return the criteria for an error over some tests with some parameters fitted to them."""
    surprise = 2 * count * np.log(rms)
    k = free + 1  # and the error itself
    return Information(
        akaike=float(surprise + 2 * k + 2 * k * (k + 1) / (count - k - 1)) if count > k + 1 else float("inf"),
        schwarz=float(surprise + k * np.log(count)),
        free=free,
    )


def profile_interval(fit: Fit, place: int, *, among: tuple[Measured, ...] | None = None) -> tuple[float, float]:
    """Return the 95 % interval of one parameter, the others fitted anew at each value; cut at its bounds.

    References
    ----------
    .. [1] D. J. Venzon and S. H. Moolgavkar, Appl. Stat. 37, 87 (1988). doi:10.2307/2347496
    """
    parameter, best, tests = fit.variant.parameters[place], fit.values[place], taken(fit.sets, among)
    others = [other for other, one in enumerate(fit.variant.parameters) if other != place and one.matters_to(fit.sets)]
    least = _rms(_missed(fit.variant, tests, fit.values))

    def beyond(value: float) -> float:
        values = np.array(fit.values)
        values[place] = value
        values = _least(fit.variant, tests, others, values)
        return 2 * len(tests) * float(np.log(_rms(_missed(fit.variant, tests, values)) / least)) - _LEVEL

    step = np.pi if parameter.is_angle else np.inf
    ends = max(parameter.low, best - step), min(parameter.high, best + step)
    low, high = (end if beyond(end) < 0 else brentq(beyond, best, end, rtol=1e-3) for end in ends)
    return float(low), float(high)


def taken(sets: str, among: tuple[Measured, ...] | None) -> tuple[Measured, ...]:
    """Return those of some tests that belong to some sets; of all published ones unless told among which."""
    everything: tuple[Measured, ...] = (*friction_tests(), *earlier_tests()) if among is None else among
    return tuple(test for test in everything if test.set_name in sets)


def _first_guess(variant: ClosureVariant, tests: tuple[Measured, ...]) -> Floats:
    """Return the best start of each group of parameters that the same sets tell, the shared ones first."""
    values = np.array([parameter.rest for parameter in variant.parameters])
    groups = sorted({parameter.matters_in for parameter in variant.parameters})
    for group in groups:
        told_by = tuple(test for test in tests if not group or test.set_name in group)
        if not told_by:
            continue
        places = [place for place, one in enumerate(variant.parameters) if one.matters_in == group]
        trials = []
        for start in product(*(variant.parameters[place].start for place in places)):
            trial = values.copy()
            trial[places] = start
            trials.append((_rms(_missed(variant, told_by, trial)), start))
        values[places] = min(trials)[1]
    return values


def _least(variant: ClosureVariant, tests: tuple[Measured, ...], free: list[int], start: Floats) -> Floats:
    """Return the start with some places fitted."""
    if not free:
        return start
    chosen = [variant.parameters[place] for place in free]
    scales = np.array([abs(parameter.high) for parameter in chosen])

    def missed(scaled: Floats) -> Floats:
        return _missed(variant, tests, _with(start, free, scaled * scales))

    low, high = (np.array([getattr(parameter, end) for parameter in chosen]) / scales for end in ("low", "high"))
    run = least_squares(
        missed,
        np.clip(start[free] / scales, low, high),
        bounds=(low, high),
        method="dogbox",
        diff_step=1e-3,
        xtol=1e-4,
        ftol=1e-5,
        max_nfev=30,
    )
    return _with(start, free, np.array([_in_turn(*pair) for pair in zip(chosen, run.x * scales, strict=True)]))


def _in_turn(parameter: Parameter, value: float) -> float:
    """Return a value, an angle between minus and plus half a turn."""
    return float((value + np.pi) % (2 * np.pi) - np.pi) if parameter.is_angle else float(value)


def _with(values: Floats, places: list[int], replaced: Floats) -> Floats:
    changed = values.copy()
    changed[places] = replaced
    return changed


def _missed(variant: ClosureVariant, tests: tuple[Measured, ...], values: ArrayLike) -> Floats:
    """Return predicted less measured for every test."""
    predicted = (variant.predict(test, *np.asarray(values).tolist()) for test in tests)
    return np.array(
        [
            _UNREACHED if ratio is None else ratio - test.friction_ratio
            for ratio, test in zip(predicted, tests, strict=True)
        ]
    )


def errors_between(predicted: Iterable[tuple[Measured, float | None]]) -> Errors:
    """Return how far predicted ratios are off; None for a test that is not reached."""
    pairs = list(predicted)
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
