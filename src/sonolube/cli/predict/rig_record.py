"""Answer of commands whose result is one record of a rig: every field that is a quantity, with its unit."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from math import isnan
from typing import Any

import xarray as xr

from sonolube.cli.console.answer import Answer, aligned, si
from sonolube.cli.predict.measured import Measurement
from sonolube.report import Drawing
from sonolube.rig import Rig
from sonolube.units import format_si
from sonolube.vocabulary import quantities

_UNPRINTED = ("status", "amplitude_source")  # the amplitude's origin names the source
_LABELS = {"amplitude_origin": "amplitude", "energy_balance": "energy"}


@dataclass(frozen=True, kw_only=True)
class RigRecord(Answer):
    """Record of results of a rig: quantities by the vocabulary, other text as it is.

    Parameters
    ----------
    rig : Rig
    result : dataclass
        Its fields named in the vocabulary, and those of records within it, are the quantities; None is left out, NaN
        stands for a value outside the range of a model, null in JSON.
    measured : sequence of Measurement
        What was measured on the rig under the same conditions.
    drawings : mapping of str to Drawing
    datasets : mapping of str to xarray.Dataset
    """

    rig: Rig
    result: Any
    measured: Sequence[Measurement] = ()
    drawings: Mapping[str, Drawing] = field(default_factory=dict)
    datasets: Mapping[str, xr.Dataset] = field(default_factory=dict)

    def lines(self) -> list[str]:
        """Load, quantities with the meaning and unit of the vocabulary, and text but for the status."""
        known, values = quantities(), self._values()
        values = [(name, value) for name, value in values if not name.startswith("raw_")]  # for JSON, as is what it is
        rows = [
            (known[name].meaning, "none" if value is None else format_si(value, known[name].unit))
            for name, value in values
        ]
        rows += [
            (_LABELS.get(name, name.replace("_", " ")), text) for name, text in self._texts() if name not in _UNPRINTED
        ]
        rows += [(f"measured {one.label}", one.text) for one in self.measured]
        return [f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}", *aligned(rows)]

    def object(self) -> dict[str, Any]:
        """Title of the rig, text and quantities."""
        content = {"rig": self.rig.title, **dict(self._texts()), **si(dict(self._values()))}
        return content | {"measured": [one.object() for one in self.measured]} if self.measured else content

    def caveats(self) -> Sequence[str]:
        """Caveats of the record."""
        caveats: Sequence[str] = self.result.caveats
        return caveats

    def figures(self) -> Mapping[str, Drawing]:
        """Figures of the record."""
        return self.drawings

    def files(self) -> Mapping[str, xr.Dataset]:
        """Datasets of the record."""
        return self.datasets

    def _values(self) -> list[tuple[str, float | None]]:
        """Fields that are quantities of the vocabulary, with their values in SI; None outside the range of a model."""
        fields = _flat(self.result).items()
        return [
            (name, None if isnan(value) else value)
            for name, value in fields
            if name in quantities() and isinstance(value, int | float)
        ]

    def _texts(self) -> list[tuple[str, str]]:
        """Fields that are text, such as the friction model."""
        return [(name, value) for name, value in _flat(self.result).items() if isinstance(value, str)]


def _flat(record: Any) -> dict[str, Any]:
    """Fields of a record by name, and those of records within it; of one name the outermost."""
    own = {each.name: getattr(record, each.name) for each in fields(record)}
    values: dict[str, Any] = {}
    for value in own.values():
        values |= _flat(value) if is_dataclass(value) else {}
    return values | {name: value for name, value in own.items() if not is_dataclass(value)}
