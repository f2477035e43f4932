"""Natural modes of a part, and impedance spectra of a transducer with its coupled modes, as text and JSON."""

import tomllib
from collections.abc import Mapping, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.models.fem import ConvergedModes, Transducer
from sonolube.models.fem.results.impedance_spectra import SupportedSpectrum
from sonolube.models.fem.results.part_modes import PartModes, elastic_rows, frequency_text
from sonolube.models.fem.results.stack_stress import StackStress
from sonolube.report.blocks import Block, Rows, Table
from sonolube.report.results.record_object import finite, picked
from sonolube.rig.file.structures import MODE_LISTS
from sonolube.text.units import format_si
from sonolube.vocabulary import si

if TYPE_CHECKING:
    import xarray as xr


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


def foreign_blocks(title: str, lists: Mapping[str, Floats], notes: Sequence[str]) -> list[Block]:
    """Frequency, quality factor, participations and tip amplitude per volt of modes of another program."""
    heads = ("mode", "frequency", "Q", "contact kg^-1/2", "drive N/V kg^-1/2", "tip per volt")
    columns = zip(*(lists[name] for name in MODE_LISTS), resonant_displacement(lists), strict=True)
    rows = [
        (
            str(number),
            f"{frequency:.1f} Hz" if frequency else "rigid",
            f"{0.5 / ratio:.4g}" if ratio else "-",
            f"{contact:.4g}",
            f"{drive:.4g}",
            format_si(peak, "m") if isfinite(peak) else "-",
        )
        for number, (frequency, ratio, drive, contact, peak) in enumerate(columns, start=1)
    ]
    return [title, *(f"  {note}" for note in notes), Table(heads, rows)]


def resonant_displacement(lists: Mapping[str, Floats]) -> Floats:
    """Displacement of the contact per volt in each mode alone at its frequency, in m/V; NaN without damping.

    |b c|/(2 zeta omega^2) of the drive participation b and the contact participation c.
    """
    stiffness = 2 * lists["damping_ratio"] * (2 * np.pi * lists["natural_frequency"]) ** 2
    driven = np.abs(lists["drive_participation"] * lists["contact_participation"])
    return np.asarray(np.divide(driven, stiffness, out=np.full(driven.shape, np.nan), where=stiffness > 0))


def foreign_object(lists: Mapping[str, Floats], structure: str) -> dict[str, Any]:
    """Structure as TOML, and frequency, damping, participations and tip amplitude per volt of each mode."""
    rows = zip(*(lists[name].tolist() for name in MODE_LISTS), resonant_displacement(lists).tolist(), strict=True)
    return {
        "structure": tomllib.loads(structure),
        "modes": [
            {
                **si({"natural_frequency": frequency, "damping_ratio": ratio}),
                **si({"drive_participation": drive}, unit=f"N/V {_PER_ROOT}"),
                **si({"contact_participation": contact}, unit=_PER_ROOT),
                **si({"displacement_per_volt": finite(peak)}),
            }
            for frequency, ratio, drive, contact, peak in rows
        ],
    }


def foreign_dataset(lists: Mapping[str, Floats]) -> "xr.Dataset":
    """Columns of a file of modes and tip amplitude per volt, over the number of the mode."""
    import xarray as xr

    units = {"natural_frequency": "Hz", "damping_ratio": "1", "drive_participation": f"N/V {_PER_ROOT}"}
    columns = {**lists, "displacement_per_volt": resonant_displacement(lists)}
    units |= {"contact_participation": _PER_ROOT, "displacement_per_volt": "m/V"}
    data = {name: ("mode", values, {"units": units[name]}) for name, values in columns.items()}
    return xr.Dataset(data, coords={"mode": np.arange(1, len(columns["natural_frequency"]) + 1)})


_PER_ROOT = "kg**-0.5"
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


_STRESS_HEADS = ("mode", "stack", "highest", "rod", "highest", "share of rod")


def stress_blocks(stresses: Mapping[str, Mapping[str, StackStress]], amplitude: float) -> list[Block]:
    """Stress amplitude and highest stress of stack and rod in each coupled mode."""
    blocks: list[Block] = []
    for name, modes in stresses.items():
        blocks.append(f"  {name}: axial stress at {format_si(amplitude, 'm')} of the working end, tension positive")
        rows = [
            (
                mode,
                format_si(each.stack_amplitude, "Pa"),
                format_si(each.highest_stack_stress, "Pa"),
                *([format_si(each.rod_amplitude, "Pa"), format_si(each.highest_rod_stress, "Pa")]),
                f"{each.rod_share:.1%}",
            )
            for mode, each in modes.items()
        ]
        blocks.append(Table(_STRESS_HEADS, rows))
    return blocks


def stress_object(modes: Mapping[str, StackStress]) -> list[dict[str, Any]]:
    """Stresses of stack and rod in each coupled mode, for JSON."""
    names = ("stack_amplitude", "highest_stack_stress", "rod_amplitude", "highest_rod_stress", "stack_mean", "rod_mean")
    return [
        {"name": mode, **si(picked(each, *names), unit="Pa"), **si(picked(each, "rod_share"), unit="")}
        for mode, each in modes.items()
    ]


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
