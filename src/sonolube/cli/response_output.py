"""What the command `response` says and writes."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.cli.output import closing_lines
from sonolube.dynamics import modes
from sonolube.figure import COLOURS, publication_style, write_figure
from sonolube.rig import FrequencyResponse, Rig, dataset, structure_in_contact, write_netcdf
from sonolube.units import format_si

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def response_object(rig: Rig, result: FrequencyResponse, written: list[Path]) -> dict[str, Any]:
    """Return the resonances and the largest response as they go into JSON."""
    best = int(np.argmax(result.amplitude_per_volt))
    return {
        "rig": rig.title,
        "resonances": [{"value": float(f), "unit": "Hz"} for f in _resonances(rig)],
        "frequency": {"value": float(result.frequency[best]), "unit": "Hz"},
        "amplitude_per_volt": {"value": float(result.amplitude_per_volt[best]), "unit": "m/V"},
        "assumptions": dict(rig.assumptions),
        "files": [str(path) for path in written],
    }


def response_lines(rig: Rig, result: FrequencyResponse, written: list[Path]) -> list[str]:
    """Return the resonances and the largest response as lines."""
    best = int(np.argmax(result.amplitude_per_volt))
    resonances = ", ".join(format_si(f, "Hz", digits=4) for f in _resonances(rig)) or "none"
    return [
        f"{rig.title}, {format_si(rig.normal_load, 'N')}, small motions",
        f"  natural frequencies  {resonances}",
        f"  largest amplitude    {format_si(float(result.amplitude_per_volt[best]), 'm')} per volt peak to peak "
        f"at {format_si(float(result.frequency[best]), 'Hz', digits=4)}",
        *closing_lines(written, assumptions=rig.assumptions),
    ]


def write_response(rig: Rig, result: FrequencyResponse, *, folder: Path, name: str) -> list[Path]:
    """Write the response as a figure and as netCDF, and return the files."""
    values = {
        "frequency": result.frequency,
        "amplitude_per_volt": result.amplitude_per_volt,
        "impedance": result.impedance,
        "phase": result.phase,
    }
    labelled = dataset(values, along="frequency", title=f"Linear response of {rig.title}")
    with publication_style():
        figures = write_figure(_figure(rig, result), folder=folder, name=name)
    return [*figures, write_netcdf(labelled, path=folder / f"{name}.nc")]


def _resonances(rig: Rig) -> list[float]:
    natural = modes(structure_in_contact(rig))
    return [float(f) for f in natural.natural_frequency[~natural.rigid]]


def _figure(rig: Rig, result: FrequencyResponse) -> "Figure":
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.2, 5.4))
    panels = figure.subplots(3, 1, sharex=True)
    kilohertz = 1e-3 * result.frequency
    rows = (
        (1e6 * result.amplitude_per_volt, "Amplitude per volt\n[µm/V]", "log"),
        (result.impedance, "Impedance\n[ohm]", "log"),
        (np.degrees(result.phase), "Phase\n[deg]", "linear"),
    )
    for index, (axes, (values, label, scale)) in enumerate(zip(panels, rows, strict=True)):
        axes.plot(kilohertz, values, color=COLOURS[index])
        axes.set(ylabel=label, yscale=scale)
        if rig.drive is not None:
            axes.axvline(1e-3 * rig.drive.frequency, color="0.4", linestyle=":", label="drive")
    panels[0].legend(loc="upper left")
    panels[-1].set_xlabel("Frequency [kHz]")
    panels[-1].set_yticks([-90, -45, 0, 45, 90])
    figure.suptitle(rig.title, fontsize=9)
    return figure
