"""Sections 3.1 to 3.3: numbers that the cube must reproduce, and those it must not claim."""

import pytest
from pytest import approx

from dong2015 import Row, Verdict
from dong2015.chapter3.cube import cube_figures, cube_rows
from sonolube.facts.published import statement
from sonolube.figure import ReportFigure, publication_style

ROWS = {row.id: row for row in cube_rows()}


@pytest.mark.parametrize(
    "name",
    [
        "3.1.4-separation-elastic-plastic",
        "3.1.4-separation-elastic",
        "3.1.4-separation-difference",
        "3.1.4-separation-difference-steel",
        *[f"table-3.3-model-{row}" for row in (1, 2, 3)],
        *[f"table-3.4-model-{row}" for row in (1, 2, 3, 4, 5, 6)],
        "table-3.2-effective-modulus-1",
    ],
)
def test_the_printed_result_is_reproduced(name: str) -> None:
    assert ROWS[name].verdict is Verdict.REPRODUCED


def test_separations_are_those_recomputed_by_hand() -> None:
    assert ROWS["3.1.4-separation-elastic-plastic"].computed == approx(18.11, abs=0.005)
    assert ROWS["3.1.4-separation-elastic"].computed == approx(24.93, abs=0.005)
    assert ROWS["3.1.4-separation-difference-steel"].computed == approx(26.14 - 17.11, abs=0.01)


def test_the_wear_rate_of_table_3_3_with_vibration_is_a_misprint_of_table_3_4() -> None:
    for row in (4, 5, 6):
        assert ROWS[f"table-3.3-model-{row}"].verdict is Verdict.MISPRINT
        assert ROWS[f"table-3.3-model-{row}"].computed == approx(1.355e-2, rel=1e-3)


def test_the_results_of_the_printed_equations_are_noted() -> None:
    assert "0.02015" in ROWS["table-3.4-model-1"].note
    assert "1.31" in ROWS["table-3.4-model-4"].note


def test_the_area_grows_with_the_load_sixfold_and_not_sevenfold() -> None:
    row = ROWS["3.1.4-area-factor"]
    assert row.verdict is Verdict.MISPRINT
    assert row.computed == approx(6.0)


def test_the_coupling_factor_follows_from_the_table_itself() -> None:
    # 62 * 140e-12 m/V, 2e9 N/m, 360 nF: k^2 = 0.4186
    assert ROWS["table-3.5-coupling-factor-1"].computed == approx(0.4186**0.5, abs=1e-3)


def test_steel_on_steel_disagrees_at_the_stated_amplitude() -> None:
    row = ROWS["3.1.4-reduction-3"]
    assert row.verdict is Verdict.NOT_REPRODUCED
    assert "50.0 to 51.1 %" in row.note  # at the other amplitude that is printed for the same welder


def test_every_row_has_a_note_and_a_number_of_its_own() -> None:
    def complete(row: Row) -> bool:
        return bool(row.note) and row.published_low <= row.published <= row.published_high

    assert len(ROWS) == len(list(cube_rows()))
    assert [row.id for row in ROWS.values() if not complete(row) and statement_relation(row) != "<"] == []


def statement_relation(row: Row) -> str:
    return "" if row.id.startswith("table") else statement(row.id).relation


@pytest.mark.parametrize("figure", [*cube_figures()], ids=lambda figure: figure.name)
def test_every_axis_has_a_unit_or_a_ratio(figure: ReportFigure) -> None:
    import matplotlib.pyplot as plt

    with publication_style():
        drawn = figure.draw()
    labels = [label for axes in drawn.axes for label in (axes.get_xlabel(), axes.get_ylabel()) if label]
    plt.close(drawn)
    assert len(labels) >= 2
    assert all(any(word in label for word in ("[", "ratio", "over", "Number", "Waveform")) for label in labels)
