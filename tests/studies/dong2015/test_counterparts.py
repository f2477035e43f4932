"""Every figure of the dissertation has counterparts in the report or a reason why there is none."""

from tests.reproduced import reproduced

from dong2015.counterparts import figures_of_d
from sonolube.facts.published import figures


def test_every_figure_has_counterparts_or_one_reason() -> None:
    found = figures_of_d()
    assert [each.number for each in found] == [each.number for each in figures()]
    assert [each.number for each in found if bool(each.counterparts) == bool(each.why_none)] == []


def test_every_counterpart_is_a_figure_of_the_report_and_every_one_named_by_a_number_is_listed() -> None:
    names = {figure.name for figure in reproduced().figures}
    listed = {name for each in figures_of_d() for name in each.counterparts}
    assert listed <= names
    assert {name for name in names if name.startswith("figure")} <= listed
