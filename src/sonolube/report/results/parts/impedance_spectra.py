"""Impedance spectra of a transducer: rows of their coupled modes, and objects for JSON."""

from typing import Any

from sonolube.models.fem.impedance_spectra import SupportedSpectrum
from sonolube.units import format_si
from sonolube.vocabulary import si


def mode_rows(spectrum: SupportedSpectrum) -> list[tuple[str, ...]]:
    """Resonances, coupling and motion of the coupled modes of a spectrum."""
    return [
        (
            mode.name,
            f"{mode.series_frequency:.0f} Hz",
            f"{mode.parallel_frequency:.0f} Hz",
            f"{mode.coupling_factor:.3f}",
            format_si(spectrum.tip_displacement_at(mode.series_frequency), "m"),
        )
        for mode in spectrum.coupled_modes
    ]


def spectrum_object(spectrum: SupportedSpectrum) -> dict[str, Any]:
    """Nodes, error, capacitance and coupled modes of a spectrum."""
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
