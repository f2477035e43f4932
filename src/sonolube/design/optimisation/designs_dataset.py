"""Labelled dataset of all designs of a screening, and the number of them that each limit rules out."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sonolube import __version__
from sonolube.design.optimisation.evaluation import LIMITS
from sonolube.design.optimisation.optimum import Optimum
from sonolube.rig.datasets import labels

if TYPE_CHECKING:
    import xarray as xr


def designs_dataset(optimum: Optimum) -> "xr.Dataset":
    """All designs of a screening with their objectives and the fraction of each limit that they use; over `design`."""
    import xarray as xr

    screened, space = optimum.screening, optimum.problem.space

    def by_design(of_candidates: list[Any]) -> NDArray[Any]:
        return np.array(of_candidates)[screened.candidate_index]

    columns = {
        "frequency": screened.frequency,
        "voltage_peak_to_peak": screened.voltage_peak_to_peak,
        "actuator_power": screened.objectives["power"],
        "heat_rate": screened.objectives["heat"],
        **{name: by_design([each.entries[name] for each in screened.candidates]) for name in space.ranges},
    }
    data: dict[str, Any] = {name: ("design", values, labels(name)) for name, values in columns.items()}
    data["actuator"] = ("design", by_design([each.actuator for each in screened.candidates]))
    data["waveform"] = ("design", by_design([each.waveform for each in screened.candidates]))
    for name, text in LIMITS.items():
        used = {"units": "1", "long_name": f"Share used: {text}"}
        data[f"used_{name}"] = ("design", screened.utilisation[name], used)
    data["feasible"] = ("design", screened.feasible.astype(np.int8), {"long_name": "Whether it keeps to every limit"})
    return xr.Dataset(
        data,
        attrs={
            "title": f"Designs for a friction ratio of {optimum.problem.friction_ratio:.4g}, {space.rig.title}",
            "source": f"sonolube {__version__}",
            "friction_model": space.rig.friction_model.name,
        },
    )


def design_counts(optimum: Optimum) -> dict[str, int]:
    """Number of screened designs within all limits, out of reach, and beyond each limit that rules out any.

    By status; a design beyond two limits counts for both.
    """
    screened = optimum.screening
    reached = np.isfinite(screened.voltage_peak_to_peak)
    beyond = {text: int((screened.utilisation[name][reached] > 1).sum()) for name, text in LIMITS.items()}
    return {
        "within all limits": int(screened.feasible.sum()),
        "target friction not reached by any voltage": int((~reached).sum()),
        **{f"beyond the limit on {text}": count for text, count in beyond.items() if count},
    }
