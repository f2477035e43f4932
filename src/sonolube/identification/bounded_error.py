"""Bounded-error (set-membership) identification of parameters from facts that may contradict each other."""

from collections.abc import Sequence
from types import MappingProxyType

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.identification.bounded_search import (
    BoundedModel,
    find_feasible_point,
    find_feasible_point_near,
    least_squares_point,
    residual_jacobian,
)
from sonolube.identification.fact import Bounds, Fact, ForwardModel
from sonolube.identification.feasibility import consistent_facts
from sonolube.identification.result import ConsistentFit, Identification, ParameterEstimate, SingularDirection

_STARTS = 10  # of the least-squares fit to the most reliable consistent subset
_BISECTIONS = 14  # between the estimate and a bound, for one end of a feasible interval


def identify(model: ForwardModel, *, facts: Sequence[Fact], bounds: Bounds, seed: int = 0) -> Identification:
    r"""Parameters, their feasible intervals, and the consistency of facts, by bounded-error estimation.

    Parameters
    ----------
    model : callable
        Forward model: observables of n systems, by name, from arrays of shape (n,) of their parameters, by name.
    facts : sequence of Fact
        At most 16, each of an observable of the model; the more reliable first among equals of rank.
    bounds : mapping of str to pair of float
        Lower and upper bound of each free parameter in SI, both positive.
    seed : int
        Seed of the searches; the same seed gives the same result.

    Returns
    -------
    Identification

    Raises
    ------
    InvalidInput
        If there are no facts or more than 16, two of one name, a fact that no parameters within the bounds satisfy, or
        bounds that are not positive and rising.
    UnknownName
        If a fact names no observable of the model.

    See Also
    --------
    posterior : Joint samples of the parameters from the facts that hold.

    Notes
    -----
    A compromise between contradicting facts would satisfy none of them. So all maximal consistent subsets S of the
    facts, those for which the feasible set

    .. math:: \Theta_S = \{p : |r_i(p)| \le 1 \text{ for all } i \in S\}

    with the normalised residuals :math:`r_i` is not empty, are found first. The subset with the most facts of rank 1,
    then of rank 2 and so on, is taken, and the parameters are the least-squares fit to it alone; what no fact
    determines stays at the middle of its bounds on a logarithmic scale. The feasible interval of a parameter is the
    projection of :math:`\Theta_S`, bisected from the estimate outwards on the assumption that it has no gap. Limits
    that are satisfied with a margin do not enter the singular directions.

    References
    ----------
    .. [1] M. Milanese and A. Vicino, Automatica 27, 997 (1991). doi:10.1016/0005-1098(91)90134-N
    """
    _require_distinct_names(facts)
    bounded = BoundedModel(model=model, bounds=bounds)
    bounded.residuals(facts, bounded.lower[np.newaxis])  # refuses an unknown observable before the long search
    subsets, points = consistent_facts(bounded, facts, seed=seed)
    first, *others = sorted(points, key=lambda names: _reliability(names, facts), reverse=True)
    satisfied = [fact for fact in facts if fact.name in first]
    starts = [find_feasible_point(bounded, satisfied, seed=seed + i) for i in range(_STARTS)]
    fits = [
        _consistent_fit(bounded, facts, first, (*points[first], *(start for start in starts if start is not None))),
        *(_consistent_fit(bounded, facts, names, points[names]) for names in others),
    ]
    point = np.log(list(fits[0].parameters.values()))
    observed = bounded.observables(point[np.newaxis])
    return Identification(
        facts=tuple(facts),
        observed=MappingProxyType({fact.name: float(observed[fact.name][0]) for fact in facts}),
        estimates=MappingProxyType(
            {name: _estimate(bounded, satisfied, point, index) for index, name in enumerate(bounded.bounds)}
        ),
        directions=_singular_directions(bounded, satisfied, point),
        consistent_fits=tuple(fits),
        conflicts=subsets.conflicts,
    )


def _require_distinct_names(facts: Sequence[Fact]) -> None:
    """Refuse no facts at all, and two facts of one name."""
    if not facts:
        raise InvalidInput("facts must not be empty")
    names = [fact.name for fact in facts]
    for name in names:
        if names.count(name) > 1:
            raise InvalidInput(f"facts must differ in name, got {name} twice")


def _consistent_fit(
    bounded: BoundedModel, facts: Sequence[Fact], names: frozenset[str], starts: Sequence[Floats]
) -> ConsistentFit:
    """Least-squares fit to the facts of these names, with the residuals of all."""
    point = least_squares_point(bounded, [fact for fact in facts if fact.name in names], starts=starts)
    residuals = bounded.residuals(facts, point[np.newaxis])[0]
    return ConsistentFit(
        satisfied=names,
        parameters=MappingProxyType(dict(zip(bounded.bounds, np.exp(point).tolist(), strict=True))),
        residuals=MappingProxyType(dict(zip((fact.name for fact in facts), residuals.tolist(), strict=True))),
    )


def _reliability(names: frozenset[str], facts: Sequence[Fact]) -> tuple[list[int], list[bool]]:
    """Sorting key of a subset: number of its facts of each rank, the best first, then which facts, in their order."""
    ranks = sorted({fact.rank for fact in facts})
    counts = [sum(fact.name in names for fact in facts if fact.rank == rank) for rank in ranks]
    return counts, [fact.name in names for fact in facts]


def _estimate(bounded: BoundedModel, facts: Sequence[Fact], point: Floats, index: int) -> ParameterEstimate:
    """Estimate and feasible interval of the parameter of an index."""
    lower, lower_is_bound = _interval_end(bounded, facts, point, index, float(bounded.lower[index]))
    upper, upper_is_bound = _interval_end(bounded, facts, point, index, float(bounded.upper[index]))
    return ParameterEstimate(
        value=float(np.exp(point[index])),
        lower=float(np.exp(lower)),
        upper=float(np.exp(upper)),
        lower_is_bound=lower_is_bound,
        upper_is_bound=upper_is_bound,
    )


def _interval_end(
    bounded: BoundedModel, facts: Sequence[Fact], point: Floats, index: int, bound: float
) -> tuple[float, bool]:
    """End of a feasible interval towards a bound by bisection, and whether it is the bound; others are adapted."""
    near, far = float(point[index]), bound
    start = point
    for bisection in range(_BISECTIONS + 1):
        trial = far if bisection == 0 else (near + far) / 2
        found = find_feasible_point_near(bounded, facts, start=start, fixed={index: trial})
        if found is None:
            far = trial
        elif bisection == 0:
            return bound, True
        else:
            near, start = trial, found
    return near, False


def _singular_directions(bounded: BoundedModel, facts: Sequence[Fact], point: Floats) -> tuple[SingularDirection, ...]:
    """Right singular vectors of the Jacobian of the residuals, the smallest singular value first."""
    jacobian = residual_jacobian(bounded, facts, point)
    padding = np.zeros((len(point), len(point)))  # as many singular values as parameters
    _, singular, rows = np.linalg.svd(np.vstack([jacobian, padding]))
    largest = np.take_along_axis(rows, np.abs(rows).argmax(axis=1)[:, np.newaxis], axis=1)
    return tuple(
        SingularDirection(
            exponents=MappingProxyType(dict(zip(bounded.bounds, row.tolist(), strict=True))), sensitivity=float(value)
        )
        for value, row in zip(singular[::-1], (rows * np.sign(largest))[::-1], strict=True)
    )
