"""Universal files (UFF), data set 58, as vibrometers and modal analysis software export them."""

from collections import Counter
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.limits import require_channels
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, refuse_library_errors

_TIME_TYPES = (0, 1)  # function types of data set 58: general, and time response


@final
class UniversalFile:
    """Universal files (UFF) with time responses in data set 58."""

    name: ClassVar[str] = "universal file"
    suffixes: ClassVar[tuple[str, ...]] = (".uff", ".unv")

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the first line is the delimiter -1 and the second the number of a data set."""
        lines = [line.strip() for line in head.splitlines()[:2]]
        return lines[:1] == [b"-1"] and len(lines) > 1 and lines[1][:6].split(b"b")[0].strip().isdigit()

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Time responses of a universal file.

        Labels are those of the ordinate, or node and direction of the response where it has none.
        """
        import pyuff

        with refuse_library_errors(path, format_name=self.name):
            file = pyuff.UFF(str(path))
            types = np.atleast_1d(file.get_set_types())
            functions = np.flatnonzero(types == 58)
            require_channels(functions.size, path, kind="data sets")
            sets = [file.read_sets(int(index)) for index in functions]
            responses = [one for one in sets if one["func_type"] in _TIME_TYPES and not np.iscomplexobj(one["data"])]
            labels = Counter(_text(data, "ordinate_axis_lab") for data in responses)
            columns = [_column(data, labels) for data in responses]
        if not columns:
            raise InvalidInput(f"{path}: holds no time response (data set 58, function type 1)")
        for data in responses:
            if len(data["data"]) != data["num_pts"]:
                raise InvalidInput(f"{path}: a response of {data['num_pts']} values has {len(data['data'])}")
        uneven = [data for data in responses if data["abscissa_spacing"] == 0]
        if uneven and len(responses) > 1:
            raise InvalidInput(f"{path}: unevenly sampled responses must each have a file of their own")
        if uneven:
            columns.insert(0, RawColumn(label="time", values=np.asarray(uneven[0]["x"], dtype=np.float64), unit="s"))
        return RawTable(columns=tuple(columns), format_name=self.name)


def _column(data: dict[str, Any], labels: Counter[str]) -> RawColumn:
    """Column of one response, labelled uniquely among all responses."""
    label = _text(data, "ordinate_axis_lab")
    if not label or labels[label] > 1:
        label = f"{label or 'response'} node {data['rsp_node']} direction {data['rsp_dir']}"
    unit = _text(data, "ordinate_axis_units_lab")
    evenly_sampled = data["abscissa_spacing"] == 1
    return RawColumn(
        label=label,
        values=np.asarray(data["data"], dtype=np.float64),
        unit=unit or None,
        start=float(data["abscissa_min"]) if evenly_sampled else None,
        interval=float(data["abscissa_inc"]) if evenly_sampled else None,
    )


def _text(data: dict[str, Any], key: str) -> str:
    """Text field; empty for the placeholders NONE and NO NAME."""
    text = str(data.get(key, "")).strip()
    return "" if text.upper() in ("NONE", "NO NAME") else text
