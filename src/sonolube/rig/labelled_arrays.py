"""Labelled arrays: what an xarray dataset holds, without xarray, whose import takes longer than an operating point."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray as xr


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
        """Return a variable or coordinate by its name."""
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
        """Return the same arrays with further attributes."""
        return replace(self, attrs={**self.attrs, **attrs})

    def dataset(self) -> "xr.Dataset":
        """Return the arrays as an xarray dataset."""
        import xarray as xr

        return xr.Dataset(
            {name: (each.dims, each.values, dict(each.attrs)) for name, each in self.variables.items()},
            coords={name: (each.dims, each.values, dict(each.attrs)) for name, each in self.coordinates.items()},
            attrs=dict(self.attrs),
        )

    def netcdf(self) -> bytes:
        """Return the content of a netCDF file, with fill values and dimensions as xarray writes them."""
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
