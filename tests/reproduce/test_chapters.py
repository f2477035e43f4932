"""Reproduction of one chapter: its own rows and figures only."""

from sonolube.reproduce import reproduction


def test_the_reproduction_of_a_chapter_has_its_rows_and_figures_only() -> None:
    result = reproduction(chapter=2)
    assert {row.chapter for row in result.rows} == {2}
    assert {figure.chapter for figure in result.figures} == {2}
    # section 2.2, and the friction tests of Table 2.5 but not those of Table 4.2
    identifiers = {row.id for row in result.rows}
    assert {"2.2.5-speed-of-no-reduction", "friction-model-asperity-stick-slip-fitted-A-1"} <= identifiers
    assert "friction-model-asperity-stick-slip-fitted-B-1" not in identifiers
