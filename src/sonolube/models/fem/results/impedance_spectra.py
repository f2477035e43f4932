"""Impedance spectra of a transducer, free and with faces clamped, and their contents as files."""

import io
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.execution.threads import thread_pool
from sonolube.models.fem.electromechanical_model import (
    ElectromechanicalMode,
    ElectromechanicalModel,
    converged_electromechanical_model,
)
from sonolube.models.fem.mesh.element_order import generate_mesh
from sonolube.models.fem.mesh.mesh import Mesh
from sonolube.models.fem.parts.transducers import Transducer
from sonolube.models.fem.results.nodal_fields import vtu_text
from sonolube.models.fem.solver.model import FixedSupport, Model
from sonolube.models.fem.solver.response import HarmonicResponse, harmonic_response

_MIN_COUPLING = 0.05  # effective coupling factor from which a mode counts as driven by the voltage


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SupportedSpectrum:
    """Response of a transducer under one support to a voltage of 1 V.

    Parameters
    ----------
    port : ElectromechanicalModel
        Reduced electromechanical model.
    response : HarmonicResponse
    """

    port: ElectromechanicalModel
    response: HarmonicResponse

    @property
    def impedance(self) -> Complexes:
        """Voltage per current, complex, in ohm."""
        return np.asarray(1 / self.response.admittance)

    @property
    def coupled_modes(self) -> tuple[ElectromechanicalMode, ...]:
        """Modes with an effective coupling factor above 0.05."""
        return tuple(mode for mode in self.port.modes if mode.coupling_factor > _MIN_COUPLING)

    @property
    def low_frequency_capacitance(self) -> float:
        r"""Capacitance at the lowest frequency, :math:`\Im Y / \omega`, in F."""
        return float(self.response.admittance[0].imag / (2 * np.pi * self.response.frequency[0]))

    def tip_displacement_at(self, frequency: float) -> float:
        """Displacement of the working end per volt, in m/V, at the frequency of the spectrum nearest to `frequency`."""
        nearest = int(np.argmin(np.abs(self.response.frequency - frequency)))
        return float(np.abs(self.response.displacement_per_volt[0, nearest]))


def supported_spectra(
    transducer: Transducer,
    *,
    frequency: Floats,
    clamped_faces: Sequence[str],
    axis_of: Callable[[Mesh], str],
    element_size: float,
    relative_tolerance: float,
    advance: Callable[[str, int, int], None] | None = None,
) -> dict[str, SupportedSpectrum]:
    """Impedance spectra of a transducer, free and, where faces are given, clamped at them.

    "free", and "clamped" where faces are given.

    See Also
    --------
    converged_port, harmonic_response
    """
    one_at_a_time = threading.RLock()

    @lru_cache
    def kept_mesh(size: float) -> Mesh:
        return generate_mesh(transducer.geometry, element_size=size)

    def mesh_at(size: float) -> Mesh:
        with one_at_a_time:
            return kept_mesh(size)

    def told(*progress: Any) -> None:
        if advance:
            with one_at_a_time:
                advance(*progress)

    def spectrum(faces: Sequence[str]) -> SupportedSpectrum:
        fixed = tuple(FixedSupport(face=face) for face in faces)

        def model_at(size: float) -> Model:
            return transducer.model(mesh_at(size), fixed=fixed)

        held = set(faces)
        port = converged_electromechanical_model(
            model_at,
            outputs={name: output for name, output in transducer.outputs.items() if output.face not in held},
            axis=axis_of(mesh_at(element_size)),
            highest_frequency=float(frequency[-1]),
            element_size=element_size,
            relative_tolerance=relative_tolerance,
            advance=told,
        )
        port = replace(port, reduction=transducer.whole(port.reduction))
        return SupportedSpectrum(port=port, response=harmonic_response(port.reduction, frequency=frequency))

    supports = {"free": (), "clamped": clamped_faces} if clamped_faces else {"free": ()}
    with thread_pool(len(supports)) as pool:
        return dict(zip(supports, pool.map(spectrum, supports.values()), strict=True))


def spectrum_table(spectrum: SupportedSpectrum) -> str:
    """Spectrum as CSV that `sonolube measure impedance` reads.

    Frequency, resistance, reactance, magnitude, phase, and the displacement per volt of every output.
    """
    z, displacement = spectrum.impedance, np.abs(spectrum.response.displacement_per_volt)
    columns = [spectrum.response.frequency, z.real, z.imag, np.abs(z), np.degrees(np.angle(z)), *displacement]
    outputs = [f"{name} displacement (m/V)" for name in spectrum.port.reduction.outputs]
    text = io.StringIO()
    header = ",".join(["frequency (Hz)", "R (ohm)", "X (ohm)", "|Z| (ohm)", "phase (deg)", *outputs])
    np.savetxt(text, np.column_stack(columns), fmt="%.9g", delimiter=",", header=header, comments="")
    return text.getvalue()


def coupled_modes_grid(spectrum: SupportedSpectrum) -> str:
    """Mesh with the shapes of the coupled modes as a VTK grid (.vtu)."""
    port = spectrum.port
    fields = {
        f"{mode.name}, {mode.series_frequency:.0f} Hz": shape
        for mode, shape in zip(port.modes, port.shapes, strict=True)
        if mode.coupling_factor > _MIN_COUPLING
    }
    return vtu_text(port.model.mesh, fields=fields)
