"""Rows and figures of the variants of the friction models."""

import numpy as np
import pytest
from pytest import approx

from dong2015 import RowKind, Verdict
from dong2015.friction_models.computed_motion import tribometer_test_rows, within_scatter
from dong2015.friction_models.variants import DEFAULT, REPORTED, variant_figures
from dong2015.row import comparison_row
from sonolube.figure import ReportFigure, publication_style
from sonolube.validation.published_tests import friction_tests


def test_each_test_has_one_row_with_every_reported_variant_beside_the_default() -> None:
    rows = {row.id: row for row in tribometer_test_rows()}
    others = set(REPORTED) - {DEFAULT}
    reductions = [test for test in friction_tests() if test.published and test.set_name != "B"]
    assert list(rows) == [f"friction-model-asperity-stick-slip-fitted-{test.label}" for test in reductions]
    for row in rows.values():  # the gap of the welder closes over the full period of one model
        missing = others - row.alternatives.keys()
        assert missing == ({"dong-2015-full-period"} if "-G-" in row.id else set())
    row = rows["friction-model-asperity-stick-slip-fitted-A-1"]
    assert (row.source, row.unit, row.published) == ("Table 2.5", "%", 62.22)
    assert row.note.startswith("Asperity stick-slip, memory length fitted; fitted on sets A, C, D, E, F, G: ")
    assert "measured 0.370." in row.note
    assert {
        label: rows[f"friction-model-asperity-stick-slip-fitted-{label}"].verdict for label in ("A-1", "A-2", "H-1")
    } == {
        "A-1": Verdict.FITTED,
        "A-2": Verdict.NOT_REPRODUCED,
        "H-1": Verdict.UNDETERMINED,  # its gain at resonance is not printed
    }


def test_a_reduction_within_the_scatter_of_its_forces_is_no_disagreement() -> None:
    # Table 2.3: 0.379+-0.041 N of 1.024+-0.063 N are 63.0+-4.6 %, printed as 62.22 %
    test = friction_tests("A")[0]
    scatter = 100 * 0.379 / 1.024 * np.hypot(0.041 / 0.379, 0.063 / 1.024)
    published = within_scatter(test)
    assert 100 * published.number.low == approx(62.99 - scatter, abs=0.01)
    for reduction, verdict in (
        (62.99 + 0.99 * scatter, Verdict.REPRODUCED),
        (62.99 + 1.01 * scatter, Verdict.NOT_REPRODUCED),
    ):
        assert comparison_row(published, reduction / 100, "", kind=RowKind.DEFAULT_MODEL).verdict is verdict


def test_a_printed_scatter_wider_than_that_of_the_forces_is_kept() -> None:
    for test in friction_tests("AB"):
        assert test.published is not None
        printed, wide = test.published.number, within_scatter(test).number
        assert wide.low <= printed.low < printed.high <= wide.high
        assert wide.value == printed.value


@pytest.mark.parametrize("figure", [*variant_figures()], ids=lambda figure: str(figure.name))
def test_figures_are_drawn_with_units(figure: ReportFigure) -> None:
    from matplotlib import pyplot as plt

    with publication_style():
        drawn = figure.draw()
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in drawn.axes]
    assert any("[" in label for label in labels)
    plt.close(drawn)
