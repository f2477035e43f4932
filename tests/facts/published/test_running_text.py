"""Quoted numbers: unique ids, quantities of the vocabulary, and chapters."""

from pytest import raises

from sonolube.errors import UnknownName
from sonolube.facts.published import statement, statements
from sonolube.vocabulary import quantity


def test_every_statement_has_a_name_of_its_own_and_a_quantity_of_the_vocabulary() -> None:
    names = [entry.id for entry in statements()]
    assert len(names) == len(set(names))
    for entry in statements():
        assert entry.id.startswith(f"{entry.section}-")
        assert entry.relation in ("=", "about", "up to", "<", ">")
        assert entry.meaning
        if entry.quantity:
            assert quantity(entry.quantity)


def test_the_chapters_hold_their_own_statements() -> None:
    for chapter in range(1, 6):
        assert {entry.section[0] for entry in statements(chapter)} == {str(chapter)}
    assert statement("2.5.2-friction-titanium-off").number.text == "1.33±0.1"


def test_an_unknown_id_or_chapter_is_refused_with_a_known_one() -> None:
    with raises(UnknownName, match=r"did you mean 2\.5\.2-friction-titanium-off"):
        statement("2.5.2-friction-titanum-off")
    with raises(UnknownName, match="unknown part of D 'chapter6'"):
        statements(6)
