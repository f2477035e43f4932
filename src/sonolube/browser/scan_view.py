"""Scans as a page shows them: a map of the cells that a screen resolves, the form, and sections along lines."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, get_args

from sonolube import __version__
from sonolube.browser.requests import Places
from sonolube.browser.uploads import uploaded
from sonolube.charts import Chart, chart_object
from sonolube.errors import InvalidInput, SonolubeError, UnknownName
from sonolube.measurement.surface_files.reader import SurfaceFile
from sonolube.models.surfaces import HeightMap
from sonolube.report.measured.scan import ShownHeights, cells_text, scan_chart, section_chart, shown_heights, size_of
from sonolube.report.measured.surface import SurfaceSettings, spacings, surface_file, surface_source
from sonolube.tasks.files import NamedBytes, file_path, private_files
from sonolube.tasks.measure.measured_files import reason_of
from sonolube.text.units import to_si

_HIGHEST_DEGREE: Final = 12
_ENDS: Final = ("from_x", "from_y", "to_x", "to_y")
_Facts = tuple[tuple[str, str], ...]


def scan_view(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Map or profile of a scan, its origin, what is said of its form, and the sizes of its units in m.

    Of `payload`: `file`, an upload; `spacing` and `length_unit` for files that lack them; `degree` and `robust` of the
    form; `shown`, which heights: "levelled", "measured" or "form".
    """
    with _refusals():
        file, surface, facts = _scan(payload, places)
        chart = scan_chart(surface)
        is_profile = not chart.panels[0].has_equal_scales
        cells = () if is_profile else (("cells of the map", cells_text(surface)),)
    source = {name: text for name, text in surface_source(file).items() if text}
    return {
        "facts": [*source.items(), *cells, *facts],
        "caveats": list(file.caveats),
        "is_profile": is_profile,
        **_charted(chart),
    }


def section_view(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Section of a scan along a line, and what is said of it.

    Of `payload`: as of `scan_view`, and `section`, texts with units by `from_x`, `from_y`, `to_x` and `to_y`.
    """
    given = payload.get("section")
    if not isinstance(given, Mapping):
        raise InvalidInput(f"section: give {', '.join(_ENDS)}, such as 12 um", key="section")
    ends = [_length(name, given.get(name, "")) for name in _ENDS]
    with _refusals():
        file, surface, _ = _scan(payload, places)
        chart, facts = section_chart(surface, start=ends[:2], end=ends[2:])
    line = ", ".join(f"{name} {given[name]}" for name in _ENDS)
    note = f"sonolube {__version__}: section of {file.path.name}, sha256 {file.sha256}, {line}"
    return {"facts": facts, "note": note, **_charted(chart)}


def _charted(chart: Chart) -> dict[str, Any]:
    """Chart as an object, and the sizes of the units of its axes and of its heights in m."""
    (panel,) = chart.panels
    height = getattr(panel.parts[0], "unit", panel.y.unit)
    return {"chart": chart_object(chart), "metres": {"across": size_of(panel.x.unit), "height": size_of(height)}}


@contextmanager
def _refusals() -> Iterator[None]:
    """Say refusals in one line, with names of files in place of paths."""
    with private_files():
        try:
            yield
        except SonolubeError as failure:
            raise InvalidInput(reason_of(failure), key=getattr(failure, "key", "")) from None


def _length(name: str, text: Any) -> float:
    """Length of an entry of a request. [m]"""
    try:
        return to_si(str(text), unit="m", name=name)
    except InvalidInput as failure:
        raise InvalidInput(str(failure), key=name) from None


def _scan(payload: Mapping[str, Any], places: Places) -> tuple[SurfaceFile, HeightMap, _Facts]:
    """File of a request, the heights that are to be shown, and what is said of their form."""
    name, path = uploaded(payload.get("file"), places)
    degree, shown = payload.get("degree", 1), payload.get("shown", "levelled")
    if not isinstance(degree, int) or not 0 <= degree <= _HIGHEST_DEGREE:
        raise InvalidInput(f"degree: give a whole number from 0 to {_HIGHEST_DEGREE}", key="degree")
    if shown not in get_args(ShownHeights):
        raise UnknownName.among(get_args(ShownHeights), kind="kind of heights", name=str(shown))
    spacing, unit = (str(payload.get(key) or "") for key in ("spacing", "length_unit"))
    file = _read(name, path, spacing, unit)
    return file, *_shown(file, shown, degree, bool(payload.get("robust")))


@lru_cache(maxsize=1)
def _read(name: str, path: Path, spacing: str, unit: str) -> SurfaceFile:
    """Height map of an upload, which does not change; the latest is kept for sections of it."""
    try:
        spacing_x, spacing_y = spacings(spacing or None, name="spacing")
    except InvalidInput as failure:
        raise InvalidInput(str(failure), key="spacing") from None
    settings = SurfaceSettings(spacing_x=spacing_x, spacing_y=spacing_y, length_unit=unit or None)
    return surface_file(file_path(NamedBytes(name, path.read_bytes())), settings)


@lru_cache(maxsize=1)
def _shown(file: SurfaceFile, shown: ShownHeights, degree: int, robust: bool) -> tuple[HeightMap, _Facts]:
    """Heights of a file to show, and what is said of their form."""
    surface, facts = shown_heights(file.height_map, shown=shown, degree=degree, robust=robust)
    return surface, tuple(facts)
