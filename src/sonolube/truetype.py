"""TrueType fonts reduced to the glyphs of a figure, for embedding in PDF files."""

import struct
from collections.abc import Iterable, Iterator

_HEADER, _ENTRY = struct.Struct(">4s4H"), struct.Struct(">4s3I")
_COPIED = ("cvt ", "fpgm", "prep")  # programs that fit outlines to pixels
_FLAGS = ((0x01, 2), (0x08, 2), (0x40, 4), (0x80, 8))  # bits of a part of a composite glyph, and bytes that they add
_MORE_PARTS = 0x20
_WHOLE = 0xB1B0AFBA  # of which and of the sum of the file the check sum of a font is the difference


def reduced_font(font: bytes, glyphs: Iterable[int]) -> tuple[bytes, dict[int, int]]:
    """Font with some of its glyphs, and those that they are composed of, without names and tables for layout.

    Parameters
    ----------
    font : bytes
        Content of a TrueType file.
    glyphs : iterable of int
        Numbers of the glyphs.

    Returns
    -------
    content : bytes
    numbers : dict of int to int
        In the reduced font, by those in the font. Glyph 0, which stands for missing ones, remains.

    Raises
    ------
    ValueError
        If the font has no TrueType outlines of its own, as those of PostScript outlines and collections.
    """
    tables = _tables(font)
    widths = struct.unpack(">H", tables["hhea"][34:36])[0]
    count = struct.unpack(">H", tables["maxp"][4:6])[0] + 1
    long = tables["head"][50:52] == b"\0\1"
    places = struct.unpack_from(f">{count}{'I' if long else 'H'}", tables["loca"])
    step = 1 if long else 2

    def outline(number: int) -> bytes:
        return tables["glyf"][step * places[number] : step * places[number + 1]]

    kept, waiting = {0}, [*glyphs, 0]
    while waiting:
        number = waiting.pop()
        kept.add(number)
        waiting += [part for _, part in _parts(outline(number)) if part not in kept]
    numbers = {number: new for new, number in enumerate(sorted(kept))}
    outlines, ends, metrics = b"", [0], b""
    for number in numbers:
        renumbered = bytearray(outline(number))
        for place, part in _parts(bytes(renumbered)):
            struct.pack_into(">H", renumbered, place, numbers[part])
        outlines += bytes(renumbered) + bytes(-len(renumbered) % 4)
        ends.append(len(outlines))
        metrics += _metrics(tables["hmtx"], number, widths)
    size = struct.pack(">H", len(numbers))
    changed = {
        "glyf": outlines,
        "head": tables["head"][:8] + bytes(4) + tables["head"][12:50] + b"\0\1" + tables["head"][52:],
        "hhea": tables["hhea"][:34] + size,
        "hmtx": metrics,
        "loca": struct.pack(f">{len(ends)}I", *ends),
        "maxp": tables["maxp"][:4] + size + tables["maxp"][6:],
    }
    return _file({name: tables[name] for name in _COPIED if name in tables} | changed), numbers


def _tables(font: bytes) -> dict[str, bytes]:
    """Tables of a font by name."""
    kind, count, *_ = _HEADER.unpack_from(font)
    if kind not in (b"\0\1\0\0", b"true"):
        raise ValueError("no TrueType font")
    entries = (_ENTRY.unpack_from(font, _HEADER.size + 16 * row) for row in range(count))
    tables = {name.decode("latin-1"): font[start : start + length] for name, _, start, length in entries}
    if "glyf" not in tables:
        raise ValueError("no TrueType outlines")
    return tables


def _parts(outline: bytes) -> Iterator[tuple[int, int]]:
    """Places of the numbers of the parts of a composite glyph in its outline, and these numbers."""
    if len(outline) < 10 or outline[0] < 0x80:  # a simple glyph has a number of contours that is not negative
        return
    place, flags = 10, _MORE_PARTS
    while flags & _MORE_PARTS:
        flags, part = struct.unpack_from(">2H", outline, place)
        yield place + 2, part
        place += 6 + sum(size for bit, size in _FLAGS if flags & bit)


def _metrics(table: bytes, number: int, widths: int) -> bytes:
    """Width and left bearing of a glyph; those beyond the last width share it."""
    if number < widths:
        return table[4 * number : 4 * number + 4]
    bearing = 4 * widths + 2 * (number - widths)
    return table[4 * widths - 4 : 4 * widths - 2] + table[bearing : bearing + 2]


def _file(tables: dict[str, bytes]) -> bytes:
    """Content of a font file with these tables."""
    power = len(tables).bit_length() - 1
    header = _HEADER.pack(b"\0\1\0\0", len(tables), 16 << power, power, 16 * len(tables) - (16 << power))
    start, directory, content = _HEADER.size + 16 * len(tables), b"", b""
    for name, table in sorted(tables.items()):
        directory += _ENTRY.pack(name.encode("latin-1"), _sum(table), start + len(content), len(table))
        content += table + bytes(-len(table) % 4)
    font = bytearray(header + directory + content)
    head = font.index(b"head") + 8
    place = struct.unpack_from(">I", font, head)[0] + 8
    struct.pack_into(">I", font, place, (_WHOLE - _sum(bytes(font))) % 2**32)
    return bytes(font)


def _sum(table: bytes) -> int:
    """Check sum: the sum of the numbers of four bytes."""
    padded = table + bytes(-len(table) % 4)
    return sum(struct.unpack(f">{len(padded) // 4}I", padded)) % 2**32
