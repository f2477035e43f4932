"""What sets the decay length: runs made by another program are judged as what they are, or not at all."""

import numpy as np
import pytest
from pytest import raises
from tests.same import same

from reliability import decay_length_recordings as made
from sonolube.charts import Points, draw_chart
from sonolube.errors import InvalidInput
from sonolube.identification import (
    DecayLengthDecision,
    SwitchConditions,
    SwitchTable,
    decide_decay_length,
    decision_chart,
    decision_dataset,
)

CONDITIONS = SwitchConditions(natural_frequency=made.FREE_FREQUENCY)


def run(kind: str, seed: int) -> tuple[made.Truth, SwitchTable]:
    rng = np.random.default_rng([4, seed])
    truth = made.truth(rng, kind)
    return truth, SwitchTable(title="generated", caveats=(), **made.noisy_table(rng, truth))


@pytest.fixture(scope="module")
def sliding() -> tuple[made.Truth, SwitchTable, DecayLengthDecision]:
    truth, table = run("long_sliding", 0)
    return truth, table, decide_decay_length(table, CONDITIONS)


def test_a_growing_decay_length_is_told_with_its_growth(
    sliding: tuple[made.Truth, SwitchTable, DecayLengthDecision],
) -> None:
    truth, _, found = sliding
    assert found.decided
    assert found.leading == "long_sliding"
    assert found.verdict.startswith("long sliding (")
    true = truth.decay_length[-1] / truth.decay_length[0]
    assert 0.8 * found.growth.lower < true < 1.25 * found.growth.upper  # the ends wander by 3 % each
    assert found.fall.lower < 1.05 < 1.1 * found.fall.upper
    assert sum(found.probabilities.values()) == pytest.approx(1)


@pytest.mark.parametrize("kind", ["none", "friction_alone"])
def test_a_run_without_one_cause_is_not_given_one(kind: str) -> None:
    found = decide_decay_length(run(kind, 1)[1], CONDITIONS)
    assert (found.leading if found.decided else "undecided") in ("none" if kind == "none" else "undecided", "undecided")
    assert found.decided == (kind == "none")
    if not found.decided:
        assert found.verdict.startswith("not decided: ")
        assert found.advice


def test_the_figure_has_a_panel_for_each_reading_and_the_dataset_its_courses(
    sliding: tuple[made.Truth, SwitchTable, DecayLengthDecision],
) -> None:
    truth, table, found = sliding
    chart = decision_chart(table, found)
    assert [panel.y.unit for panel in chart.panels] == ["", "N", "A", "Hz", "Hz"]
    raw, read, *courses = chart.panels[0].parts
    assert isinstance(raw, Points)
    assert raw.y == pytest.approx(table.friction_force / table.intrinsic_friction_force)
    assert isinstance(read, Points)
    assert read.sources[0] == "generated, switch 1"
    assert len(courses) == len(found.courses)
    draw_chart(chart)
    data = decision_dataset(table, found)
    fitted = data["friction_ratio_by_long_sliding"].to_numpy()
    assert np.sqrt(np.mean((fitted - truth.ratio) ** 2)) < 0.03
    same(float(data["probability"].sel(hypothesis="long_sliding")), found.probabilities["long_sliding"])


def test_a_reading_without_unit_of_length_needs_no_modal_mass_but_positive_settings() -> None:
    with raises(InvalidInput, match=r"modal_mass must be positive, got -1\.0 kg"):
        SwitchConditions(modal_mass=-1.0)
