"""Rows and figures of the variants of the friction models."""

import pytest

from sonolube.figure import ReportFigure, publication_style
from sonolube.reproduce.friction_models.variant_figures import variant_figures
from sonolube.reproduce.friction_models.variant_rows import REPORTED, variant_rows
from sonolube.validation.published_tests import friction_tests


def test_each_reported_variant_has_a_row_for_every_reduction_in_its_range() -> None:
    rows = {row.id: row for row in variant_rows()}
    reductions = [test for test in friction_tests() if test.published]
    assert len(rows) == len(REPORTED) * len(reductions) - 3  # the gap closes over the full period: welder, B-5
    row = rows["friction-model-asperity-stick-slip-fitted-A-1"]
    assert (row.source, row.unit, row.published) == ("Table 2.5", "%", 62.22)
    assert row.note.startswith(
        "Asperity stick-slip, memory length fitted; fitted on sets A, C, D, E, F, G: memory_length 1.6"
    )
    assert row.note.endswith("measured 0.370.")


@pytest.mark.parametrize("figure", [*variant_figures()], ids=lambda figure: str(figure.name))
def test_figures_are_drawn_with_units(figure: ReportFigure) -> None:
    from matplotlib import pyplot as plt

    with publication_style():
        drawn = figure.draw()
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in drawn.axes]
    assert any("[" in label for label in labels)
    plt.close(drawn)
