"""Results as labelled datasets, and as netCDF files."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube import __version__
from sonolube.checks import Floats
from sonolube.files import write_whole
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr


def dataset(values: Mapping[str, Floats], *, along: str, title: str) -> "xr.Dataset":
    """Return arrays of one length as a dataset, each with the unit and the meaning of the vocabulary.

    Parameters
    ----------
    values : mapping of str to ndarray
        Arrays by their names in the vocabulary, one of which is the coordinate.
    along : str
        Name of that coordinate.
    title : str
        What the dataset holds.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    UnknownName
        If a name is not in the vocabulary.
    """
    import xarray as xr

    def labelled(name: str) -> "tuple[str, Floats, dict[str, str]]":
        known = quantity(name)
        return along, values[name], {"units": known.unit or "1", "long_name": known.meaning}

    return xr.Dataset(
        {name: labelled(name) for name in values if name != along},
        coords={along: labelled(along)},
        attrs={"title": title, "source": f"sonolube {__version__}"},
    )


def write_netcdf(results: "xr.Dataset", *, path: Path) -> Path:
    """Write a dataset as netCDF, whole or not at all.

    Raises
    ------
    InvalidInput
        If the place cannot be written to.
    """
    return write_whole(path, bytes(results.to_netcdf(engine="h5netcdf")))
