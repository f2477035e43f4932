"""Picture of the rooms and their imports, drawn from the code as SVG: `python docs/_ext/architecture_picture.py`.

Rows are the layers that `pyproject.toml` states; an arrow leads from a room to one that it imports, where no longer way
of arrows leads there too (the transitive reduction). The three lowest layers serve every room, and have no arrows.
"""

import tomllib
from itertools import product
from pathlib import Path

import grimp

ROOT = Path(__file__).parents[2]
PICTURE = ROOT / "docs" / "images" / "architecture.svg"

_WIDTH, _BOX, _GAP, _ROW, _MARGIN = 900, 30, 16, 74, 24
_GROUND = 3  # layers that every room may use
_SHIFT = 150  # of a row of one room to the side, so that arrows pass beside it
_LETTER = 7.6  # width of a letter
_FONT = "font-family='DejaVu Sans, Verdana, sans-serif'"


def layers() -> list[list[str]]:
    """Return the rooms of each layer, highest first, as `pyproject.toml` states them."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    stated = next(contract["layers"] for contract in contracts if contract.get("containers") == ["sonolube"])
    return [[room.strip() for room in layer.replace(":", "|").split("|")] for layer in stated]


def imports(rooms: list[str]) -> set[tuple[str, str]]:
    """Return the pairs of rooms of which the first imports the second, without those that follow from others."""
    graph = grimp.build_graph("sonolube", cache_dir=None)
    graph_of = {room: {f"sonolube.{room}", *graph.find_descendants(f"sonolube.{room}")} for room in rooms}
    direct = {
        (one, other)
        for one, other in product(rooms, rooms)
        if one != other
        and any(graph.find_modules_directly_imported_by(module) & graph_of[other] for module in graph_of[one])
    }
    reached: dict[str, set[str]] = {}

    def below(room: str) -> set[str]:
        if room not in reached:
            reached[room] = {there for start, end in direct if start == room for there in {end, *below(end)}}
        return reached[room]

    return {
        (one, other)
        for one, other in direct
        if not any(other in below(middle) for start, middle in direct if start == one and middle != other)
    }


def picture() -> str:
    """Return the picture as SVG text, the same for the same imports."""
    rows = layers()
    rooms = [room for row in rows for room in row]
    above = [room for row in rows[:-_GROUND] for room in row]
    graph = grimp.build_graph("sonolube", cache_dir=None)
    sizes = {room: 1 + len(graph.find_descendants(f"sonolube.{room}")) for room in rooms}
    boxes: dict[str, tuple[float, float, float]] = {}
    for index, row in enumerate(rows):
        widths = [2 * _GAP + _LETTER * len(room) for room in row]
        left = (_WIDTH - sum(widths) - 2.5 * _GAP * (len(row) - 1)) / 2
        if len(row) == 1 and 0 < index < len(rows) - _GROUND:
            left += _SHIFT if index % 2 else -_SHIFT
        for room, width in zip(row, widths, strict=True):
            boxes[room] = (left, _MARGIN + index * _ROW, width)
            left += width + 2.5 * _GAP
    height = 2 * _MARGIN + (len(rows) - 1) * _ROW + _BOX
    lines = [
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {_WIDTH} {height}' width='{_WIDTH}' height='{height}'>",
        "<title>Rooms of sonolube and what they import</title>",
        "<defs><marker id='tip' viewBox='0 0 8 8' refX='7' refY='4' markerWidth='7' markerHeight='7' orient='auto'>"
        "<path d='M0,1 L7,4 L0,7 z' fill='#5b6570'/></marker></defs>",
        f"<rect width='{_WIDTH}' height='{height}' fill='#ffffff'/>",
        *(_arrow(boxes[one], boxes[other]) for one, other in sorted(imports(above))),
        _note(height),
        *(_room(room, boxes[room], sizes[room]) for room in rooms),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def _arrow(start: tuple[float, float, float], end: tuple[float, float, float]) -> str:
    x0, y0 = start[0] + start[2] / 2, start[1] + _BOX
    x1, y1 = end[0] + end[2] / 2, end[1] - 1
    bend = (y1 - y0) / 2
    curve = f"M{x0:.0f},{y0:.0f} C{x0:.0f},{y0 + bend:.0f} {x1:.0f},{y1 - bend:.0f} {x1:.0f},{y1:.0f}"
    return f"<path d='{curve}' fill='none' stroke='#9aa4af' stroke-width='1.1' marker-end='url(#tip)'/>"


def _room(name: str, box: tuple[float, float, float], modules: int) -> str:
    left, top, width = box
    shade = "#0072b2" if modules > 25 else "#3a8fc4" if modules > 8 else "#7fb8dc"
    return (
        f"<g><rect x='{left:.0f}' y='{top:.0f}' width='{width:.0f}' height='{_BOX}' rx='5' fill='{shade}'/>"
        f"<text x='{left + width / 2:.0f}' y='{top + 19.5:.1f}' {_FONT} font-size='12.5' fill='#ffffff'"
        f" text-anchor='middle'>{name}</text></g>"
    )


def _note(height: float) -> str:
    y = height - _MARGIN - (_GROUND - 1) * _ROW - _BOX - 14
    line = f"<line x1='40' x2='{_WIDTH - 40}' y1='{y:.0f}' y2='{y:.0f}' stroke='#d6dbe1' stroke-dasharray='4 4'/>"
    text = f"<text x='{_WIDTH - 40}' y='{y - 6:.0f}' {_FONT} font-size='11' fill='#5b6570' text-anchor='end'>"
    return f"{line}{text}base: every room may import it</text>"


if __name__ == "__main__":
    PICTURE.write_text(picture(), encoding="utf-8")
