"""Natural modes of a part, and impedance spectra of a transducer with its coupled modes, as text and JSON."""

import tomllib
from collections.abc import Mapping
from typing import Any

from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.models.fem import ConvergedModes, Transducer
from sonolube.models.fem.results.impedance_spectra import SupportedSpectrum
from sonolube.models.fem.results.part_modes import PartModes, elastic_rows, frequency_text
from sonolube.report.blocks import Block, Rows, Table
from sonolube.report.results.record_object import picked
from sonolube.text.units import format_si
from sonolube.vocabulary import si


def modes_blocks(solved: PartModes) -> list[Block]:
    """Name and natural frequency with its error of every elastic mode."""
    found, part = solved.found, solved.part
    rigid = found.modes.rigid_body_count
    support = f"{rigid} rigid motions, " if rigid else "held, "
    nodes = f"{found.nodes[-1]} nodes in the last of {len(found.nodes)} meshes"
    return [
        f"{part.name} of {part.material}: {support}{nodes}",
        Rows([(solved.names[row], _frequency(found, row)) for row in elastic_rows(found)]),
    ]


def modes_object(solved: PartModes, structure: str | None) -> dict[str, Any]:
    """Rigid motions, nodes of the meshes, structure as TOML, and name, frequency and error of every elastic mode."""
    found = solved.found
    return {
        "part": solved.part.name,
        "material": solved.part.material,
        "rigid_motions": found.modes.rigid_body_count,
        "nodes": list(found.nodes),
        **({} if structure is None else {"structure": tomllib.loads(structure)}),
        "modes": [_mode(solved, row) for row in elastic_rows(found)],
    }


def _mode(solved: PartModes, row: int) -> dict[str, Any]:
    """Name, frequency and error of a mode."""
    frequency, error = float(solved.found.natural_frequency[row]), float(solved.found.frequency_error[row])
    return {
        "name": solved.names[row],
        "text": _frequency(solved.found, row),
        **si({"uncertainty": frequency * error}, unit="Hz"),
        **si({"natural_frequency": frequency, "frequency_error": error}),
    }


def _frequency(found: ConvergedModes, row: int) -> str:
    """Natural frequency of a mode with its error."""
    return frequency_text(
        frequency=float(found.natural_frequency[row]), relative_error=float(found.frequency_error[row])
    )


_HEADS = ("mode", "f_s", "f_p", "k_eff", "tip per volt")


def blocks(spectra: Mapping[str, SupportedSpectrum], measured: ImpedanceSpectrum | None) -> list[Block]:
    """Capacitance and coupled modes of each spectrum, and the least impedance measured."""
    blocks: list[Block] = []
    for name, spectrum in spectra.items():
        port, lowest = spectrum.port, float(spectrum.response.frequency[0])
        blocks.append(
            f"  {name}: {format_si(spectrum.low_frequency_capacitance, 'F')} at {format_si(lowest, 'Hz')}, "
            f"{port.model.mesh.node_count} nodes, resonances +-{port.frequency_error:.1g}"
        )
        blocks.append(Table(_HEADS, _mode_rows(spectrum)))
    if measured is not None:
        row = int(abs(measured.impedance).argmin())
        least, at = float(abs(measured.impedance[row])), float(measured.frequency[row])
        blocks.append(
            f"  measured: least impedance {format_si(least, 'ohm')} at {format_si(at, 'Hz', digits=4)} in "
            f"{measured.file_name}"
        )
    return blocks


def impedance_object(
    transducer: Transducer, spectra: Mapping[str, SupportedSpectrum], measured: ImpedanceSpectrum | None
) -> dict[str, Any]:
    """Electrodes, coupled modes of each spectrum, origin of the dimensions, and the measured file, for JSON."""
    electrodes = transducer.electrodes
    return {
        "electrodes": {"driven": list(electrodes.driven), "grounded": list(electrodes.grounded)},
        "spectra": {name: _spectrum_object(spectrum) for name, spectrum in spectra.items()},
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
    }


def _mode_rows(spectrum: SupportedSpectrum) -> list[tuple[str, ...]]:
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


def _spectrum_object(spectrum: SupportedSpectrum) -> dict[str, Any]:
    """Nodes, error, capacitance and coupled modes of a spectrum."""
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
                **si(picked(mode, "series_frequency", "parallel_frequency", "coupling_factor")),
                **si({"displacement_per_volt": spectrum.tip_displacement_at(mode.series_frequency)}),
            }
            for mode in spectrum.coupled_modes
        ],
    }
