"""Tables of runs as laboratories write them: at least three of every kind, each with its right value."""

from collections import Counter

from tests.measurement.laboratory_tables import LABORATORY_TABLES

from sonolube.vocabulary import quantities


def test_each_kind_has_at_least_three_tables() -> None:
    kinds = Counter(table.kind for table in LABORATORY_TABLES.values())
    assert min(kinds.values()) >= 3
    assert len(LABORATORY_TABLES) >= 60


def test_right_values_are_of_four_runs_and_of_known_quantities() -> None:
    for table in LABORATORY_TABLES.values():
        assert {len(values) for values in table.right.values()} == {4}
        assert set(table.right) <= {*quantities(), "friction_coefficient_uncertainty"}
