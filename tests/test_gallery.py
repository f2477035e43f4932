"""The gallery and the notebooks: each runs as it stands, and each figure can be read."""

import ast
import re
import tempfile
from pathlib import Path

import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from notebooks import cells_of, executed
from pictures import figure_of

ROOT = Path(__file__).parents[1]
SCRIPTS = sorted((ROOT / "examples" / "gallery").glob("*/*.py"))
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.py"))


def name_of(path: Path) -> str:
    return path.stem


def named_ticks(axes: Axes) -> bool:
    """Whether the ticks of the ordinate are names, which need no label."""
    return any(tick.get_text()[:1].isalpha() for tick in axes.get_yticklabels())


def texts_beyond_the_edge(figure: Figure) -> list[str]:
    """Titles, labels and legends that reach out of the figure by more than a pixel."""
    figure.draw_without_rendering()
    width, height = figure.bbox.size
    beyond = []
    for axes in figure.axes:
        legend = axes.get_legend()
        for artist in (axes.title, axes.xaxis.label, axes.yaxis.label, *([legend] if legend else [])):
            box = artist.get_window_extent()
            if box.width and (box.x0 < -1 or box.y0 < -1 or box.x1 > width + 1 or box.y1 > height + 1):
                beyond.append(str(artist))
    return beyond


def test_there_are_figures_for_every_group_and_the_page_shows_each_group() -> None:
    groups = {path.parent.name for path in SCRIPTS}
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^<!-- gallery: (\w+) -->$", page, flags=re.MULTILINE)) == groups
    assert len(SCRIPTS) >= 24


@pytest.mark.parametrize("script", SCRIPTS, ids=name_of)
def test_a_script_of_the_gallery_is_short_and_has_a_caption(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    title, blank, *caption = (ast.get_docstring(ast.parse(text)) or "").splitlines()
    assert title
    assert not title.endswith(".")
    assert not blank
    assert 40 < len(" ".join(caption)) < 400
    assert len(text.splitlines()) <= 42


@pytest.mark.parametrize("script", SCRIPTS, ids=name_of)
def test_a_script_of_the_gallery_draws_a_figure_with_labels_inside_its_edges(script: Path) -> None:
    figure = figure_of(script)
    assert any(axes.get_xlabel() for axes in figure.axes)
    assert not texts_beyond_the_edge(figure)
    assert any(axes.get_ylabel() or named_ticks(axes) for axes in figure.axes)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=name_of)
def test_a_notebook_runs_and_prints_and_draws(notebook: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    cells = executed(notebook)
    assert any(printed for _, printed, _ in cells)
    assert any(figures for _, _, figures in cells)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=name_of)
def test_a_notebook_begins_with_its_title_and_has_a_page(notebook: Path) -> None:
    assert cells_of(notebook)[0].text.startswith("# ")
    page = ROOT / "docs" / "notebooks" / f"{notebook.stem}.md"
    assert page.read_text(encoding="utf-8").strip() == f"<!-- notebook: {notebook.stem} -->"
