"""Replicates of a comparison of friction with and without vibration: power of the t-test."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.design.test_plan.scatter import Scatter
from sonolube.errors import InvalidInput

MAX_REPLICATES: Final = 1000
"""Number of replicates beyond which no plan is made."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Comparison:
    """Way to compare friction with and without vibration.

    Parameters
    ----------
    name : str
        As typed.
    title : str
        Name of the test.
    degrees_of_freedom : callable
        Of the number of replicates.
    deviation : callable
        Standard deviation of one difference, relative to the friction without vibration, of a `Scatter`.
    specimens : int
        Pairs of bodies for one replicate.
    """

    name: str
    title: str
    degrees_of_freedom: Callable[[ArrayLike], Floats]
    deviation: Callable[[Scatter], float]
    specimens: int

    def power(
        self, *, difference: ArrayLike, deviation: ArrayLike, replicates: ArrayLike, significance: float
    ) -> Floats:
        r"""Probability that the two-sided t-test finds a difference.

        With n replicates the statistic has Student's noncentral distribution with the noncentrality
        :math:`\sqrt n\, \Delta/s` and n - 1 degrees of freedom where a run has both states (paired), 2 n - 2 where the
        states have runs of their own: there :math:`s^2 = s_0^2 + s_1^2`, and the scatters are taken as equal.

        Source: J. Cohen, Statistical Power Analysis for the Behavioral Sciences, 2nd ed., Erlbaum 1988, chapter 2.
        """
        from scipy.stats import nct, t

        free = self.degrees_of_freedom(replicates)
        noncentrality = np.sqrt(replicates) * np.asarray(difference) / np.asarray(deviation)
        critical = t.isf(significance / 2, free)
        # far from zero the lower tail underflows, and scipy may give NaN for it
        lower = np.nan_to_num(nct.cdf(-critical, free, noncentrality))
        return np.asarray(nct.sf(critical, free, noncentrality) + lower)

    def replicates(self, *, difference: float, deviation: float, power: float, significance: float) -> int:
        """Least number of replicates with which a difference is found with a probability."""
        require_positive(difference=difference, deviation=deviation)
        for name, value in (("power", power), ("significance", significance)):
            if not 0 < value < 1:
                raise InvalidInput(f"{name} must lie between 0 and 1, got {value:g}; usual are 0.8 and 0.05")
        if power <= significance:
            raise InvalidInput(f"power {power:g} must be above the significance {significance:g}")
        counts = np.arange(2, MAX_REPLICATES + 1)
        found = self.power(difference=difference, deviation=deviation, replicates=counts, significance=significance)
        if found[-1] < power:
            raise InvalidInput(
                f"a difference of {difference:g} under a scatter of {deviation:.2g} needs more than {MAX_REPLICATES}"
                f" replicates for a power of {power:g}; show a larger difference or reduce the scatter"
            )
        return int(counts[np.argmax(found >= power)])


COMPARISONS: Final[Mapping[str, Comparison]] = MappingProxyType(
    {
        each.name: each
        for each in (
            Comparison(
                name="paired",
                title="paired t-test, each run without, with and again without vibration",
                degrees_of_freedom=lambda replicates: np.asarray(replicates) - 1.0,
                deviation=lambda scatter: scatter.reduction,
                specimens=1,
            ),
            Comparison(
                name="separate",
                title="two-sample t-test, runs with and without vibration on specimens of their own",
                degrees_of_freedom=lambda replicates: 2.0 * np.asarray(replicates) - 2.0,
                deviation=lambda scatter: float(np.hypot(scatter.intrinsic, scatter.vibrated)),
                specimens=2,
            ),
        )
    }
)
"""Comparisons by name."""
