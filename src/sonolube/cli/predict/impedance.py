"""Command `impedance compute`: electrical impedance of a transducer by finite elements, free and clamped."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from sonolube.checks import require_positive
from sonolube.cli.console.answer import Answer, deliver, si
from sonolube.cli.console.options import OUT, Json, Out, Sizes, TypedNumber, si_option
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.parts import SIZE_ENTRY, ceramic_of, sizes_by_name
from sonolube.cli.console.progress import progress
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.reader import read_impedance
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.models.fem import Transducer
from sonolube.models.fem.figures import impedance_figure
from sonolube.models.fem.impedance_spectra import (
    SupportedSpectrum,
    coupled_modes_grid,
    spectrum_table,
    supported_spectra,
)
from sonolube.report import Drawing
from sonolube.rig.datasets import labelled
from sonolube.rig.labelled_arrays import LabelledArrays
from sonolube.units import format_si
from sonolube.workbench.named_parts import longest_axis, named_transducer, starting_size

_FILES = "{part}-impedance.* {part}-impedance-free.* {part}-impedance-clamped.* {part}-modes-*.vtu"


def compute(
    part: Annotated[
        str, typer.Argument(metavar="PART", help="stack, tribometer_actuator, cutter_head, or a part or STEP file.")
    ],
    sizes: Sizes = None,
    lowest: Annotated[float, si_option("Hz", "Lowest frequency.", "--from")] = TypedNumber("1kHz", "Hz"),
    highest: Annotated[float, si_option("Hz", "Highest frequency.", "--to")] = TypedNumber("60kHz", "Hz"),
    count: Annotated[int, typer.Option("--points", metavar="NUMBER", help="Number of frequencies.", min=2)] = 1001,
    clamp: Annotated[
        list[str] | None, typer.Option(metavar="FACE", help="A face held still for a second spectrum, such as back.-z.")
    ] = None,
    ceramic: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Ceramic of the stack or of a part that is no transducer; pic255."),
    ] = None,
    poled: Annotated[
        str | None, typer.Option(metavar="x|y|z", help="Direction in which such a part is poled; z.")
    ] = None,
    drive: Annotated[str | None, typer.Option(metavar="FACE", help="Its driven electrode; +z.")] = None,
    ground: Annotated[str | None, typer.Option(metavar="FACE", help="Its grounded electrode; -z.")] = None,
    measured: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Spectrum to draw over it, as `measure impedance` reads it.")
    ] = None,
    tolerance: Annotated[
        float, typer.Option(metavar="RATIO", help="Largest change of a coupled resonance from mesh to mesh.")
    ] = 0.02,
    vtu: Annotated[bool, typer.Option("--vtu", help="Write the coupled modes for ParaView too.")] = False,
    out: Annotated[
        Out, OutputFolder("{part}-impedance.* {part}-impedance-free.* {part}-impedance-clamped.* {part}-modes-*.vtu")
    ] = OUT,
    json: Json = False,
) -> None:
    """Electrical impedance of a transducer, free and clamped: resonances, coupling and motion per volt.

    Example: sonolube impedance compute tribometer_actuator --clamp back.-z --to 40kHz
    """
    if not lowest < highest:
        raise InvalidInput(f"--from must lie below --to, got {lowest} and {highest}")
    frequency = np.linspace(float(require_positive(frequency=lowest)), highest, count)
    reference = None if measured is None else read_impedance(measured)
    wiring = {"ceramic": ceramic, "poled": poled, "drive": drive, "ground": ground}
    transducer = named_transducer(part, sizes_by_name(sizes or []), entry=SIZE_ENTRY, **wiring)
    with progress("meshing and solving") as advance:
        spectra = supported_spectra(
            transducer,
            frequency=frequency,
            clamped_faces=clamp or (),
            axis_of=longest_axis,
            element_size=starting_size(transducer.geometry),
            relative_tolerance=tolerance,
            advance=advance,
        )
    answer = ImpedanceAnswer(
        part=part,
        ceramic=ceramic_of(part, ceramic),
        transducer=transducer,
        spectra=spectra,
        measured=reference,
        with_modes=vtu,
    )
    deliver(answer, folder=out, as_json=json)


@dataclass(frozen=True, kw_only=True)
class ImpedanceAnswer(Answer):
    """Impedance spectra of a transducer with their coupled modes, beside a measured spectrum where there is one."""

    part: str
    ceramic: str
    transducer: Transducer
    spectra: Mapping[str, SupportedSpectrum]
    measured: ImpedanceSpectrum | None
    with_modes: bool

    def lines(self) -> list[str]:
        """Capacitance and coupled modes of each spectrum, and the least impedance measured."""
        lines = [f"{self.part} of {self.ceramic}: {', '.join(self.transducer.electrodes.driven)} driven"]
        for name, spectrum in self.spectra.items():
            port, lowest = spectrum.port, float(spectrum.response.frequency[0])
            lines.append(
                f"  {name}: {format_si(spectrum.low_frequency_capacitance, 'F')} at {format_si(lowest, 'Hz')}, "
                f"{port.model.mesh.node_count} nodes, resonances +-{port.frequency_error:.1g}"
            )
            lines += [
                f"    {mode.name:<12}  f_s {mode.series_frequency:>8.0f} Hz  f_p {mode.parallel_frequency:>8.0f} Hz  "
                f"k_eff {mode.coupling_factor:.3f}  "
                f"tip {format_si(spectrum.tip_displacement_at(mode.series_frequency), 'm')} per volt"
                for mode in spectrum.coupled_modes
            ]
        if self.measured is not None:
            row = int(abs(self.measured.impedance).argmin())
            least, at = float(abs(self.measured.impedance[row])), float(self.measured.frequency[row])
            lines.append(
                f"  measured: least impedance {format_si(least, 'ohm')} at {format_si(at, 'Hz', digits=4)} in "
                f"{self.measured.file_name}"
            )
        return lines

    def object(self) -> dict[str, Any]:
        """Electrodes, coupled modes of each spectrum, origin of the dimensions, and the measured file."""
        electrodes, measured = self.transducer.electrodes, self.measured
        return {
            "part": self.part,
            "ceramic": self.ceramic,
            "electrodes": {"driven": list(electrodes.driven), "grounded": list(electrodes.grounded)},
            "spectra": {name: _spectrum_object(spectrum) for name, spectrum in self.spectra.items()},
            "dimensions": [
                {
                    "name": size.name,
                    "value": size.value,
                    "origin": "printed" if size.printed else "assumed",
                    "source": size.source,
                }
                for size in self.transducer.dimensions
            ],
            "measured": None if measured is None else {"file": measured.file_name, "sha256": measured.sha256},
        }

    def assumptions(self) -> Mapping[str, str]:
        """Dimensions that no source prints, with the reason for their values."""
        return {size.name: size.source for size in self.transducer.dimensions if not size.printed}

    def figures(self) -> Mapping[str, Drawing]:
        """Impedance and motion per volt over frequency."""
        measured = None if self.measured is None else (self.measured.frequency, self.measured.impedance)
        title = self._stem().replace("_", " ")
        draw = lambda: impedance_figure(self.spectra, title=title, measured=measured)  # noqa: E731
        return {f"{self._stem()}-impedance": Drawing(draw=draw)}

    def files(self) -> Mapping[str, str | LabelledArrays]:
        """Table and dataset of each spectrum, and its coupled modes where they are wanted."""
        stem = self._stem()
        files: dict[str, str | LabelledArrays] = {}
        for name, spectrum in self.spectra.items():
            values = {
                "frequency": spectrum.response.frequency,
                "impedance": np.abs(spectrum.impedance),
                "phase": np.angle(spectrum.impedance),
                "displacement_per_volt": np.abs(spectrum.response.displacement_per_volt[0]),
            }
            title = f"Impedance of {stem.replace('_', ' ')}, {name}"
            files[f"{stem}-impedance-{name}.csv"] = spectrum_table(spectrum)
            files[f"{stem}-impedance-{name}.nc"] = labelled(values, along="frequency", title=title)
            if self.with_modes:
                files[f"{stem}-modes-{name}.vtu"] = coupled_modes_grid(spectrum)
        return files

    def _stem(self) -> str:
        """Name of the part without folder and ending."""
        return Path(self.part).stem


def _spectrum_object(spectrum: SupportedSpectrum) -> dict[str, Any]:
    """Nodes, error, capacitance and coupled modes of a spectrum, for JSON."""
    names = ("series_frequency", "parallel_frequency", "coupling_factor")
    return {
        "nodes": spectrum.port.model.mesh.node_count,
        **si(
            {
                "frequency_error": spectrum.port.frequency_error,
                "clamped_capacitance": spectrum.port.reduction.clamped_capacitance.real,
            }
        ),
        "modes": [
            {
                "name": mode.name,
                **si({name: getattr(mode, name) for name in names}),
                **si({"displacement_per_volt": spectrum.tip_displacement_at(mode.series_frequency)}),
            }
            for mode in spectrum.coupled_modes
        ],
    }
