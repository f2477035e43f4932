"""Fields of records for JSON, quantities as datasets, and rigs as text."""

from collections.abc import Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any

from sonolube.text.units import format_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.rig import Rig


def picked(record: object, *names: str) -> dict[str, Any]:
    """Fields of a record by name, in the order of the names."""
    return {name: getattr(record, name) for name in names}


def finite(value: float) -> float | None:
    """Value as a plain number, or None where JSON has no notation for it."""
    return float(value) if isfinite(value) else None


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


def friction_model_text(rig: "Rig") -> str:
    """Friction model of a rig as text, such as "friction model kinematic"."""
    return f"friction model {rig.friction_model.name}"


def operating_point(rig: "Rig") -> str:
    """Title, load, speed and friction model of a rig as one line."""
    load, speed = format_si(rig.normal_load, "N"), format_si(rig.sliding_speed, "m/s")
    return f"{rig.title}, {load}, {speed}, {friction_model_text(rig)}"


def rig_settings(rig: "Rig") -> list[tuple[str, str]]:
    """Rig of a page: title, file, source, load, speed, friction without vibration, friction model and amplitude."""
    return [
        ("rig", rig.title if rig.file is None else f"{rig.title} ({rig.file.name})"),
        *([("source of its numbers", rig.source)] if rig.source else []),
        ("load and speed", f"{format_si(rig.normal_load, 'N')}, {format_si(rig.sliding_speed, 'm/s')}"),
        ("without vibration", f"coefficient of friction {rig.friction_coefficient:.3g}"),
        ("friction model", rig.friction_model.name),
        *amplitude_rows(rig),
    ]


def amplitude_object(rig: "Rig") -> dict[str, str]:
    """Source of a rig's amplitude and the same in words, for JSON; empty where the rig has none."""
    from sonolube.rig import amplitude_labels

    return amplitude_labels(rig)


def amplitude_rows(rig: "Rig") -> list[tuple[str, str]]:
    """The same as rows of text."""
    return [("amplitude", text) for name, text in amplitude_object(rig).items() if name == "amplitude_origin"]
