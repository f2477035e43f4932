"""The gallery and the notebooks: each runs as it stands, and each figure can be read."""

import ast
import re
import tempfile
from pathlib import Path

import numpy as np
import pytest
from dark_figures import dark_colour, darken
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from notebooks import cells_of, executed
from pictures import dark_of, figure_of, image, write
from PIL import Image

from sonolube.figure import COLOURS

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
    assert any(axes.get_xlabel() or not axes.axison for axes in figure.axes)  # a picture of a solid has no axes
    assert not texts_beyond_the_edge(figure)
    assert any(axes.get_ylabel() or named_ticks(axes) for axes in figure.axes)


def test_the_page_of_a_notebook_has_what_it_prints_and_draws(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    cells = executed(ROOT / "examples" / "notebooks" / "control_engineer.py")  # the others are run in a kernel
    assert any(printed for _, printed, _ in cells)
    assert any(figures for _, _, figures in cells)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=name_of)
def test_a_notebook_begins_with_its_title_and_has_a_page(notebook: Path) -> None:
    assert cells_of(notebook)[0].text.startswith("# ")
    page = ROOT / "docs" / "notebooks" / f"{notebook.stem}.md"
    assert page.read_text(encoding="utf-8").strip() == f"<!-- notebook: {notebook.stem} -->"


def luminance(colour: object) -> float:
    """Relative luminance after WCAG 2."""
    channels: np.ndarray = np.array(to_rgb(colour))  # type: ignore[arg-type]
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


DARK_PAGE = "#131416"  # ground of the dark theme


@pytest.mark.parametrize("colour", [*COLOURS, "black", "0.3", "navy", "darkred"])
def test_inks_of_light_pages_have_contrast_on_dark_ones(colour: str) -> None:
    assert (luminance(dark_colour(colour)) + 0.05) / (luminance(DARK_PAGE) + 0.05) > 4.5


@pytest.mark.parametrize("colour", ["white", "0.95", "#eef4ff"])
def test_pale_grounds_become_dark(colour: str) -> None:
    assert luminance(dark_colour(colour)) < 0.06


def test_a_figure_for_dark_pages_has_light_text_on_nothing_and_its_map_of_colours_untouched(tmp_path: Path) -> None:
    figure = Figure()
    curves, heights = figure.subplots(1, 2)
    curves.plot([0, 1], color="black")
    curves.text(0.5, 0.5, "said", color="0.2")
    curves.set(xlabel="x [m]", title="curves")
    shown = heights.imshow(np.arange(4).reshape(2, 2))
    (mark,) = heights.plot([0, 1], color="white")
    before = shown.to_rgba(shown.get_array())
    write(figure, tmp_path / "one.png")
    texts = [curves.title, curves.xaxis.label, *curves.texts, *curves.get_xticklabels()]
    assert min(luminance(text.get_color()) for text in texts) > 0.4
    assert luminance(curves.lines[0].get_color()) > 0.4
    assert np.array_equal(shown.to_rgba(shown.get_array()), before)
    assert to_rgb(mark.get_color()) == (1, 1, 1)
    with Image.open(tmp_path / "one.png") as light, Image.open(dark_of(tmp_path / "one.png")) as dark:
        assert light.size == dark.size
        assert light.convert("RGBA").getpixel((0, 0)) == (255, 255, 255, 255)
        assert dark.convert("RGBA").getpixel((0, 0))[3] == 0  # type: ignore[index]


def test_pages_have_a_picture_for_each_theme() -> None:
    text = image("a curve", "pictures/a.png")
    assert re.findall(r"image\} (\S+)", text) == ["pictures/a.png", "pictures/a-dark.png"]
    assert re.findall(r":class: (\S+)", text) == ["only-light", "only-dark"]


def test_the_body_of_a_mode_keeps_its_colours_in_the_dark() -> None:
    script = next(path for path in SCRIPTS if path.stem == "mode_of_a_horn")
    figure = figure_of(script)
    (body,) = figure.axes[0].collections
    before = body.get_facecolor()
    darken(figure)
    assert np.array_equal(body.get_facecolor(), before)
