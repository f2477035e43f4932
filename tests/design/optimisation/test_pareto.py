"""Pareto fronts against the definition of dominance and a closed form."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx

from sonolube.design.optimisation import epsilon_bounds, epsilon_constraint_front, non_dominated


@given(st.lists(st.tuples(st.integers(0, 8), st.integers(0, 8)), min_size=1, max_size=30))
def test_a_point_is_kept_unless_another_dominates_it(rows: list[tuple[int, int]]) -> None:
    values = np.array(rows, dtype=float)
    kept = {rows[i] for i in np.flatnonzero(non_dominated(values))}
    best = {a for a in rows if not any(b != a and b[0] <= a[0] and b[1] <= a[1] for b in rows)}
    assert kept == best
    assert non_dominated(values).sum() == len(best)


def test_the_pareto_front_of_two_parabolas_has_its_closed_form() -> None:
    # least x^2 with (x - 2)^2 <= bound: x = 2 - sqrt(bound), so that sqrt(f1) + sqrt(f2) = 2
    def minimise_under(bound: float) -> tuple[np.ndarray, np.ndarray] | None:
        x = max(2 - np.sqrt(bound), 0.0)
        return np.array([x]), np.array([x**2, (x - 2) ** 2])

    samples = np.linspace(0.2, 1.9, 50)
    bounds = epsilon_bounds(np.stack([samples**2, (samples - 2) ** 2], axis=1), 7)
    front = epsilon_constraint_front(minimise_under, bounds)
    assert len(front) == 7
    found = np.array([objectives for _, objectives in front])
    assert np.sqrt(found).sum(axis=1) == approx(np.full(7, 2.0))
    assert np.all(np.diff(found[:, 0]) > 0)
    assert epsilon_constraint_front(lambda bound: None, bounds) == []
