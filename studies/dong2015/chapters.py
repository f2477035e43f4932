"""Reproduced sections, and the reproduction of a chapter or of the whole dissertation."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass
from functools import cache, partial
from typing import Final

from dong2015.chapter2.flextensional import flextensional_figures, flextensional_rows
from dong2015.chapter2.poisson_effect import poisson_effect_figures, poisson_effect_rows
from dong2015.chapter2.tribometer import tribometer_figures, tribometer_rows
from dong2015.chapter2.welder import material_pair_figures, material_pair_rows, welder_motor_rows, welder_rows
from dong2015.chapter2.welder_figures import metal_forming_figures, welder_figures
from dong2015.chapter3.cube import cube_figures, cube_rows
from dong2015.chapter3.parametric_study import parametric_study_figures, parametric_study_rows
from dong2015.chapter3.tribometer_response import vibration_period_figures
from dong2015.chapter4.collar_rows import collar_figures, collar_rows
from dong2015.chapter4.lubrication import lubrication_figures, lubrication_method_figures, lubrication_rows
from dong2015.chapter4.maps import coated_plate_figures, load_figures, load_rows, map_figures, map_rows
from dong2015.chapter4.power_rows import power_figures, power_map_rows
from dong2015.chapter4.skin_replica import cutter_head_figures, skin_replica_figures, skin_replica_rows
from dong2015.chapter4.temperature_rows import temperature_rows
from dong2015.chapter4.temperature_tests import dry_temperature_figures, temperature_figures
from dong2015.claims import Finding, findings
from dong2015.friction_models.computed_motion import (
    computed_motion_figures,
    power_map_test_rows,
    roughness_caveat,
    tribometer_test_rows,
)
from dong2015.friction_models.mechanisms import mechanism_figures
from dong2015.friction_models.variants import variant_figures
from dong2015.row import Row
from dong2015.summaries import summary_rows
from sonolube.charts import draw_chart
from sonolube.errors import UnknownName
from sonolube.figure import ReportFigure
from sonolube.prediction.figures import published_prediction_figures
from sonolube.validation.comparison import ComparedFit, compare_models
from sonolube.validation.figures import comparison_figures


@dataclass(frozen=True, kw_only=True, slots=True)
class ChapterFigure(ReportFigure):
    """Figure of the reproduction report with its chapter.

    Parameters
    ----------
    chapter : int
        Chapter of the dissertation.
    """

    chapter: int


@dataclass(frozen=True, kw_only=True, slots=True)
class Reproduction:
    """Rows and figures of the reproduction, with the findings on the claims that the rows decide about.

    Parameters
    ----------
    findings : tuple of Finding
    rows : tuple of Row
    figures : tuple of ChapterFigure
    caveats : tuple of str
        What the rows rest on that the dissertation speaks against.
    """

    findings: tuple[Finding, ...]
    rows: tuple[Row, ...]
    figures: tuple[ChapterFigure, ...]
    caveats: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, slots=True)
class Section:
    """Section of the dissertation with the functions that compute its rows and its figures.

    Parameters
    ----------
    number : str
        Number of the section, such as "2.3"; its first digit is the chapter of the figures.
    rows : callable
        Function that returns the rows.
    figures : callable
        Function that returns the figures.
    """

    number: str
    rows: Callable[[], Iterable[Row]] = tuple
    figures: Callable[[], Iterable[ReportFigure]] = tuple

    @property
    def chapter(self) -> int:
        """Chapter of the section."""
        return int(self.number[0])


@cache
def published_comparison() -> tuple[ComparedFit, ...]:
    """All model variants compared on all published tests."""
    return compare_models()


def _comparison_figures() -> Iterator[ReportFigure]:
    """Figures of the comparison of all model variants."""
    for each in comparison_figures(published_comparison):
        draw = partial(lambda chart: draw_chart(chart()), each.chart)
        yield ReportFigure(name=each.name, title=each.title, caption=each.caption, draw=draw)


SECTIONS: Final = (
    Section(number="2.1", rows=poisson_effect_rows, figures=poisson_effect_figures),
    Section(number="2.2", rows=flextensional_rows, figures=flextensional_figures),
    Section(number="2.3", rows=tribometer_rows, figures=tribometer_figures),
    Section(number="2.4", figures=metal_forming_figures),
    Section(number="2.4", rows=welder_rows, figures=welder_figures),
    Section(number="2.4", rows=welder_motor_rows),
    Section(number="2.5", rows=material_pair_rows, figures=material_pair_figures),
    Section(number="3.1", rows=cube_rows, figures=cube_figures),
    Section(number="3.3", rows=parametric_study_rows, figures=parametric_study_figures),
    Section(number="3.3", figures=vibration_period_figures),
    Section(number="4.1", rows=power_map_rows, figures=power_figures),
    Section(number="4.1", rows=map_rows, figures=map_figures),
    Section(number="4.1", figures=coated_plate_figures),
    Section(number="4.1", rows=load_rows, figures=load_figures),
    Section(number="4.2", figures=lubrication_method_figures),
    Section(number="4.2", rows=lubrication_rows, figures=lubrication_figures),
    Section(number="4.3", rows=temperature_rows, figures=temperature_figures),
    Section(number="4.3", figures=dry_temperature_figures),
    Section(number="4.4", rows=skin_replica_rows, figures=skin_replica_figures),
    Section(number="4.4", figures=cutter_head_figures),
    Section(number="4.5", rows=collar_rows, figures=collar_figures),
    Section(number="2.3", rows=tribometer_test_rows),
    Section(number="4.1", rows=power_map_test_rows),
    Section(number="3.3", figures=variant_figures),
    Section(number="4.1", figures=mechanism_figures),
    Section(number="3.3", figures=computed_motion_figures),
    Section(number="3.3", figures=_comparison_figures),
    Section(number="3.3", figures=published_prediction_figures),
)
"""All reproduced sections: those of the chapters, then the friction models on the friction tests of all chapters."""


def reproduction(
    *, chapter: int | None = None, advance: Callable[[str, int, int], None] = lambda what, done, total: None
) -> Reproduction:
    """Findings on the claims, and the published numbers beside the computed ones, with figures.

    Parameters
    ----------
    chapter : int, optional
        Only this chapter; all chapters where absent.
    advance : callable
        Called with the section that is computed, the number of steps done and their total.

    Returns
    -------
    Reproduction

    Raises
    ------
    UnknownName
        If no section of that chapter is reproduced.
    """
    chapters = sorted({section.chapter for section in SECTIONS})
    if chapter is not None and chapter not in chapters:
        raise UnknownName.among(map(str, chapters), kind="chapter", name=str(chapter))
    chosen = [section for section in SECTIONS if chapter in (None, section.chapter)]
    rows: list[Row] = []
    figures: list[ChapterFigure] = []
    for done, section in enumerate(chosen):
        advance(f"section {section.number}", done, 2 * len(chosen))
        rows += section.rows()
    rows += (row for row in summary_rows({row.id: row for row in rows}) if chapter in (None, row.chapter))
    for done, section in enumerate(chosen, start=len(chosen)):
        advance(f"figures of section {section.number}", done, 2 * len(chosen))
        figures += (ChapterFigure(chapter=section.chapter, **asdict(figure)) for figure in section.figures())
    return Reproduction(
        findings=findings(tuple(rows)),
        rows=tuple(rows),
        figures=tuple(figures),
        caveats=() if chapter == 3 else (roughness_caveat(),),
    )
