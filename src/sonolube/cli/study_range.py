"""From the words of the command `study` to the study itself."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.rig import (
    Rig,
    frequency_grid,
    frequency_study,
    least_power_study,
    load_study,
    operating_points,
    speed_study,
    voltage_study,
    waveform_study,
)
from sonolube.rig.driven_rig import driven_rig
from sonolube.rig.linear_response import gap_law_of
from sonolube.units import to_si

if TYPE_CHECKING:
    import xarray as xr

_CROWDED = 41  # frequencies at each resonance


@dataclass(frozen=True, kw_only=True, slots=True)
class _Range:
    """What a study runs over unless asked otherwise."""

    unit: str
    lowest: str
    highest: str
    points: int
    spacing: Callable[..., Floats]
    from_zero: bool = False


_RANGES = {
    "voltage": _Range(unit="V", lowest="0V", highest="200V", points=101, spacing=np.linspace, from_zero=True),
    "speed": _Range(unit="m/s", lowest="1mm/s", highest="1m/s", points=61, spacing=np.geomspace),
    "frequency": _Range(unit="Hz", lowest="1kHz", highest="100kHz", points=120, spacing=np.geomspace),
    "power": _Range(unit="Hz", lowest="1kHz", highest="100kHz", points=60, spacing=np.geomspace),
    "load": _Range(unit="N", lowest="3N", highest="9N", points=25, spacing=np.linspace),
}


def study_of(
    rig: Rig,
    *,
    of: str,
    lowest: str | None,
    highest: str | None,
    points: int | None,
    voltages: list[str] | None,
) -> "Callable[..., xr.Dataset]":
    """Return the study that the words ask for, ready to run.

    Parameters
    ----------
    rig : Rig
    of : str
        "voltage", "speed", "frequency", "power", "waveform" or "load".
    lowest, highest : str or None
        Ends of the range, with their units.
    points : int or None
        How many values.
    voltages : list of str or None
        Drive of each curve, with its unit.

    Returns
    -------
    callable
        Takes `advance`, which is told how far it is, and returns the dataset.

    Raises
    ------
    InvalidInput
        If the rig cannot be studied, the range is none, or an option has no meaning for the study.
    """
    gap_law_of(driven_rig(rig))
    if of not in ("speed", "frequency") and voltages:
        raise InvalidInput(f"--voltage has no meaning for --of {of}; it is for speed and frequency")
    if of == "waveform":
        if lowest or highest or points:
            raise InvalidInput("--from, --to and --points have no meaning for --of waveform, which runs over names")
        return partial(waveform_study, rig)
    values = _values(rig, of, lowest, highest, points)
    curves = _curves(voltages)
    studies: dict[str, Callable[[], Callable[..., xr.Dataset]]] = {
        "voltage": lambda: partial(voltage_study, rig, voltage_peak_to_peak=values),
        "speed": lambda: partial(speed_study, rig, sliding_speed=values, voltage_peak_to_peak=curves),
        "frequency": lambda: partial(frequency_study, rig, frequency=values, voltage_peak_to_peak=curves),
        "power": lambda: partial(least_power_study, rig, frequency=values, friction_ratio=_own_ratio(rig)),
        "load": lambda: partial(load_study, rig, normal_load=values),
    }
    return studies[of]()


def _curves(voltages: list[str] | None) -> Floats | None:
    if not voltages:
        return None
    return require_positive(voltage_peak_to_peak=[to_si(text, unit="V", name="--voltage") for text in voltages])


def _values(rig: Rig, of: str, lowest: str | None, highest: str | None, points: int | None) -> Floats:
    usual = _RANGES[of]
    low = to_si(lowest or usual.lowest, unit=usual.unit, name="--from")
    high = to_si(highest or usual.highest, unit=usual.unit, name="--to")
    floor = f"not lie below 0 {usual.unit}" if usual.from_zero else f"lie above 0 {usual.unit}"
    if low < 0 or (low == 0 and not usual.from_zero) or low >= high:
        raise InvalidInput(
            f"--from {lowest or usual.lowest} must {floor} and must lie below --to {highest or usual.highest}"
        )
    count = points or usual.points
    if of in ("frequency", "power"):
        return frequency_grid(rig, lowest=low, highest=high, points=count, resonance_points=_CROWDED)
    return usual.spacing(low, high, count)


def _own_ratio(rig: Rig) -> float:
    own = operating_points(rig)
    if bool(own.failed):
        raise InvalidInput(f"{rig.title} has no friction ratio of its own to be had elsewhere: {own.reason}")
    return float(own.friction_ratio)
