"""The earlier studies of D 1.3: every statement has its study, and nothing stands there that D does not print."""

from sonolube.facts.published import previous_studies, statements


def test_every_number_of_the_review_belongs_to_one_study() -> None:
    reviewed = {entry.id for entry in statements(1) if entry.section in ("1.3.1", "1.3.2")}
    placed = [entry.id for study in previous_studies() for entry in study.numbers]
    assert sorted(placed) == sorted(reviewed)


def test_a_study_agrees_with_its_statements() -> None:
    for study in previous_studies():
        for entry in study.numbers:
            assert (entry.study, entry.section) == (study.study, study.section)
            assert entry.direction == study.direction


def test_each_study_has_a_name_of_its_own_and_a_reference() -> None:
    studies = previous_studies()
    assert len({study.id for study in studies}) == len(studies)
    # D 1.3.1 and 1.3.2 cite 3 and 34 to 50
    assert {number for study in studies for number in study.references} == {3, *range(34, 51)}


def test_what_is_not_printed_is_missing() -> None:
    by_id = {study.id: study for study in previous_studies()}
    gutowski = by_id["gutowski"].number("nominal_pressure")
    assert gutowski is not None
    assert gutowski.value == 31e3
    assert by_id["littmann"].number("nominal_pressure") is None
