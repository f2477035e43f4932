"""All formats of the SurfaceTopography library, with the extra ``surfaces``."""

import io
import math
import warnings
from collections.abc import Sequence
from contextlib import redirect_stdout
from datetime import datetime
from pathlib import Path
from typing import Any, BinaryIO, ClassVar, final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.extras import missing_package
from sonolube.measurement.limits import require_values
from sonolube.measurement.surface_files.regular_grid import even_profile
from sonolube.measurement.surface_files.stated_sizes import require_stated_sizes
from sonolube.measurement.surface_files.surface_reading import LIBRARY_DEFAULT, STATED_BY_FILE, SurfaceReading
from sonolube.measurement.surface_files.text_layout import text_readers

_HEAD_OF_LIBRARY = 512  # bytes from which its readers tell their formats
_TEXTS = ("xyz", "asc")
_BY_SUFFIX = ("hgt", "nms")  # formats that any bytes of a suitable number are
_TITLE_KEYS = ("Title", "DataSetName", "object_name")

UNIT_BY_LIBRARY = frozenset(  # as of version 1.27.1
    (
        *("al3d", "frt", "lext", "metropro", "nms", "opd", "os3d", "plu", "plux"),
        *("ps", "qep", "sdf", "tmd", "vk", "x3p", "zmg", "zon"),
    )
)
"""Formats whose lateral unit is a constant of SurfaceTopography's reader; the others state it in the file or not."""

_MISREAD = {"nms": "its lateral unit is misread by SurfaceTopography, and the version OM_MS_2.0, read here, is not it"}


@final
class SurfaceTopographyFormats:
    """All formats of the SurfaceTopography library: SUR, X3P, SDF, PLU, VK, AL3D, GWY, OPDx, MetroPro and more.

    Notes
    -----
    The fallback: the readers of SurfaceTopography are tried in their order, without those whose signature the file does
    not have. HGT and NMS have none and need their suffix; readers of text are tried where the text is a table.

    References
    ----------
    .. [1] M. C. Röttger et al., Surf. Topogr.: Metrol. Prop. 10, 035032 (2022). doi:10.1088/2051-672X/ac860a
    """

    name: ClassVar[str] = "SurfaceTopography"
    suffixes: ClassVar[tuple[str, ...]] = ()

    def recognises(self, head: bytes, path: Path) -> bool:
        """True: the library detects its formats itself."""
        return True

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Default channel of a file in any format of SurfaceTopography.

        Rows and columns as SurfaceTopography orders y and x. A profile becomes one row of square pixels, its heights
        interpolated at even steps where its positions are uneven.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the library's dependencies, about missing optional parts
            try:
                from SurfaceTopography.IO import readers
            except ImportError:
                raise missing_package("surfaces", context=str(path)) from None
            format_name = ""
            try:
                require_stated_sizes(path)
                reader = _opened(readers, path)
                format_name = str(reader.name())
                return _reading(reader, path=path)
            except InvalidInput:
                raise
            except Exception as failure:  # its readers raise exceptions of any type
                raise InvalidInput(f"{path}: {_cause(failure, format_name)}") from None


def _opened(readers: Sequence[Any], path: Path) -> Any:
    """First reader of the library that can open the file."""
    from SurfaceTopography.IO import MagicMatch

    with path.open("rb") as stream:
        head = stream.read(_HEAD_OF_LIBRARY)
    possible = [reader for reader in readers if reader.can_read(head) != MagicMatch.NO]
    texts = text_readers(path) if {*_TEXTS} & {reader.format() for reader in possible} else ()
    for reader in possible:
        name = reader.format()
        if name in _BY_SUFFIX and path.suffix.lower() != f".{name}":
            continue
        if name in _TEXTS and name not in texts:
            continue
        try:
            with redirect_stdout(io.StringIO()):  # readers of others' files print what they find
                return reader(str(path))
        except Exception:  # of any type where the file has another format
            continue
    if not texts and b"\0" not in head:
        raise InvalidInput(
            f"{path}: is no surface file by its signature, and as text no table of heights, whose lines are x z, x y z"
            " or rows of a matrix, with few others before them"
        )
    raise InvalidInput(f"{path}: damaged, or of no format of SurfaceTopography")


def _cause(failure: Exception, format_name: str) -> str:
    """Why the library fails on a file: its own sentence, or what an exception of its code without one means."""
    said = " ".join(str(failure).split())
    if said and not isinstance(failure, (LookupError, TypeError, AttributeError, AssertionError, UnicodeError)):
        return f"SurfaceTopography cannot read it: {said[:200]}"
    kind = f"{format_name} file" if format_name else "file"
    return (
        f"a damaged {kind}, or a variant of it that SurfaceTopography does not read (its reader stops with"
        f" {type(failure).__name__})"
    )


def _reading(reader: Any, *, path: Path) -> SurfaceReading:
    """Default channel of an open reader of the library."""
    known_as = str(reader.format())
    if known_as in _MISREAD:
        raise InvalidInput(f"{path}: looks like {reader.name()}: {_MISREAD[known_as]}")
    if not reader.channels:
        raise InvalidInput(f"{path}: SurfaceTopography takes it for {reader.name()}, but finds no heights in it")
    channel = reader.default_channel
    require_values(math.prod(channel.nb_grid_pts), path, part=f"{channel.nb_grid_pts} points")
    states_unit, states_size = channel.unit is not None, channel.physical_sizes is not None
    assumed: dict[str, Any] = {} if states_unit else {"unit": "m"}
    if not states_size:
        assumed["physical_sizes"] = channel.nb_grid_pts
    topography = reader.topography(channel_index=channel.index, **assumed).to_unit("m")
    height, spacing_x, spacing_y, notes = _heights(topography)
    info = topography.info
    return SurfaceReading(
        height=height,
        format_name=str(reader.name()),
        spacing_x=spacing_x if states_size else None,
        spacing_y=spacing_y if states_size else None,
        states_unit=states_unit,
        lateral_unit=str(channel.unit).replace("µ", "u") if states_unit else "",
        unit_origin=(LIBRARY_DEFAULT if known_as in UNIT_BY_LIBRARY else STATED_BY_FILE) if states_unit else "",
        title=next((str(found) for key in _TITLE_KEYS if (found := info.get("raw_metadata", {}).get(key))), ""),
        instrument=_instrument(info.get("instrument", {})),
        measured_at=_measured_at(info.get("acquisition_time")),
        notes=notes,
    )


def _heights(topography: Any) -> tuple[Floats, float, float, tuple[str, ...]]:
    """Heights of a topography or line scan with the distances of its columns and rows."""
    by_column = np.ma.filled(np.ma.asarray(topography.heights(), dtype=np.float64), np.nan)
    if not topography.is_uniform:
        row, step, notes = even_profile(np.asarray(topography.positions(), dtype=np.float64), by_column)
        return row, step, step, notes
    steps = np.atleast_1d(topography.pixel_size)
    return np.atleast_2d(by_column.T), float(steps[0]), float(steps[-1]), ()


def _instrument(known: dict[str, Any]) -> str:
    """Vendor, name and serial number of the instrument, as far as they are stated."""
    return " ".join(str(known[key]) for key in ("vendor", "name", "serial") if known.get(key))


def _measured_at(stated: Any) -> datetime | None:
    """Date without time zone; None for text that is no date and for the epoch, which stands for none."""
    try:
        moment = stated if isinstance(stated, datetime) else datetime.fromisoformat(str(stated))
    except ValueError:
        return None
    return None if moment.year <= 1970 else moment.replace(tzinfo=None)
