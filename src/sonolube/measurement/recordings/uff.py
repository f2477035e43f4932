"""Universal files (UFF), data set 58: what vibrometers and modal software export."""

from pathlib import Path
from typing import Any

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, refuse_library_errors

FORMAT = "universal file"
_TIME_RESPONSE = 1


def read_universal_file(path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
    """Return the time responses of a universal file.

    Parameters
    ----------
    path : Path
        Of the file.
    mapping : RecordingMapping or None
        Not needed here: responses are all read.

    Returns
    -------
    Table
        Labels are those of the ordinate, or of the response's node and direction where it has none.

    Raises
    ------
    InvalidInput
        Naming the file, if it cannot be read, holds no time response, or one of uneven spacing beside others.
    """
    import pyuff

    with refuse_library_errors(path, format_name=FORMAT):
        file = pyuff.UFF(str(path))
        types = np.atleast_1d(file.get_set_types())
        sets = [file.read_sets(int(index)) for index in np.flatnonzero(types == 58)]
        responses = [
            data for data in sets if data["func_type"] in (0, _TIME_RESPONSE) and not np.iscomplexobj(data["data"])
        ]
        columns = [_column(data, responses) for data in responses]
    if not columns:
        raise InvalidInput(f"{path}: holds no time response (data set 58, function type 1)")
    for data in responses:
        if len(data["data"]) != data["num_pts"]:
            raise InvalidInput(f"{path}: a response of {data['num_pts']} values has {len(data['data'])}")
    uneven = [data for data in responses if data["abscissa_spacing"] == 0]
    if uneven and len(responses) > 1:
        raise InvalidInput(f"{path}: responses of uneven spacing must each have a file of their own")
    if uneven:
        columns.insert(0, RawColumn(label="time", values=np.asarray(uneven[0]["x"], dtype=np.float64), unit="s"))
    return RawTable(columns=tuple(columns), format=FORMAT)


def _column(data: dict[str, Any], every: list[dict[str, Any]]) -> RawColumn:
    label = _text(data, "ordinate_axis_lab")
    if not label or sum(_text(other, "ordinate_axis_lab") == label for other in every) > 1:
        label = f"{label or 'response'} node {data['rsp_node']} direction {data['rsp_dir']}"
    unit = _text(data, "ordinate_axis_units_lab")
    even = data["abscissa_spacing"] == 1
    return RawColumn(
        label=label,
        values=np.asarray(data["data"], dtype=np.float64),
        unit=unit or None,
        start=float(data["abscissa_min"]) if even else None,
        interval=float(data["abscissa_inc"]) if even else None,
    )


def _text(data: dict[str, Any], key: str) -> str:
    text = str(data.get(key, "")).strip()
    return "" if text.upper() in ("NONE", "NO NAME") else text
