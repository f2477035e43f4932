"""Reproduction of one chapter: its own rows and figures only."""

import re
from pathlib import Path

import pytest

from dong2015 import SECTIONS, reproduction
from dong2015.plots import figure_texts

PAGE = Path(__file__).parents[3] / "docs" / "validation.md"


def test_the_reproduction_of_a_chapter_has_its_rows_and_figures_only() -> None:
    parts: list[tuple[str, int, int]] = []
    result = reproduction(chapter=2, advance=lambda *part: parts.append(part))
    assert [done for _, done, _ in parts] == list(range(parts[0][2]))
    assert {"section 2.3", "figures of section 2.3"} <= {what for what, _, _ in parts}
    assert {row.chapter for row in result.rows} == {2}
    assert {figure.chapter for figure in result.figures} == {2}
    # section 2.2, and the friction tests of Table 2.5 but not those of Table 4.2
    identifiers = {row.id for row in result.rows}
    assert {"2.2.5-speed-of-no-reduction", "friction-model-asperity-stick-slip-fitted-A-1"} <= identifiers
    assert "friction-model-asperity-stick-slip-fitted-B-1" not in identifiers


def test_every_figure_with_assumed_inputs_that_the_page_lists_is_drawn() -> None:
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")
    part = PAGE.read_text(encoding="utf-8").partition("### Figures with assumed inputs")[2].partition("\n## ")[0]
    listed = re.findall(r"^\|[^|]*\| `([\w-]+)` \|", part, flags=re.MULTILINE)
    captions = {figure.name: figure.caption for section in SECTIONS for figure in section.figures()}
    assert len(listed) == 11
    assert [name for name in listed if not re.search(r"assumed|printed|no model", captions.get(name, ""))] == []


def test_every_text_of_a_figure_is_that_of_a_figure_that_is_drawn() -> None:
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")
    drawn = {figure.name: figure for section in SECTIONS for figure in section.figures()}
    assert figure_texts().keys() <= drawn.keys()
    assert [name for name in figure_texts() if re.search(r"[{}]", drawn[name].caption)] == []
