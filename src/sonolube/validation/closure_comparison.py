"""Closures against experiment: every measured friction ratio predicted, without a fit and with one, and how far off.

No fit sees a test it is judged by where it says so: each set in turn is predicted by a fit to the others. Sets A and C
to G, and then B with them, are fitted: what gives B, Table 4.2, has to be paid for by what it does to the others.
"""

from dataclasses import dataclass
from typing import Final

from sonolube.validation.closures import VARIANTS, ClosureVariant
from sonolube.validation.fit import (
    Errors,
    Fit,
    Information,
    errors_left_out,
    errors_of,
    fitted,
    information,
    taken,
)
from sonolube.validation.friction_tests import Measured
from sonolube.validation.parameters import RIGS

FITTED_ON: Final = "ACDEFG"
"""Sets on which closures are fitted that leave the rig of Table 4.2 as it is."""

ALL_FITTED: Final = "ABCDEFG"
"""These sets and Table 4.2; of set H the amplitude is not known."""

DEFAULT: Final = "stick-slip"
"""The default closure: of those with the right limits and no motion that nobody measured, the one that errs least."""

REPORTED: Final = ("as-published", DEFAULT, "stick-slip-in-plane", "coupled-per-rig")
"""Variants whose predictions stand in the reproduction report point by point; its figures show all."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Judgement:
    """One closure judged on some sets.

    Parameters
    ----------
    fit : Fit
        To all of them.
    seen : Errors
        Of that fit.
    unseen : Errors
        With each set predicted by a fit to the others.
    information : Information or None
        Of the fit; None where the closure does not reach every test.
    """

    fit: Fit
    seen: Errors
    unseen: Errors
    information: Information | None


def judged(variant: ClosureVariant, sets: str, *, among: tuple[Measured, ...] | None = None) -> Judgement:
    """Return a closure judged on some sets, by their letters; of the dissertation's tests unless told among which."""
    fit, tests = fitted(variant, sets, among=among), taken(sets, among)
    return Judgement(
        fit=fit,
        seen=errors_of(fit, tests),
        unseen=errors_left_out(variant, sets, among=among),
        information=information(fit, tests),
    )


def fits() -> tuple[Fit, ...]:
    """Return every closure, fitted on sets A and C to G, and with what only Table 4.2 tells on B too."""
    return tuple(fitted(variant, sets_of(variant)) for variant in VARIANTS)


def sets_of(variant: ClosureVariant) -> str:
    """Return the sets on which a closure is fitted for the report."""
    own = any(parameter.matters_in == RIGS["power map"] for parameter in variant.parameters)
    return ALL_FITTED if own else FITTED_ON
