"""Predicted friction ratios and verdicts beside those of the friction model, over the points of a result."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE
from sonolube.prediction.predicted_points import PredictedRig
from sonolube.prediction.verdict import VERDICTS
from sonolube.rig import STATUSES, PointBatch
from sonolube.rig.datasets import labels

if TYPE_CHECKING:
    import xarray as xr

_OPERATING = {"drive.frequency": "frequency", "sliding.sliding_speed": "sliding_speed"}


def column_labels(name: str) -> dict[str, Any]:
    """Attributes of a column of `PredictedRig.columns`."""
    if name != "verdict":
        return labels(name)
    flags = {"flag_values": np.arange(len(VERDICTS), dtype=np.int8), "flag_meanings": " ".join(VERDICTS)}
    return {"long_name": "Standing of the point between model, published tests and own runs"} | flags


def with_predictions(points: "xr.Dataset", predicted: PredictedRig) -> "xr.Dataset":
    """Study or map with the predicted friction ratio and the verdict of each point.

    Parameters
    ----------
    points : xarray.Dataset
        With `status` in words and `vibration_amplitude`, and perhaps `frequency` and `sliding_speed`.
    predicted : PredictedRig
        Of their rig.

    Returns
    -------
    xarray.Dataset
        With the columns of `PredictedRig.columns`.
    """
    return _assigned(points, predicted.columns(**_operating(points)))


def with_verdicts(points: "xr.Dataset", predicted: PredictedRig) -> "xr.Dataset":
    """Study or map with the verdict of each point alone, as `with_predictions` has it."""
    return _assigned(points, {"verdict": predicted.verdicts(**_operating(points))})


def _operating(points: "xr.Dataset") -> dict[str, NDArray[Any]]:
    """Amplitude, and frequency and sliding speed where they vary, of each point; and whether it left the model."""
    status = points["status"]
    at = {
        name: points[name].broadcast_like(status).transpose(*status.dims).values
        for name in ("vibration_amplitude", "frequency", "sliding_speed")
        if name in points.variables
    }
    return at | {"outside_model": status.values == OUTSIDE_MODEL_RANGE}


def _assigned(points: "xr.Dataset", found: Mapping[str, NDArray[Any]]) -> "xr.Dataset":
    """Dataset with columns over its points."""
    dims = points["status"].dims
    return points.assign({name: (dims, values, column_labels(name)) for name, values in found.items()})


class PredictedColumns:
    """Columns of a sweep with the predicted friction ratio and the verdict of each point.

    Parameters
    ----------
    predicted : PredictedRig
        Of the rig whose operating conditions are swept.
    """

    def __init__(self, predicted: PredictedRig) -> None:
        self._predicted = predicted
        self.labels = {name: column_labels(name) for name in predicted.named_columns}

    def of(self, rows: Mapping[str, NDArray[Any]], batch: PointBatch) -> Mapping[str, NDArray[Any]]:
        """Columns of some points with the values of the swept keys."""
        at = {name: rows[key] for key, name in _OPERATING.items() if key in rows}
        outside = batch.status == STATUSES.index(OUTSIDE_MODEL_RANGE)
        amplitude = batch.numbers["vibration_amplitude"]
        return self._predicted.columns(vibration_amplitude=amplitude, **at, outside_model=outside)
