"""Task `impedance compute`: electrical impedance of a transducer by finite elements, free and clamped."""

import inspect
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Unpack

import numpy as np

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum, read_impedance
from sonolube.models.actuator import tightening_preload
from sonolube.models.fem import Transducer
from sonolube.models.fem.results import impedance_spectra
from sonolube.models.fem.results.figures import impedance_chart
from sonolube.models.fem.results.mode_surfaces import SurfaceModes, surface_modes
from sonolube.models.fem.results.part_modes import frequency_text, longest_axis, starting_size
from sonolube.models.fem.results.stack_stress import ROD, StackStress, stack_stress
from sonolube.report import Drawing
from sonolube.report.results.parts import modes_and_impedance as results
from sonolube.rig.datasets import LabelledArrays, labelled
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.parameters import File, Number, Parameter, Quantity, Sizes, Watched
from sonolube.tasks.parts.named_parts import PART_WIRING, Axis, PartSizes, named_transducer, part_name, transducers
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.text.units import format_si, to_si
from sonolube.vocabulary import si


@task
def compute(
    part: Annotated[InputFile, File("stack, tribometer_actuator, cutter_head, or a part or STEP file.", "PART")],
    *,
    sizes: Sizes = None,
    lowest: Annotated[Number, Quantity("Lowest frequency.", "Hz", option="--from")] = "1kHz",
    highest: Annotated[Number, Quantity("Highest frequency.", "Hz", option="--to")] = "60kHz",
    points: Annotated[int, Parameter("Number of frequencies.", "NUMBER", lowest=2)] = 1001,
    clamp: Annotated[
        Sequence[str], Parameter("A face held still for a second spectrum, such as back.-z.", "FACE")
    ] = (),
    ceramic: Annotated[
        str | None, Parameter("Ceramic of the stack or of a part that is no transducer; pic255.", "NAME")
    ] = None,
    poled: Annotated[Axis | None, Parameter("Direction in which such a part is poled; z.")] = None,
    drive: Annotated[str | None, Parameter("Its driven electrode; +z.", "FACE")] = None,
    ground: Annotated[str | None, Parameter("Its grounded electrode; -z.", "FACE")] = None,
    measured: Annotated[
        InputFile | None, File("Spectrum to draw over it, as sonolube measure impedance reads it.", "FILE")
    ] = None,
    tolerance: Annotated[
        Number, Quantity("Largest change of a coupled resonance from mesh to mesh.", "", kind="RATIO")
    ] = 0.02,
    vtu: Annotated[bool, Parameter("Write the coupled modes for ParaView too.")] = False,
    amplitude: Annotated[
        Number | None, Quantity("Of the working end, for the stress in stack and rod.", "vibration_amplitude")
    ] = None,
    preload: Annotated[Number | None, Quantity("Tension of the rod, which compresses the stack.", "preload")] = None,
    torque: Annotated[Number | None, Quantity("Tightening torque of the rod instead.", "torque")] = None,
    nut_factor: Annotated[
        Number, Quantity("Torque over tension and thread diameter; 0.30 dry, 0.18 lubricated.", "nut_factor")
    ] = 0.2,
    **watch: Unpack[Watched],
) -> "ImpedanceAnswer":
    """Electrical impedance of a transducer, free and clamped: resonances, coupling and motion per volt.

    Example: sonolube impedance compute tribometer_actuator --clamp back.-z --to 40kHz
    """
    low, high = in_si("lowest", lowest), in_si("highest", highest)
    if not low < high:
        raise InvalidInput(f"{shown('lowest')} must lie below {shown('highest')}, got {lowest} and {highest}")
    frequency = np.linspace(float(require_positive(frequency=low)), high, points)
    _refuse_unused(amplitude, torque)
    reference = None if measured is None else read_impedance(file_path(measured))
    transducer = named_transducer(part, sizes or {}, ceramic=ceramic, poled=poled, drive=drive, ground=ground)
    tension = _tension(
        part, sizes or {}, in_si("preload", preload), in_si("torque", torque), in_si("nut_factor", nut_factor)
    )
    height = in_si("amplitude", amplitude)
    if height is not None:
        require_positive(amplitude=height)
        _require_stressed(part_name(part), transducer, is_preloaded=tension > 0)
    with stage("meshing and solving") as advance:
        spectra = impedance_spectra.supported_spectra(
            transducer,
            frequency=frequency,
            clamped_faces=clamp,
            axis_of=longest_axis,
            element_size=starting_size(transducer.geometry),
            relative_tolerance=in_si("tolerance", tolerance),
            advance=advance,
        )
    return ImpedanceAnswer(
        part=part_name(part),
        ceramic=_ceramic_of(part_name(part), ceramic),
        transducer=transducer,
        spectra=spectra,
        measured=reference,
        with_modes=vtu,
        amplitude=height,
        preload=tension,
        by_torque=torque is not None,
    )


def _refuse_unused(amplitude: Number | None, torque: Number | None) -> None:
    """Refuse a preload without an amplitude, and two statements of it."""
    if amplitude is None:
        refuse_unused(
            "preload", "torque", "nut_factor", because=f"without {shown('amplitude')}, at which there is stress"
        )
    if torque is None:
        refuse_unused("nut_factor", because=f"without {shown('torque')}, of which it gives the tension")
    else:
        refuse_unused("preload", because=f"beside {shown('torque')}; give one of them")


def _require_stressed(part: str, transducer: Transducer, *, is_preloaded: bool) -> None:
    """Refuse the stress of a part without a working end in line with its stack, and a preload without a rod."""
    if "tip" not in transducer.outputs:
        raise InvalidInput(f"{shown('amplitude')}: {part} has no working end in line with its stack", key="amplitude")
    if is_preloaded and ROD not in transducer.geometry.regions:
        raise InvalidInput(
            f"{shown('preload')}: {part} has no rod that preloads its stack; set rod_radius", key="preload"
        )


def _tension(
    part: InputFile, sizes: PartSizes, preload: float | None, torque: float | None, nut_factor: float
) -> float:
    """Tension of the rod in N, zero where none is given."""
    if torque is None:
        return float(require_non_negative(preload=preload or 0.0))
    radius = sizes.get("rod_radius")
    if part_name(part) != "stack" or radius is None:
        raise InvalidInput(
            f"{shown('torque')} needs the thread of a stack with rod_radius; give {shown('preload')} for others",
            key="torque",
        )
    thread = 2 * (to_si(radius, unit="m", name="rod_radius") if isinstance(radius, str) else float(radius))
    return float(tightening_preload(torque=torque, thread_diameter=thread, nut_factor=nut_factor))


def _ceramic_of(part: str, ceramic: str | None) -> str:
    """Name of the ceramic that was given, or of that of a part; empty for a part that states constants of its own."""
    if ceramic is not None or part not in transducers():
        return ceramic or PART_WIRING["ceramic"]
    known = inspect.signature(transducers()[part]).parameters.get("ceramic")
    return "" if known is None else str(known.default)


@answer
class ImpedanceAnswer(Answer):
    """Impedance spectra of a transducer with their coupled modes, beside a measured spectrum where there is one."""

    part: str
    ceramic: str
    transducer: Transducer
    spectra: Mapping[str, impedance_spectra.SupportedSpectrum]
    measured: ImpedanceSpectrum | None
    with_modes: bool
    amplitude: float | None
    preload: float
    by_torque: bool

    @cached_property
    def stresses(self) -> Mapping[str, Mapping[str, StackStress]]:
        """Stress of stack and rod by support and coupled mode; empty without an amplitude."""
        if self.amplitude is None:
            return {}
        moving = {name: each for name, each in self.spectra.items() if "tip" in each.port.reduction.outputs}
        return {name: self._stresses(spectrum, self.amplitude) for name, spectrum in moving.items()}

    def _stresses(self, spectrum: impedance_spectra.SupportedSpectrum, amplitude: float) -> dict[str, StackStress]:
        """Stress of stack and rod by the name of a coupled mode."""
        pairs = zip(spectrum.port.modes, spectrum.port.shapes, strict=True)
        return {
            mode.name: stack_stress(
                spectrum.port.model,
                shape,
                working_end=self.transducer.outputs["tip"],
                amplitude=amplitude,
                preload=self.preload,
                copies=self.transducer.copies,
            )
            for mode, shape in pairs
            if mode in spectrum.coupled_modes
        }

    def caveats(self) -> Sequence[str]:
        """A stack in tension, and a preload that is known by a torque."""
        pulled = [
            f"{mode} ({name}): the stack is in tension by {format_si(each.highest_stack_stress, 'Pa')}; ceramics and"
            " joints bear compression only: more preload, or less amplitude"
            for name, modes in self.stresses.items()
            for mode, each in modes.items()
            if self.preload and each.highest_stack_stress > 0
        ]
        torque = f"the preload of {format_si(self.preload, 'N')} follows from a torque, within about 30 %"
        return [*pulled, *([torque] if self.by_torque else [])]

    def blocks(self) -> Sequence[Block]:
        """Capacitance and coupled modes of each spectrum, and the least impedance measured."""
        electrodes = ", ".join(self.transducer.electrodes.driven)
        return [
            f"{self.part} of {self.ceramic or 'its own ceramic'}: {electrodes} driven",
            *results.blocks(self.spectra, self.measured),
            *self._stress_blocks(),
        ]

    def _stress_blocks(self) -> Sequence[Block]:
        """Stress of stack and rod at the amplitude of the working end."""
        return () if self.amplitude is None else results.stress_blocks(self.stresses, self.amplitude)

    def object(self) -> dict[str, Any]:
        """Electrodes, coupled modes of each spectrum, origin of the dimensions, and the measured file."""
        content = {"part": self.part, "ceramic": self.ceramic or None}
        stresses = {name: results.stress_object(modes) for name, modes in self.stresses.items()}
        more = {"stresses": stresses, **si({"preload": self.preload})} if self.amplitude is not None else {}
        return content | results.impedance_object(self.transducer, self.spectra, self.measured) | more

    def assumptions(self) -> Mapping[str, str]:
        """Dimensions that no source prints, with the reason for their values."""
        return {size.name: size.source for size in self.transducer.dimensions if not size.printed}

    def figures(self) -> Mapping[str, Drawing]:
        """Impedance and motion per volt over frequency."""
        measured = None if self.measured is None else (self.measured.frequency, self.measured.impedance)
        title = self._stem().replace("_", " ")
        drawing = Drawing(chart=lambda: impedance_chart(self.spectra, title=title, measured=measured))
        return {f"{self._stem()}-impedance": drawing}

    def files(self) -> Mapping[str, str | LabelledArrays]:
        """Table and dataset of each spectrum, and its coupled modes where they are wanted."""
        stem = self._stem()
        files: dict[str, str | LabelledArrays] = {}
        for name, spectrum in self.spectra.items():
            files[f"{stem}-impedance-{name}.csv"] = impedance_spectra.spectrum_table(spectrum)
            files[f"{stem}-impedance-{name}.nc"] = self._labelled(name)
            if self.with_modes:
                files[f"{stem}-modes-{name}.vtu"] = impedance_spectra.coupled_modes_grid(spectrum)
        return files

    def surface_modes(self) -> SurfaceModes:
        """Coupled modes of the first spectrum on the surface of the transducer, at their series resonances."""
        spectrum = next(iter(self.spectra.values()))
        rows = [row for row, mode in enumerate(spectrum.port.modes) if mode in spectrum.coupled_modes]
        modes = [spectrum.port.modes[row] for row in rows]
        frequencies = [
            (mode.name, frequency_text(frequency=mode.series_frequency, relative_error=spectrum.port.frequency_error))
            for mode in modes
        ]
        axis = longest_axis(spectrum.port.model.mesh)
        return surface_modes(spectrum.port.model, spectrum.port.shapes[rows], frequencies=frequencies, axis=axis)

    def dataset(self) -> Dataset:
        """Impedance, phase and motion per volt over frequency and support."""
        import xarray as xr

        supports = xr.Variable("support", list(self.spectra), {"long_name": "Support of the transducer"})
        each = [self._labelled(name).dataset() for name in self.spectra]
        found = xr.concat(each, supports, combine_attrs="drop_conflicts")
        return found.assign_attrs(self.notes(), title=f"Impedance of {self._stem().replace('_', ' ')}")

    def _labelled(self, name: str) -> LabelledArrays:
        """Impedance, phase and motion per volt of a spectrum."""
        spectrum = self.spectra[name]
        values = {
            "frequency": spectrum.response.frequency,
            "impedance": np.abs(spectrum.impedance),
            "phase": np.angle(spectrum.impedance),
            "displacement_per_volt": np.abs(spectrum.response.displacement_per_volt[0]),
        }
        return labelled(values, along="frequency", title=f"Impedance of {self._stem().replace('_', ' ')}, {name}")

    def _stem(self) -> str:
        """Name of the part without folder and ending."""
        return Path(self.part).stem
