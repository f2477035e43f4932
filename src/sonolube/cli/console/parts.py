"""Parts, horns and transducers from a name or a STEP file and sizes such as length=127mm."""

import inspect
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.cli.console.number_table import number_table
from sonolube.errors import InvalidInput
from sonolube.facts.materials import Material
from sonolube.models.fem import generate_mesh
from sonolube.units import to_si
from sonolube.workbench.named_parts import ALL_TRANSDUCERS, PART_WIRING, is_step, longest_axis, step_part

if TYPE_CHECKING:
    from sonolube.design.horn_shapes import TunableBody

SIZE_ENTRY = "as --set "
"""Prefix by which a refusal names the option for a size."""

_COARSE = 0.02  # m, fine enough to show the longest axis of most parts


def ceramic_of(part: str, ceramic: str | None) -> str:
    """Name of the ceramic of a transducer, or of a part between two electrodes.

    Parameters
    ----------
    part : str
        As in `named_transducer`.
    ceramic : str or None
        As given; None for that of the part.

    Returns
    -------
    str
    """
    if ceramic is not None or part not in ALL_TRANSDUCERS:
        return ceramic or PART_WIRING["ceramic"]
    return str(inspect.signature(ALL_TRANSDUCERS[part]).parameters["ceramic"].default)


def named_horn(
    shape: str,
    sizes: Sequence[str],
    *,
    frequency: float,
    solid: Material,
    tune: str,
    axis: str | None,
    gain: float | None = None,
) -> "TunableBody":
    """Horn by its shape and sizes, or of a STEP file.

    Parameters
    ----------
    shape : str
        A name of `SHAPES`, or a path that ends in .step or .stp.
    sizes : sequence of str
        Such as "radius=20mm".
    frequency : float
        Target of the frequency of its mode. [Hz]
    solid : Material
    tune : str
        Size that is tuned.
    axis : str or None
        Axis of the part of a STEP file; its longest where absent.
    gain : float, optional
        Displacement gain by which the radius of the working end is chosen.

    Returns
    -------
    TunableBody
    """
    from sonolube.design.horn_shapes import body_from_geometry, horn_body

    if is_step(shape):
        geometry = step_part(shape, sizes_by_name(sizes))
        return body_from_geometry(geometry, axis=axis or longest_axis(generate_mesh(geometry, element_size=_COARSE)))
    lengths = {name: to_si(text, unit="m", name=name) for name, text in sizes_by_name(sizes).items()}
    speed = (solid.value("youngs_modulus") / solid.value("density")) ** 0.5
    return horn_body(shape, frequency=frequency, wave_speed=speed, sizes=lengths, tune=tune, gain=gain)


def require_axis(**axes: str | None) -> None:
    """Raise for an axis that is none of x, y and z; each keyword is an option, not given where None."""
    for option, axis in axes.items():
        if axis is not None and axis not in ("x", "y", "z"):
            raise InvalidInput(f"--{option} must be x, y or z, got {axis!r}")


def points_in_metres(path: Path) -> Floats:
    """Points in m from a CSV table of x, y and z in mm, shape (p, 3).

    Raises
    ------
    InvalidInput
        If the file is no such table.
    """
    points = number_table(path)
    if points.shape[1] != 3 or not np.all(np.isfinite(points)):
        raise InvalidInput(f"{path}: needs the three columns x, y and z in mm, got {points.shape[1]}")
    return np.asarray(1e-3 * points)


def sizes_by_name(sizes: Sequence[str]) -> dict[str, str]:
    """Text of each size of entries NAME=VALUE, such as "length=127mm".

    Raises
    ------
    InvalidInput
        If a size was given twice.
    """
    texts: dict[str, str] = {}
    for entry in sizes:
        name, _, text = entry.partition("=")
        if name in texts:
            raise InvalidInput(f"--set {name} was given twice")
        texts[name] = text
    return texts
