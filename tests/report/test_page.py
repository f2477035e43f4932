"""Pages of results: figures by format, beside or within the page, captions, notes, and no text of users as markup."""

import base64
import re
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from pytest import mark

from sonolube import __version__
from sonolube.charts import Axis, Line, one_panel
from sonolube.report.page import Drawing, Page, PageTable, drawn, embedded, html, rendered_files

PNG = b"\x89PNG"


def line(label: str, **more: Any) -> Drawing:
    chart = one_panel(Axis("Time", "s"), Axis(label, "N"), [Line(x=np.arange(3.0), y=np.arange(3.0))])
    return Drawing(chart=lambda: chart, **more)


def test_a_drawing_is_its_chart_or_the_picture_that_has_none() -> None:
    assert line("Force").figure().axes[0].get_ylabel() == "Force [N]"
    own = Figure()
    own.subplots()
    assert Drawing(draw=lambda: own).figure() is own


def test_a_figure_is_rendered_once_in_each_format_that_is_asked_for() -> None:
    made: list[int] = []
    own = Figure()

    def draw() -> Figure:
        made.append(1)
        return own

    found = drawn(Drawing(draw=draw), forms=("png", "svg"))
    assert list(found) == ["png", "svg"]
    assert found["png"].startswith(PNG)
    assert b"<svg" in found["svg"]
    assert made == [1]


def test_files_without_a_page_are_the_figures_in_their_own_formats_and_progress_comes_before_each() -> None:
    told: list[tuple[str, int, int]] = []
    found = rendered_files(
        {"first": line("a", forms=("svg",)), "none": line("b", forms=()), "last": line("c", forms=("png",))},
        advance=lambda *each: told.append(each),
    )
    assert list(found) == ["first.svg", "last.png"]
    assert told == [("first", 0, 3), ("none", 1, 3), ("last", 2, 3)]


def test_a_page_holds_each_figure_and_no_further_file_is_written_for_that() -> None:
    page = Page(
        name="own",
        title="Own <page>",
        settings=[("rig", "tribometer")],
        facts=[("friction", "1 N & more")],
        tables=[PageTable(title="Points", heads=("load [N]",), rows=(("3",), ("5",)))],
    )
    found = rendered_files(
        {"first": line("a", forms=("svg",), caption="First one"), "bare": line("b", forms=(), caption="Bare one")},
        page=page, notes=["caveat: rough"],
    )  # fmt: skip
    assert list(found) == ["own.html", "first.svg"]
    text = found["own.html"]
    assert isinstance(text, str)
    assert "<h1>Own &lt;page&gt;</h1>" in text
    assert "1 N &amp; more" in text
    assert "<td>3</td>" in text
    assert "<li>caveat: rough</li>" in text
    pictures = re.findall(r'<img alt="([^"]*)" src="data:image/png;base64,([^"]+)"', text)
    assert [caption for caption, _ in pictures] == ["First one", "Bare one"]
    assert all(base64.b64decode(content).startswith(PNG) for _, content in pictures)
    assert f"sonolube {__version__}; Python" in text
    assert re.search(r"numpy \d+\.\d+.*, matplotlib \d+\.\d+", text)


def test_a_picture_within_a_page_is_its_bytes_in_base_64() -> None:
    assert base64.b64decode(embedded(b"\x00\xffpng")) == b"\x00\xffpng"


@mark.parametrize("text", ["a\x00b", "a\x1b[31mb"])
def test_control_characters_of_users_do_not_reach_a_page(text: str) -> None:
    found = html(
        "page.html", page=Page(name="n", title=text, settings=(), facts=()), pictures=(), notes=(), versions=""
    )
    assert not set(found) & {"\x00", "\x1b"}
