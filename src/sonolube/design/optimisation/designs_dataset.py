"""Labelled dataset of all designs of a screening, and the number of them that each limit rules out."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube import __version__
from sonolube.design.optimisation.optimum import Optimum
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

LIMITS: Mapping[str, str] = MappingProxyType(
    {
        "stack_voltage": "voltage the stack bears",
        "voltage": "voltage of the amplifier",
        "current": "current of the amplifier",
        "slew_rate": "slew rate of the amplifier",
        "tension": "tension in the stack",
        "contact_pressure": "stress in the contact",
        "horn_stress": "stress in the horn",
        "temperature": "warming of the actuator",
        "bolt_fatigue": "fatigue of the bolt",
        "bolt_yield": "yielding of the bolt",
    }
)
"""Printed name of each limit, by its name in `Assessment.utilisation`."""


def designs_dataset(optimum: Optimum) -> "xr.Dataset":
    """All designs of a screening with their objectives and the fraction of each limit that they use.

    Parameters
    ----------
    optimum : Optimum

    Returns
    -------
    xarray.Dataset
        Over `design`.
    """
    import xarray as xr

    screened, space = optimum.screening, optimum.problem.space
    columns = {
        "frequency": screened.frequency,
        "voltage_peak_to_peak": screened.voltage_peak_to_peak,
        "actuator_power": screened.objectives["power"],
        "heat_rate": screened.objectives["heat"],
        **{
            name: np.array([candidate.entries[name] for candidate in screened.candidates])[screened.candidate_index]
            for name in space.ranges
        },
    }
    data: dict[str, Any] = {
        name: ("design", values, {"units": quantity(name).unit, "long_name": quantity(name).meaning})
        for name, values in columns.items()
    }
    for name in ("actuator", "waveform"):
        data[name] = (
            "design",
            np.array([getattr(candidate, name) for candidate in screened.candidates])[screened.candidate_index],
        )
    for name, text in LIMITS.items():
        data[f"used_{name}"] = (
            "design",
            screened.utilisation[name],
            {"units": "1", "long_name": f"Share used: {text}"},
        )
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

    Parameters
    ----------
    optimum : Optimum

    Returns
    -------
    dict of str to int
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
