"""Results as labelled arrays, xarray datasets and netCDF files; quantities and texts of a record of results.

Labelled arrays hold what an xarray dataset does, without xarray, whose import takes longer than an operating point.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from io import BytesIO
from math import isnan
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sonolube import __version__
from sonolube.checks import Floats
from sonolube.storage.files import write_atomically
from sonolube.vocabulary import quantities, quantity

if TYPE_CHECKING:
    import xarray as xr

Dataset: TypeAlias = "xr.Dataset"
"""Labelled dataset, by a name that needs no import of xarray."""

PREDICTED_RATIO: Final = ("lowest_predicted_ratio", "predicted_friction_ratio", "highest_predicted_ratio")
"""Variables over points that hold the predicted friction ratio: lower end of the 80 % interval, median, upper end."""

PREDICTED_FORCE: Final = ("lowest_predicted_force", "predicted_friction_force", "highest_predicted_force")
"""Variables over points that hold the predicted friction force: lower end of the 80 % interval, median, upper end."""

_NOTHING: Mapping[str, str] = MappingProxyType({})
_TEXTS = {
    "status": "Status of the point",
    "reason": "Meaning of the status, and advice",
    "waveform": "Shape of the drive voltage",
}


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class LabelledArray:
    """An array with names of its axes and attributes.

    Parameters
    ----------
    dims : tuple of str
        Names of its axes.
    values : ndarray
        Numbers or texts.
    attrs : mapping of str to str
        Such as its units.
    """

    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: Mapping[str, str] = field(default_factory=dict)

    def to_numpy(self) -> NDArray[Any]:
        """Values, by the name that xarray has for them."""
        return self.values


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class LabelledArrays:
    """Variables over coordinates with attributes, which become an xarray dataset or a netCDF file.

    Parameters
    ----------
    variables, coordinates : mapping of str to LabelledArray
        By name; a coordinate runs along the axis of its name.
    attrs : mapping of str to object
        Texts and numbers.
    """

    variables: Mapping[str, LabelledArray]
    coordinates: Mapping[str, LabelledArray]
    attrs: Mapping[str, Any]

    def __getitem__(self, name: str) -> LabelledArray:
        """Variable or coordinate by its name."""
        return self.variables[name] if name in self.variables else self.coordinates[name]

    def __contains__(self, name: str) -> bool:
        """Whether there is a variable or coordinate of this name."""
        return name in self.variables or name in self.coordinates

    @property
    def sizes(self) -> dict[str, int]:
        """Number of points along each axis."""
        return {
            name: size
            for each in (*self.variables.values(), *self.coordinates.values())
            for name, size in zip(each.dims, each.values.shape, strict=True)
        }

    def assign_attrs(self, **attrs: Any) -> "LabelledArrays":
        """Same arrays with further attributes."""
        return replace(self, attrs={**self.attrs, **attrs})

    def dataset(self) -> "xr.Dataset":
        """Arrays as an xarray dataset."""
        import xarray as xr

        return xr.Dataset(
            {name: (each.dims, each.values, dict(each.attrs)) for name, each in self.variables.items()},
            coords={name: (each.dims, each.values, dict(each.attrs)) for name, each in self.coordinates.items()},
            attrs=dict(self.attrs),
        )

    def netcdf(self) -> bytes:
        """Content of a netCDF file, with fill values and dimensions as xarray writes them."""
        import h5netcdf
        from h5py import string_dtype

        content = BytesIO()
        with h5netcdf.File(content, "w") as file:
            file.dimensions = self.sizes
            for name, each in {**self.variables, **self.coordinates}.items():
                floating = np.issubdtype(each.values.dtype, np.floating)
                is_text = each.values.dtype.kind == "U"
                variable = file.create_variable(
                    name,
                    each.dims,
                    dtype=string_dtype() if is_text else each.values.dtype,
                    fillvalue=each.values.dtype.type(np.nan) if floating else None,
                )
                variable[...] = each.values.astype(object) if is_text else each.values
                variable.attrs.update(each.attrs)
            file.attrs.update(self.attrs)
        return content.getvalue()


def dataset(values: Mapping[str, Floats], *, along: str, title: str) -> "xr.Dataset":
    """Arrays of one length as a dataset, each with units and long names of the vocabulary.

    Parameters
    ----------
    values : mapping of str to ndarray
        Arrays by their names in the vocabulary, one of which is the coordinate.
    along : str
        Name of that coordinate.
    title : str
        Title of the dataset.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    UnknownName
        If a name is not in the vocabulary.
    """
    return labelled(values, along=along, title=title).dataset()


def labelled(values: Mapping[str, Floats], *, along: str, title: str) -> LabelledArrays:
    """Variables, attributes and coordinates of `dataset`, without xarray."""
    others = {name: array for name, array in values.items() if name != along}
    return _labelled_grid(others, axes={along: values[along]}, title=title, about=_NOTHING)


def gridded(
    values: Mapping[str, NDArray[Any]],
    *,
    axes: Mapping[str, NDArray[Any]],
    title: str,
    about: Mapping[str, str] = _NOTHING,
) -> "xr.Dataset":
    """Arrays over a grid as a dataset, each with units and long names of the vocabulary.

    Parameters
    ----------
    values : mapping of str to ndarray
        Arrays by their names: quantities of the vocabulary, or texts about the points. An array of n axes runs over the
        first n of the grid.
    axes : mapping of str to ndarray
        Coordinates of the grid, in the order of its axes.
    title : str
        Title of the dataset.
    about : mapping of str to str
        Further attributes.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    UnknownName
        If a name is not in the vocabulary.
    """
    return _labelled_grid(values, axes=axes, title=title, about=about).dataset()


def labels(name: str) -> dict[str, str]:
    """Attributes of a variable of a dataset: unit and meaning of the quantity of its name."""
    if name in _TEXTS:
        return {"long_name": _TEXTS[name]}
    known = quantity(name)
    return {"units": known.unit or "1", "long_name": known.meaning}


def write_netcdf(results: "xr.Dataset | LabelledArrays", *, path: Path) -> Path:
    """Write a dataset as netCDF, whole or not at all.

    Raises
    ------
    InvalidInput
        If the place cannot be written to.
    """
    if isinstance(results, LabelledArrays):
        return write_atomically(path, results.netcdf())
    return write_atomically(path, bytes(results.to_netcdf(engine="h5netcdf")))


def _labelled_grid(
    values: Mapping[str, NDArray[Any]], *, axes: Mapping[str, NDArray[Any]], title: str, about: Mapping[str, str]
) -> LabelledArrays:
    """Arrays over a grid with units and long names."""
    names = tuple(axes)
    return LabelledArrays(
        variables={
            name: LabelledArray(dims=names[: array.ndim], values=array, attrs=labels(name))
            for name, array in values.items()
        },
        coordinates={
            name: LabelledArray(dims=(name,), values=array, attrs=labels(name)) for name, array in axes.items()
        },
        attrs={"title": title, "source": f"sonolube {__version__}", **about},
    )


def result_quantities(record: Any) -> dict[str, float | None]:
    """Fields of a record that are quantities of the vocabulary, in SI.

    None for values outside the range of a model; fields that are not known are left out.
    """
    known = quantities()
    return {
        name: None if isnan(value) else value
        for name, value in _flat(record).items()
        if name in known and isinstance(value, int | float)
    }


def result_texts(record: Any) -> dict[str, str]:
    """Fields of a record that are text, such as the friction model."""
    return {name: value for name, value in _flat(record).items() if isinstance(value, str)}


def _flat(record: Any) -> dict[str, Any]:
    """Fields of a record by name, and those of records within it; of one name the outermost."""
    own = {each.name: getattr(record, each.name) for each in fields(record)}
    values: dict[str, Any] = {}
    for name, value in own.items():
        if is_dataclass(value):
            values |= {key: inner for key, inner in _flat(value).items() if key not in own}
        else:
            values[name] = value
    return values
