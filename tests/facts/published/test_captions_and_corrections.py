"""Figure captions name known statements; errata and corrections are complete and refer to each other."""

from pytest import raises

from sonolube.errors import UnknownName
from sonolube.facts.published import errata, erratum, figure, figures, statement, statements, table, table_ids


def test_figures_carry_no_data_and_name_known_statements() -> None:
    counts = {"1": 5, "2": 45, "3": 18, "4": 57, "B": 6, "C": 4}
    assert [entry.number for entry in figures()] == [
        f"{part}.{k}" for part, n in counts.items() for k in range(1, n + 1)
    ]
    assert all(entry.no_data and entry.content for entry in figures())
    for entry in figures():
        for name in entry.statements:
            statement(name)


def test_the_errata_are_numbered_without_a_gap() -> None:
    names = [entry.id for entry in errata()]
    extra = len(names) - 36
    assert extra > 0
    assert names == [f"E{k}" for k in range(1, 37)] + [f"N{k}" for k in range(1, extra + 1)]
    assert all(entry.location and entry.printed and entry.corrected and entry.evidence for entry in errata())


def test_every_correction_belongs_to_an_erratum() -> None:
    for correction in (correction for number in table_ids() for correction in table(number).corrections):
        assert erratum(correction.erratum)
    for entry in statements():
        assert bool(entry.erratum) == bool(entry.evidence) == bool(entry.corrected)
        assert not entry.erratum or erratum(entry.erratum)


def test_an_unknown_figure_or_erratum_is_refused() -> None:
    with raises(UnknownName, match=r"unknown figure '5\.1'"):
        figure("5.1")
    with raises(UnknownName, match="unknown erratum 'E37'"):
        erratum("E37")
