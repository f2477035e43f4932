"""All formats of the SurfaceTopography library, with the extra ``surfaces``."""

import math
import warnings
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Any, BinaryIO, ClassVar, final

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.limits import require_values
from sonolube.measurement.surface_files.stated_sizes import require_stated_sizes
from sonolube.measurement.surface_files.surface_reading import SurfaceReading
from sonolube.measurement.surface_files.text_layout import text_readers

_HEAD_OF_LIBRARY = 512  # bytes from which its readers tell their formats
_TEXTS = ("xyz", "asc")
_BY_SUFFIX = ("hgt", "nms")  # formats that any bytes of a suitable number are
_TITLE_KEYS = ("Title", "DataSetName", "object_name")


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
        """Return True: the library detects its formats itself."""
        return True

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Return the default channel of a file in any format of SurfaceTopography.

        Parameters
        ----------
        stream : binary file
            Not used: the library opens the file by its path.
        path : Path
            Of the file.

        Returns
        -------
        SurfaceReading
            Rows and columns as SurfaceTopography orders y and x. A profile becomes one row of square pixels.

        Raises
        ------
        InvalidInput
            If the library is not installed, does not recognise the format, or fails on the file, or the file states
            to hold more points than one of its size may.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the library's dependencies, about missing optional parts
            try:
                from SurfaceTopography.IO import readers
            except ImportError:
                raise InvalidInput(
                    f"{path}: neither Wyko OPD, NPY nor XYZ text; for other formats: "
                    'pip install "sonolube[surfaces]", which brings SurfaceTopography'
                ) from None
            try:
                require_stated_sizes(path)
                return _reading(_opened(readers, path), path=path)
            except InvalidInput:
                raise
            except Exception as failure:  # its readers raise exceptions of any type
                cause = " ".join(str(failure).split()) or type(failure).__name__
                raise InvalidInput(f"{path}: SurfaceTopography cannot read it: {cause[:200]}") from None


def _opened(readers: Sequence[Any], path: Path) -> Any:
    """Return the first reader of the library that can open the file."""
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
            return reader(str(path))
        except Exception:  # of any type where the file has another format
            continue
    raise InvalidInput(f"{path}: damaged, or of no format of SurfaceTopography")


def _reading(reader: Any, *, path: Path) -> SurfaceReading:
    """Return the default channel of an open reader of the library."""
    channel = reader.default_channel
    require_values(math.prod(channel.nb_grid_pts), path, part=f"{channel.nb_grid_pts} points")
    states_unit, states_size = channel.unit is not None, channel.physical_sizes is not None
    assumed: dict[str, Any] = {} if states_unit else {"unit": "m"}
    if not states_size:
        assumed["physical_sizes"] = channel.nb_grid_pts
    topography = reader.topography(channel_index=channel.index, **assumed).to_unit("m")
    if not topography.is_uniform:
        raise InvalidInput(f"{path}: a profile of uneven steps, which makes no height map")
    by_column = np.ma.filled(np.ma.asarray(topography.heights(), dtype=np.float64), np.nan)
    steps = np.atleast_1d(topography.pixel_size)
    info = topography.info
    return SurfaceReading(
        height=np.atleast_2d(by_column.T),
        format_name=str(reader.name()),
        spacing_x=float(steps[0]) if states_size else None,
        spacing_y=float(steps[-1]) if states_size else None,
        states_unit=states_unit,
        title=next((str(found) for key in _TITLE_KEYS if (found := info.get("raw_metadata", {}).get(key))), ""),
        instrument=_instrument(info.get("instrument", {})),
        measured_at=_measured_at(info.get("acquisition_time")),
    )


def _instrument(known: dict[str, Any]) -> str:
    """Return vendor, name and serial number of the instrument, as far as they are stated."""
    return " ".join(str(known[key]) for key in ("vendor", "name", "serial") if known.get(key))


def _measured_at(stated: Any) -> datetime | None:
    """Return a date without time zone; None for text that is no date and for the epoch, which stands for none."""
    try:
        moment = stated if isinstance(stated, datetime) else datetime.fromisoformat(str(stated))
    except ValueError:
        return None
    return None if moment.year <= 1970 else moment.replace(tzinfo=None)
