"""Answer of tasks whose result is one record of a rig: every field that is a quantity, with its unit."""

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any

from sonolube.report import Drawing
from sonolube.report.results.measured_on_rig import Measurement
from sonolube.rig import Rig
from sonolube.rig.datasets import LabelledArrays, result_quantities, result_texts
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer, si
from sonolube.text.units import format_quantity, format_si
from sonolube.vocabulary import quantities

_UNPRINTED = ("status", "amplitude_source")  # the amplitude's origin names the source
_MIN_FORCE = 1e-6  # of the load, below which a friction force means nothing
_LABELS = {"amplitude_origin": "amplitude", "energy_balance": "energy"}


@answer
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
    leading : sequence of str
        Caveats that stand above the result.
    rows : sequence of tuple of str
        Further names and texts.
    entries : mapping of str to object
        Further entries for JSON.
    drawings : mapping of str to Drawing
    datasets : mapping of str to xarray.Dataset or LabelledArrays
    """

    rig: Rig
    result: Any
    measured: Sequence[Measurement] = ()
    leading: Sequence[str] = ()
    rows: Sequence[tuple[str, str]] = ()
    entries: Mapping[str, Any] = field(default_factory=dict)
    drawings: Mapping[str, Drawing] = field(default_factory=dict)
    datasets: "Mapping[str, Dataset | LabelledArrays]" = field(default_factory=dict)

    def blocks(self) -> Sequence[Block]:
        """Load, quantities with the meaning and unit of the vocabulary, and text but for the status."""
        known, values = quantities(), result_quantities(self.result)
        rows = [
            (known[name].meaning, self._text(name, value))
            for name, value in values.items()
            if not name.startswith("raw_")  # for JSON, as is what it is
        ]
        rows += [
            (_LABELS.get(name, name.replace("_", " ")), text)
            for name, text in result_texts(self.result).items()
            if name not in _UNPRINTED
        ]
        rows += [(f"measured {one.label}", one.text) for one in self.measured]
        return [f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}", Rows([*rows, *self.rows])]

    def object(self) -> dict[str, Any]:
        """Title of the rig, text and quantities."""
        content = {"rig": self.rig.title, **result_texts(self.result), **si(result_quantities(self.result))}
        content |= self.entries
        return content | {"measured": [one.object() for one in self.measured]} if self.measured else content

    def caveats(self) -> Sequence[str]:
        """Caveats of the record."""
        caveats: Sequence[str] = self.result.caveats
        return caveats

    def leading_caveats(self) -> Sequence[str]:
        """Caveats that question the whole record."""
        return self.leading

    def figures(self) -> Mapping[str, Drawing]:
        """Figures of the record."""
        return self.drawings

    def files(self) -> "Mapping[str, Dataset | LabelledArrays]":
        """Datasets of the record."""
        return self.datasets

    def _text(self, name: str, value: float | None) -> str:
        """Quantity as text; a force that is nothing beside the load is said to be so."""
        least, unit = _MIN_FORCE * self.rig.normal_load, quantities()[name].unit
        if unit == "N" and value is not None and 0 < abs(value) < least:
            return f"below {format_si(least, unit)}"
        return "none" if value is None else format_quantity(value, name)
