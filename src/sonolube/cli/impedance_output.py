"""What the command `impedance compute` says, draws and writes."""

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.fem import HarmonicResponse, Transducer, vtu_text
from sonolube.fem.electromechanical_model import ElectromechanicalMode, ElectromechanicalModel
from sonolube.figure import COLOURS, LINES, publication_style, write_figure
from sonolube.files import write_atomically
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.rig import dataset, write_netcdf
from sonolube.units import format_si

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COUPLED = 0.05  # effective coupling factor from which a mode is told


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Spectrum:
    """A body under one support, and its response to one volt."""

    port: ElectromechanicalModel
    response: HarmonicResponse

    @property
    def impedance(self) -> Complexes:
        """Voltage per current, complex, in ohm."""
        return np.asarray(1 / self.response.admittance)

    @property
    def coupled(self) -> tuple[ElectromechanicalMode, ...]:
        """The modes that the voltage drives."""
        return tuple(mode for mode in self.port.modes if mode.coupling_factor > _COUPLED)

    def tip_at(self, frequency: float) -> float:
        """Return the motion of the working end in m/V at the frequency of the spectrum nearest to one."""
        near = int(np.argmin(np.abs(self.response.frequency - frequency)))
        return float(np.abs(self.response.displacement_per_volt[0, near]))


def impedance_object(
    part: str,
    transducer: Transducer,
    spectra: Mapping[str, Spectrum],
    measured: ImpedanceSpectrum | None,
    written: Sequence[Path],
) -> dict[str, Any]:
    """Return spectra's modes as one JSON object, all quantities in SI."""
    return {
        "part": part,
        "electrodes": {
            "driven": list(transducer.electrodes.driven),
            "grounded": list(transducer.electrodes.grounded),
        },
        "spectra": {name: _told(spectrum) for name, spectrum in spectra.items()},
        "dimensions": [
            {
                "name": size.name,
                "value": size.value,
                "origin": "printed" if size.printed else "assumed",
                "source": size.source,
            }
            for size in transducer.dimensions
        ],
        "measured": None if measured is None else {"file": measured.file_name, "sha256": measured.sha256},
        "files": [str(path) for path in written],
    }


def impedance_lines(
    part: str,
    transducer: Transducer,
    spectra: Mapping[str, Spectrum],
    measured: ImpedanceSpectrum | None,
    written: Sequence[Path],
) -> list[str]:
    """Return spectra's modes as lines."""
    lines = [f"{part}: {', '.join(transducer.electrodes.driven)} driven"]
    for name, spectrum in spectra.items():
        port, low = spectrum.port, spectrum.response
        capacitance = float(low.admittance[0].imag / (2 * np.pi * low.frequency[0]))
        lines.append(
            f"  {name}: {format_si(capacitance, 'F')} at {format_si(float(low.frequency[0]), 'Hz')}, "
            f"{port.model.mesh.node_count} nodes, resonances +-{port.frequency_error:.1g}"
        )
        lines += [
            f"    {mode.name:<12}  f_s {mode.series_frequency:>8.0f} Hz  f_p {mode.parallel_frequency:>8.0f} Hz  "
            f"k_eff {mode.coupling_factor:.3f}  tip {format_si(spectrum.tip_at(mode.series_frequency), 'm')} per volt"
            for mode in spectrum.coupled
        ]
    if measured is not None:
        low_z = int(np.argmin(np.abs(measured.impedance)))
        lines.append(
            f"  measured: least impedance {format_si(float(abs(measured.impedance[low_z])), 'ohm')} at "
            f"{format_si(float(measured.frequency[low_z]), 'Hz', digits=4)} in {measured.file_name}"
        )
    assumed = [size.name for size in transducer.dimensions if not size.printed]
    if assumed:
        lines.append(f"  assumed unless set: {', '.join(assumed)}")
    return [*lines, *[f"  {path}" for path in written]]


def write_impedance(
    spectra: Mapping[str, Spectrum],
    measured: ImpedanceSpectrum | None,
    *,
    folder: Path,
    part: str,
    with_modes: bool,
) -> list[Path]:
    """Write the figure, and for each support a table, a dataset and where asked the coupled modes; return the files."""
    title = part.replace("_", " ")
    files = write_figure(impedance_figure(spectra, measured, title=title), folder=folder, name=f"{part}-impedance")
    for name, spectrum in spectra.items():
        stem = f"{part}-impedance-{name}"
        values = {
            "frequency": spectrum.response.frequency,
            "impedance": np.abs(spectrum.impedance),
            "phase": np.angle(spectrum.impedance),
            "displacement_per_volt": np.abs(spectrum.response.displacement_per_volt[0]),
        }
        labelled = dataset(values, along="frequency", title=f"Impedance of {title}, {name}")
        files.append(write_atomically(folder / f"{stem}.csv", _table(spectrum)))
        files.append(write_netcdf(labelled, path=folder / f"{stem}.nc"))
        if with_modes:
            files.append(write_atomically(folder / f"{part}-modes-{name}.vtu", _modes_grid(spectrum)))
    return files


def impedance_figure(spectra: Mapping[str, Spectrum], measured: ImpedanceSpectrum | None, *, title: str) -> "Figure":
    """Return magnitude, phase and motion per volt over frequency, for each support and as measured."""
    from matplotlib.figure import Figure

    with publication_style():
        figure = Figure(figsize=(5.6, 5.8))
        magnitude, phase, motion = figure.subplots(3, 1, sharex=True, height_ratios=(1.4, 1, 1.2))
        if measured is not None:
            within = _within(measured.frequency, spectra)
            f, z = 1e-3 * measured.frequency[within], measured.impedance[within]
            magnitude.plot(f, np.abs(z), ".", color="0.5", markersize=3, label="measured")
            phase.plot(f, np.degrees(np.angle(z)), ".", color="0.5", markersize=3)
        for k, (name, spectrum) in enumerate(spectra.items()):
            look: dict[str, Any] = {"color": COLOURS[k], "linestyle": LINES[k], "linewidth": 1.2}
            f = 1e-3 * spectrum.response.frequency
            magnitude.plot(f, np.abs(spectrum.impedance), label=name, **look)
            phase.plot(f, np.degrees(np.angle(spectrum.impedance)), **look)
            motion.plot(f, 1e9 * np.abs(spectrum.response.displacement_per_volt[0]), **look)
        magnitude.set(yscale="log", ylabel="Impedance [ohm]")
        phase.set(ylabel="Phase [deg]", ylim=(-100, 100), yticks=[-90, -45, 0, 45, 90])
        motion.set(yscale="log", ylabel="Tip motion per volt\n[nm/V]", xlabel="Frequency [kHz]")
        if len(spectra) > 1 or measured is not None:
            magnitude.legend(loc="best")
        magnitude.set_title(title, fontsize=9)
    return figure


def _within(frequency: Floats, spectra: Mapping[str, Spectrum]) -> Any:
    computed = next(iter(spectra.values())).response.frequency
    return (frequency >= computed[0]) & (frequency <= computed[-1])


def _told(spectrum: Spectrum) -> dict[str, Any]:
    return {
        "nodes": spectrum.port.model.mesh.node_count,
        "frequency_error": {"value": spectrum.port.frequency_error, "unit": ""},
        "clamped_capacitance": {"value": spectrum.port.reduction.clamped_capacitance.real, "unit": "F"},
        "modes": [
            {
                "name": mode.name,
                "series_frequency": {"value": mode.series_frequency, "unit": "Hz"},
                "parallel_frequency": {"value": mode.parallel_frequency, "unit": "Hz"},
                "coupling_factor": {"value": mode.coupling_factor, "unit": ""},
                "displacement_per_volt": {"value": spectrum.tip_at(mode.series_frequency), "unit": "m/V"},
            }
            for mode in spectrum.coupled
        ],
    }


def _table(spectrum: Spectrum) -> str:
    """Return a spectrum as a table that `measure impedance` reads."""
    z, moved = spectrum.impedance, np.abs(spectrum.response.displacement_per_volt)
    columns = [spectrum.response.frequency, z.real, z.imag, np.abs(z), np.degrees(np.angle(z)), *moved]
    outputs = [f"{name} displacement (m/V)" for name in spectrum.port.reduction.outputs]
    text = io.StringIO()
    heading = ",".join(["frequency (Hz)", "R (ohm)", "X (ohm)", "|Z| (ohm)", "phase (deg)", *outputs])
    np.savetxt(text, np.column_stack(columns), fmt="%.9g", delimiter=",", header=heading, comments="")
    return text.getvalue()


def _modes_grid(spectrum: Spectrum) -> str:
    port = spectrum.port
    fields = {
        f"{mode.name}, {mode.series_frequency:.0f} Hz": shape
        for mode, shape in zip(port.modes, port.shapes, strict=True)
        if mode.coupling_factor > _COUPLED
    }
    return vtu_text(port.model.mesh, fields=fields)
