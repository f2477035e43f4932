"""Figures of commands at their final size: of a column or a page, legible, nothing cut off or overlapping."""

import itertools
import os
import re
import subprocess
import sys
import zlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

import pytest
from fontTools.ttLib import TTFont  # type: ignore[import-untyped]
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from pytest import MonkeyPatch, approx
from tests.cli.conftest import Program

from sonolube.figure import FIGURE_STYLES, render_figure
from sonolube.report import page

pytestmark = pytest.mark.usefixtures("compiled_kernels")

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


def test_a_command_draws_in_a_home_that_cannot_be_written_and_keeps_the_list_of_fonts(tmp_path: Path) -> None:
    named = ("HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "MPLCONFIGDIR")
    environment = {name: value for name, value in os.environ.items() if name not in named}
    program = Path(sys.executable).with_name("sonolube")
    (tmp_path / "temporary").mkdir()
    run = subprocess.run(
        [program, "simulate", TRIBOMETER],
        cwd=tmp_path,
        env=environment | {"HOME": os.devnull, "TMPDIR": str(tmp_path / "temporary")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "atplotlib" not in run.stderr
    assert len(list((tmp_path / "out").glob("tribometer-simulation.*"))) == 4
    assert list((tmp_path / "temporary").rglob("fontlist-*.json"))


def test_fonts_in_a_pdf_hold_outlines_alone_and_what_they_show_can_be_copied() -> None:
    figure = Figure(figsize=(3, 2))
    figure.text(0.5, 0.5, "Gap at rest, 2.31 µm: fi ffl")
    content = render_figure(figure, "pdf")
    streams = [zlib.decompress(each) for each in re.findall(rb"stream\r?\n(.*?)\r?\nendstream", content, re.DOTALL)]
    fonts = [TTFont(BytesIO(each)) for each in streams if each.startswith(b"\x00\x01\x00\x00")]
    assert fonts
    for font in fonts:
        assert {"glyf", "loca", "hmtx", "head", "maxp"} <= set(font.keys())
        assert not {"GSUB", "GPOS", "GDEF", "kern"} & set(font.keys())
    assert any(b"beginbfrange" in each or b"beginbfchar" in each for each in streams)


def test_a_figure_is_drawn_once_in_each_format(monkeypatch: MonkeyPatch) -> None:
    figure = Figure(figsize=(4.0, 3.0), layout="constrained")
    figure.subplots().plot([1, 2, 3], label="a")
    figure.legend(loc="outside upper center")
    drawn: list[object] = []
    draw = Figure.draw

    def counted(self: Figure, renderer: RendererBase) -> None:
        drawn.append(renderer)
        draw(self, renderer)

    monkeypatch.setattr(Figure, "draw", counted)
    for form in ("png", "svg", "pdf"):
        render_figure(figure, form)
    assert len(drawn) == 3
    left, bottom = figure.axes[0].get_position().min
    assert left > 0.05
    assert bottom > 0.05
    assert left != approx(0.125)  # where axes are without a layout
