"""The many formats that the SurfaceTopography library reads, behind the extra ``surfaces``."""

import warnings
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.surface_reading import SurfaceReading

_TITLES = ("Title", "DataSetName", "object_name")


def read_with_surface_topography(path: Path) -> SurfaceReading:
    """Read the default channel of a file in any format that SurfaceTopography knows.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    SurfaceReading
        Rows and columns as SurfaceTopography orders y and x. A profile becomes one row of square pixels.

    Raises
    ------
    InvalidInput
        If the library is not installed, knows no such format, or fails on the file.

    References
    ----------
    .. [1] M. C. Röttger et al., Surf. Topogr.: Metrol. Prop. 10, 035032 (2022). doi:10.1088/2051-672X/ac860a
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of its dependencies, about what they lack
        try:
            import SurfaceTopography
            from SurfaceTopography.Exceptions import CannotDetectFileFormat
        except ImportError:
            raise InvalidInput(
                f"{path}: neither Wyko OPD, NPY nor XYZ text; for other formats: "
                'pip install "sonolube[surfaces]", which brings SurfaceTopography'
            ) from None
        try:
            return _reading(SurfaceTopography.open_topography(str(path)), path=path)
        except InvalidInput:
            raise
        except CannotDetectFileFormat:
            raise InvalidInput(f"{path}: damaged, or of no format that SurfaceTopography knows") from None
        except Exception as failure:  # its readers let errors of any kind through
            cause = " ".join(str(failure).split()) or type(failure).__name__
            raise InvalidInput(f"{path}: SurfaceTopography cannot read it: {cause[:200]}") from None


def _reading(reader: Any, *, path: Path) -> SurfaceReading:
    channel = reader.default_channel
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
        title=next((str(found) for key in _TITLES if (found := info.get("raw_metadata", {}).get(key))), ""),
        instrument=_instrument(info.get("instrument", {})),
        measured_at=_moment(info.get("acquisition_time")),
    )


def _instrument(known: dict[str, Any]) -> str:
    return " ".join(str(known[key]) for key in ("vendor", "name", "serial") if known.get(key))


def _moment(given: Any) -> datetime | None:
    """Return a date as one without zone; None for text that is no date and for the epoch that stands for none."""
    try:
        moment = given if isinstance(given, datetime) else datetime.fromisoformat(str(given))
    except ValueError:
        return None
    return None if moment.year <= 1970 else moment.replace(tzinfo=None)
