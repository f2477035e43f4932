"""Reduced TrueType fonts, read by fontTools and FreeType."""

import io
from pathlib import Path

import pytest
from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.ttLib import TTFont
from matplotlib import font_manager
from matplotlib.figure import Figure
from matplotlib.ft2font import FT2Font, LoadFlags

from sonolube.figure import render_figure
from sonolube.truetype import reduced_font

FONT = Path(font_manager.findfont("DejaVu Sans"))
TEXT = "Rq 0.35 µm, é ü Ж ½"


def numbers_of(text: str) -> dict[str, int]:
    font = TTFont(FONT)
    return {each: font.getGlyphID(font.getBestCmap()[ord(each)]) for each in text}


def drawn(font: TTFont, number: int) -> list[object]:
    pen = DecomposingRecordingPen(font.getGlyphSet())
    font.getGlyphSet()[font.getGlyphName(number)].draw(pen)
    return pen.value


def test_glyphs_of_a_reduced_font_are_those_of_the_font_also_where_they_are_composed_of_others() -> None:
    wanted = numbers_of(TEXT)
    content, numbers = reduced_font(FONT.read_bytes(), wanted.values())
    reduced, whole = TTFont(io.BytesIO(content), checkChecksums=2), TTFont(FONT)
    for each, number in wanted.items():
        assert drawn(reduced, numbers[number]) == drawn(whole, number), each
        names = reduced.getGlyphName(numbers[number]), whole.getGlyphName(number)
        assert reduced["hmtx"][names[0]] == whole["hmtx"][names[1]]
    assert len(content) < 0.05 * FONT.stat().st_size
    assert reduced["maxp"].numGlyphs == len(numbers) < 2 * len(TEXT)


def test_freetype_draws_a_reduced_font_as_it_draws_the_font(tmp_path: Path) -> None:
    (number,) = numbers_of("é").values()
    content, numbers = reduced_font(FONT.read_bytes(), [number])
    (tmp_path / "reduced.ttf").write_bytes(content)
    pictures = []
    for path, glyph in ((FONT, number), (tmp_path / "reduced.ttf", numbers[number])):
        font = FT2Font(str(path))
        font.set_size(40, 100)
        found = font.load_glyph(glyph, flags=LoadFlags.NO_HINTING)
        pictures.append((found.width, found.height, found.horiAdvance, font.get_path()[0].tolist()))
    assert pictures[0] == pictures[1]


def test_a_pdf_holds_the_reduced_font_and_its_text() -> None:
    figure = Figure()
    figure.text(0.1, 0.5, TEXT)
    content = render_figure(figure, "pdf")
    assert b"/FontFile2" in content
    assert len(content) < 40_000
    assert content == render_figure(figure, "pdf")


def test_fonts_without_such_outlines_are_left_to_others() -> None:
    with pytest.raises(ValueError, match="no TrueType font"):
        reduced_font(b"OTTO" + bytes(40), [3])
