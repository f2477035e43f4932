"""What the command `study` says and writes."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.cli.output import closing_lines
from sonolube.errors import InvalidInput
from sonolube.figure import publication_style, write_figure
from sonolube.rig import STUDY_FIGURES, Rig, write_netcdf
from sonolube.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_TOLD = ("friction_ratio", "vibration_amplitude", "actuator_power", "dissipated_power")


def study_object(rig: Rig, of: str, study: "xr.Dataset", written: list[Path]) -> dict[str, Any]:
    """Return the point of least friction of each curve, and the points that failed, as they go into JSON."""
    return {
        "rig": rig.title,
        "study": of,
        "friction_model": rig.friction_model.name,
        "least_friction": [
            {name: _valued(best, name) for name in (*_coordinates(best), *_TOLD)} for best in _best_points(study)
        ],
        "points": int(study["status"].size),
        "without_result": [{"reason": reason, "points": count} for reason, count in _failures(study)],
        "assumptions": dict(rig.assumptions),
        "files": [str(path) for path in written],
    }


def study_lines(rig: Rig, of: str, study: "xr.Dataset", written: list[Path]) -> list[str]:
    """Return what a study shows as lines."""
    return [
        f"{rig.title}, {format_si(rig.normal_load, 'N')}, {study['status'].size} points, {rig.friction_model.name}",
        *[f"  {line}" for line in _LINES[of](study)],
        *[f"  without result: {count} of {study['status'].size}: {reason}" for reason, count in _failures(study)],
        *closing_lines(written, assumptions=rig.assumptions),
    ]


def write_study(study: "xr.Dataset", of: str, *, folder: Path, name: str) -> list[Path]:
    """Write a study as a figure and as netCDF, and return the files; refuse one of which no point has a result."""
    if np.isnan(study["friction_ratio"].values).all():
        raise InvalidInput(f"no point has a result: {_failures(study)[0][0]}")
    with publication_style():
        figure = STUDY_FIGURES[of](study)
        figure.suptitle(study.attrs["rig"], fontsize=9)
        figures = write_figure(figure, folder=folder, name=name)
    return [*figures, write_netcdf(study, path=folder / f"{name}.nc")]


def _voltage_lines(study: "xr.Dataset") -> Iterator[str]:
    for best in _best_points(study):
        yield f"least friction       ratio {_told(best, 'friction_ratio')} at {_told(best, 'voltage_peak_to_peak')}"
    lost = study["voltage_peak_to_peak"].values[study["contact_loss_fraction"].values > 0]
    begin = f"from {format_si(float(lost.min()), 'V')}" if lost.size else "nowhere"
    most = format_si(float(study["actuator_power"].max()), "W")
    yield f"contact is lost      {begin}"
    yield f"amplifier            up to {most}, D 1.9"


def _speed_lines(study: "xr.Dataset") -> Iterator[str]:
    for index in range(study.sizes["voltage_peak_to_peak"]):
        curve = study.isel(voltage_peak_to_peak=index)
        ratios = curve["friction_ratio"].values
        volts = _told(curve, "voltage_peak_to_peak")
        yield f"at {volts:<10} ratio {np.nanmin(ratios):.3g} to {np.nanmax(ratios):.3g}, slow to fast"


def _frequency_lines(study: "xr.Dataset") -> Iterator[str]:
    for best in _best_points(study):
        yield (
            f"at {_told(best, 'voltage_peak_to_peak'):<10} least friction ratio {_told(best, 'friction_ratio')} at "
            f"{_told(best, 'frequency', digits=4)}, {_told(best, 'vibration_amplitude')}, "
            f"{_told(best, 'actuator_power')}"
        )


def _power_lines(study: "xr.Dataset") -> Iterator[str]:
    for name, whose in (("actuator_power", "of the amplifier, D 1.9"), ("dissipated_power", "that stays in the rig")):
        if not np.all(np.isnan(study[name])):
            least = study.isel(frequency=int(np.nanargmin(study[name].values)))
            yield (
                f"friction ratio {_told(least, 'friction_ratio')} takes the least power {whose}, {_told(least, name)}, "
                f"at {_told(least, 'frequency', digits=4)} and {_told(least, 'voltage_peak_to_peak')}"
            )


def _waveform_lines(study: "xr.Dataset") -> Iterator[str]:
    for index in np.argsort(study["friction_ratio"].values):
        one = study.isel(waveform=int(index))
        name = str(one["waveform"].values)
        yield f"{name:<12} ratio {_told(one, 'friction_ratio')}, {_told(one, 'vibration_amplitude')}"


def _load_lines(study: "xr.Dataset") -> Iterator[str]:
    ratios, arm = study["friction_ratio"].values, study["natural_frequency"].values
    yield f"friction ratio       {np.nanmin(ratios):.4g} to {np.nanmax(ratios):.4g}"
    yield f"arm's frequency      {format_si(float(arm.min()), 'Hz')} to {format_si(float(arm.max()), 'Hz')}"


_LINES: dict[str, Callable[["xr.Dataset"], Iterator[str]]] = {
    "voltage": _voltage_lines,
    "speed": _speed_lines,
    "frequency": _frequency_lines,
    "power": _power_lines,
    "waveform": _waveform_lines,
    "load": _load_lines,
}


def _best_points(study: "xr.Dataset") -> "Iterator[xr.Dataset]":
    """Yield the point of least friction, of each curve where there are several."""
    curves = [study]
    if study["friction_ratio"].ndim == 2:
        curves = [study.isel({study["friction_ratio"].dims[0]: i}) for i in range(study["friction_ratio"].shape[0])]
    for curve in curves:
        ratios = curve["friction_ratio"]
        if not np.all(np.isnan(ratios)):
            yield curve.isel({ratios.dims[0]: int(np.nanargmin(ratios.values))})


def _failures(study: "xr.Dataset") -> list[tuple[str, int]]:
    """Return why points have no result, each reason with how many points it explains."""
    reasons, counts = np.unique(study["reason"].values[np.isnan(study["friction_ratio"].values)], return_counts=True)
    return [(str(reason), int(count)) for reason, count in zip(reasons, counts, strict=True)]


def _coordinates(point: "xr.Dataset") -> list[str]:
    return [str(name) for name in point.coords if point[name].ndim == 0]


def _valued(point: "xr.Dataset", name: str) -> Any:
    if name == "waveform":
        return str(point[name].values)
    return {"value": float(point[name]), "unit": quantity(name).unit}


def _told(point: "xr.Dataset", name: str, *, digits: int = 3) -> str:
    return format_si(float(point[name]), quantity(name).unit, digits=digits)
