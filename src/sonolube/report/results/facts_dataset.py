"""Quantities of several things, such as materials, or of a JSON object, as a labelled dataset."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr


def facts_dataset(kind: str, values: Mapping[str, Mapping[str, float]], titles: Mapping[str, str]) -> "xr.Dataset":
    """Quantities of the vocabulary of several things, over their names; NaN where one is not known."""
    import numpy as np
    import xarray as xr

    known = quantities()
    names = dict.fromkeys(name for each in values.values() for name in each)
    variables = {
        name: (
            kind,
            np.array([each.get(name, np.nan) for each in values.values()]),
            {"units": known[name].unit, "long_name": known[name].meaning},
        )
        for name in names
    }
    return xr.Dataset(variables | {"title": (kind, list(titles.values()))}, coords={kind: list(values)})


def scalar_dataset(content: Mapping[str, Any]) -> "xr.Dataset":
    """Quantities and texts of a JSON object as a dataset of scalars."""
    import numpy as np
    import xarray as xr

    variables: dict[str, Any] = {}
    for name, each in content.items():
        if isinstance(each, Mapping) and set(each) == {"value", "unit"}:
            value = np.nan if each["value"] is None else each["value"]
            variables[name] = ((), value, {"units": each["unit"], "long_name": name.replace("_", " ")})
    return xr.Dataset(variables, attrs={name: each for name, each in content.items() if isinstance(each, str)})
