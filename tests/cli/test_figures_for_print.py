"""Figures of commands at their final size: of a column or a page, legible, nothing cut off or overlapping."""

import itertools
from collections.abc import Iterator
from pathlib import Path

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from pytest import MonkeyPatch, approx
from tests.cli.conftest import Program

from sonolube.figure import FIGURE_STYLES, render_figure
from sonolube.report import page

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
TRIBOMETER = RIGS / "tribometer.toml"
COMMANDS = {
    "frequency": ("sweep", TRIBOMETER, "--of", "frequency", "--points", "30"),
    "voltage": ("sweep", TRIBOMETER, "--of", "voltage", "--points", "9"),
    "speed": ("sweep", TRIBOMETER, "--of", "speed", "--points", "9"),
    "waveform": ("sweep", TRIBOMETER, "--of", "waveform"),
    "power": ("sweep", TRIBOMETER, "--of", "power", "--points", "9"),
    "load": ("sweep", TRIBOMETER, "--of", "load", "--points", "5"),
    "one map": ("map", RIGS / "power_map.toml", "--kind", "velocity-power"),
    "maps": ("map", TRIBOMETER, "--over", "sliding.sliding_speed=10mm/s,50mm/s,200mm/s"),
    "simulate": ("simulate", TRIBOMETER),
    "response": ("response", TRIBOMETER),
    "literature": ("literature", TRIBOMETER),
}


@pytest.fixture
def figures(monkeypatch: MonkeyPatch) -> list[Figure]:
    """Every figure that a command renders."""
    rendered: list[Figure] = []
    render = render_figure

    def keep(figure: Figure, form: str) -> bytes:
        content = render(figure, form)
        if form == "png":
            rendered.append(figure)
        return content

    monkeypatch.setattr(page, "render_figure", keep)
    return rendered


def shown(figure: Figure) -> Iterator[Text]:
    """Texts of a figure that are drawn."""
    for text in figure.findobj(Text):
        if isinstance(text, Text) and text.get_visible() and text.get_text().strip():
            yield text


def ticks(figure: Figure) -> Iterator[list[Text]]:
    """Labels of the main ticks of each axis within its limits."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            drawn = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
            yield [tick.label1 for tick in drawn if tick.label1.get_visible() and tick.label1.get_text()]


@pytest.mark.parametrize("style", FIGURE_STYLES)
@pytest.mark.parametrize("name", COMMANDS)
def test_a_figure_has_a_width_of_its_style_and_text_that_can_be_read(
    name: str, style: str, sonolube: Program, figures: list[Figure], tmp_path: Path
) -> None:
    assert sonolube(*COMMANDS[name], "--style", style, "--out", tmp_path).code == 0
    known = FIGURE_STYLES[style]
    assert figures
    for figure in figures:
        width, height = 25.4 * figure.get_size_inches()
        assert width == approx(known.column_width, abs=0.01) or width == approx(known.page_width, abs=0.01)
        assert height <= known.largest_height + 0.01
        assert min(float(text.get_fontsize()) for text in shown(figure)) >= known.smallest_text
        assert_readable(figure)


def assert_readable(figure: Figure) -> None:
    """Labels within the figure, and no label of a tick on the next."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    edge = figure.bbox.padded(2.0)
    labels = [text for axes in figure.axes for text in (axes.xaxis.label, axes.yaxis.label, axes.title)]
    for text in (each for each in labels if each.get_text()):
        box = text.get_window_extent()
        assert edge.contains(box.x0, box.y0), text.get_text()
        assert edge.contains(box.x1, box.y1), text.get_text()
    for row in ticks(figure):
        boxes = [label.get_window_extent() for label in row]
        for (one, left), (two, right) in itertools.pairwise(zip(row, boxes, strict=True)):
            assert not left.padded(-1).overlaps(right.padded(-1)), (one.get_text(), two.get_text())


def test_a_picture_has_the_width_and_resolution_of_the_journal(sonolube: Program, tmp_path: Path) -> None:
    import matplotlib.image

    assert sonolube(*COMMANDS["load"], "--out", tmp_path).code == 0
    picture = matplotlib.image.imread(tmp_path / "tribometer-load.png")
    assert picture.shape[1] == approx(174 / 25.4 * 300, abs=1)
    assert {path.suffix for path in tmp_path.glob("tribometer-load.*")} == {".png", ".svg", ".pdf", ".nc"}


@pytest.mark.parametrize("drawn", [4.6, 6.0, 11.0])
def test_a_narrow_figure_takes_a_column_and_any_other_the_page(drawn: float) -> None:
    from sonolube.figure import fit_to_style

    figure = Figure(figsize=(drawn, 3.0))
    figure.text(0.5, 0.5, "small", fontsize=5)
    fit_to_style(figure)
    width, height = 25.4 * figure.get_size_inches()
    assert width == approx(85.0 if drawn < 4.7 else 174.0)
    assert height <= 3.0 * 25.4 + 1e-9
    assert next(shown(figure)).get_fontsize() == 7.0
