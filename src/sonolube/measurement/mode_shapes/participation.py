"""Participation of a contact and a stack in modes of another program, by nodes or points of its mesh."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, require_finite, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.mode_shapes.formats import ModeShapes
from sonolube.text.units import format_si, to_si

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
_AXIS = re.compile(r"[-+]?[xyz]")
_FAR = 0.05  # of the longest side of all nodes, beyond which a point lies beside the body


@dataclass(frozen=True, kw_only=True, slots=True)
class FoundNode:
    """Node that a text names, or that lies nearest to a point.

    Parameters
    ----------
    row : int
        Of the node among those of the modes.
    number : int
    distance : float
        From the point in m; zero where the node was named.
    """

    row: int
    number: int
    distance: float = 0.0


def find_node(modes: ModeShapes, place: str, *, name: str) -> FoundNode:
    """Node by its number, or nearest to a point.

    Parameters
    ----------
    modes : ModeShapes
    place : str
        Number such as "1207", or coordinates such as "0, 0, 50 mm", each with its unit or all with the last one's.
    name : str
        What is placed, for a refusal.

    Returns
    -------
    FoundNode

    Raises
    ------
    InvalidInput
        If there is no such node, no positions, or none within 5 % of the longest side of the body.
    """
    text = str(place).strip()
    if text.isascii() and text.isdecimal():
        rows = np.flatnonzero(modes.node == int(text[:18]))
        if not rows.size:
            ends = f"{modes.node[0]} to {modes.node[-1]}" if modes.node.size else "none"
            raise InvalidInput(f"{name} {place}: no such node; numbers of nodes are {ends}")
        return FoundNode(row=int(rows[0]), number=int(modes.node[rows[0]]))
    point = _point(text, name)
    distance = np.linalg.norm(modes.position - point, axis=1)
    if np.all(np.isnan(distance)):
        raise InvalidInput(f"{name} {place}: the file has no positions of nodes; give the number of one")
    row = int(np.nanargmin(distance))
    side = float(np.max(np.nanmax(modes.position, axis=0) - np.nanmin(modes.position, axis=0)))
    if distance[row] > _FAR * side:
        at = ", ".join(format_si(each, "m") for each in modes.position[row])
        raise InvalidInput(
            f"{name} {place}: the nearest node, {modes.node[row]} at {at}, is {format_si(float(distance[row]), 'm')}"
            " away; the point lies outside the body"
        )
    return FoundNode(row=row, number=int(modes.node[row]), distance=float(distance[row]))


def direction_vector(text: str, *, name: str) -> Floats:
    """Unit vector of a direction such as "+x", "-z" or "0, 0.6, 0.8".

    Parameters
    ----------
    text : str
    name : str
        Of the argument, for a refusal.

    Returns
    -------
    ndarray, shape (3,)

    Raises
    ------
    InvalidInput
        If the text is no direction.
    """
    word = text.strip()
    if _AXIS.fullmatch(word):
        return np.asarray((-1.0 if word[0] == "-" else 1.0) * np.eye(3)["xyz".index(word[-1])])
    parts = [part.strip() for part in word.split(",")]
    vector = np.array([float(part) if _NUMBER.fullmatch(part) else np.nan for part in parts])
    length = float(np.linalg.norm(vector)) if vector.size == 3 else 0.0
    if not (np.isfinite(length) and length > 0):
        raise InvalidInput(f"{name} {text} must look like +x, -z or 0,0.6,0.8")
    return np.asarray(vector / length)


def contact_participation(modes: ModeShapes, tip: Sequence[FoundNode], *, outward: Floats) -> Floats:
    """Displacement of a contact away from the other body, per coordinate of each mode, mean over its nodes.

    Parameters
    ----------
    modes : ModeShapes
        As they are scaled in their file.
    tip : sequence of FoundNode
    outward : ndarray, shape (3,)
        Unit vector towards the other body.

    Returns
    -------
    ndarray, shape (m,)
    """
    mean = modes.shape[:, [each.row for each in tip]].mean(axis=1)
    return np.asarray(-mean @ require_finite(outward=outward))


def port_participation(modes: ModeShapes, port: tuple[FoundNode, FoundNode], *, name: str) -> Floats:
    """Elongation of a stack between two nodes, per coordinate of each mode.

    Parameters
    ----------
    modes : ModeShapes
        As they are scaled in their file.
    port : tuple of FoundNode
        Ends of the stack, in any order.
    name : str
        Of the argument, for a refusal.

    Returns
    -------
    ndarray, shape (m,)

    Raises
    ------
    InvalidInput
        If the ends lie at one place, or nowhere.
    """
    first, second = (each.row for each in port)
    line = modes.position[second] - modes.position[first]
    length = float(np.linalg.norm(line))
    if not length > 0:
        raise InvalidInput(f"{name}: needs two ends of the stack at different positions of nodes")
    return np.asarray((modes.shape[:, second] - modes.shape[:, first]) @ (line / length))


def modal_lists(
    modes: ModeShapes,
    *,
    contact: Floats,
    drive: Floats,
    modal_mass: float | None = None,
    quality_factor: float | None = None,
) -> dict[str, Floats]:
    """Columns of a file of modes, by name, for shapes of a modal mass of 1 kg.

    Parameters
    ----------
    modes : ModeShapes
    contact : ndarray, shape (m,)
        Displacement of the contact per coordinate, in the scale of the file.
    drive : ndarray, shape (m,)
        Force per voltage in N/V, in the same scale.
    modal_mass : float, optional
        Of modes whose file states none. [kg]
    quality_factor : float, optional
        Of modes whose file states no damping. []

    Returns
    -------
    dict of str to ndarray, shape (m,)
        `natural_frequency`, `damping_ratio`, zero for rigid motions, `drive_participation`, `contact_participation`.

    Raises
    ------
    InvalidInput
        If a modal mass or the damping of an elastic mode is not known, a value is given that no mode needs, or a
        participation is zero in all modes.
    """
    elastic = modes.natural_frequency > 0
    mass = _filled(
        modes.modal_mass, modal_mass, needed=np.isnan(modes.modal_mass), name="modal_mass", text="modal mass"
    )
    ratio = None if quality_factor is None else 0.5 / float(require_positive(quality_factor=quality_factor))
    lacks = np.isnan(modes.damping_ratio) & elastic
    damping = _filled(modes.damping_ratio, ratio, needed=lacks, name="quality_factor", text="damping")
    lists = {
        "natural_frequency": modes.natural_frequency,
        "damping_ratio": np.where(elastic, damping, 0.0),
        "drive_participation": require_finite(drive=drive) / np.sqrt(mass),
        "contact_participation": require_finite(contact=contact) / np.sqrt(mass),
    }
    for name, what in (("drive_participation", "stack is strained"), ("contact_participation", "contact moves")):
        if not np.any(lists[name][elastic]):
            raise InvalidInput(
                f"the {what} in none of the {int(elastic.sum())} elastic modes; check places and direction"
            )
    return lists


_RESIDUAL_FREQUENCY = 4.0  # of the mode of all truncated ones, over the highest of the file
_LAST = 0.5  # of the elastic modes, by whose upper part those above are estimated


def with_static_correction(
    lists: Mapping[str, Floats], *, static_compliance: float, displacement_per_volt: float, clamped_capacitance: float
) -> tuple[dict[str, Floats], float]:
    r"""Modes with one more for the static share of all truncated ones, and the capacitance with that held too.

    Parameters
    ----------
    lists : mapping of str to ndarray, shape (m,)
        Columns of a file of modes for a modal mass of 1 kg.
    static_compliance : float
        Displacement of the contact per static force on it, by all modes but the rigid ones. [m/N]
    displacement_per_volt : float
        Displacement of the contact per static voltage, by all modes but the rigid ones. [m/V]
    clamped_capacitance : float
        With the modes of the file held. [F]

    Returns
    -------
    dict of str to ndarray, shape (m + 1,)
    float
        In F.

    Raises
    ------
    InvalidInput
        If the modes alone are as compliant, or the correction has more capacitance than is held.

    Notes
    -----
    .. math::

        c_r = c_s - \sum_k \frac{\phi_k^2}{\omega_k^2}, \qquad
        u_r = u_s - \sum_k \frac{\phi_k b_k}{\omega_k^2}, \qquad
        \phi_r = \omega_r \sqrt{c_r}, \quad b_r = \omega_r u_r/\sqrt{c_r}

    with a frequency four times that of the highest mode, so that the added mode is static within 2 % up to half of that
    highest one. The share of the truncated modes in the capacitance, (u_r)^2/c_r by the added one, moves to it. Of a
    free body the static values are those with the inertia of its rigid motions (inertia relief).
    """
    omega = 2 * np.pi * lists["natural_frequency"]
    elastic = omega > 0
    drive, contact = lists["drive_participation"][elastic], lists["contact_participation"][elastic]
    kept = kept_compliance(lists)
    c_r = float(require_finite(static_compliance=static_compliance)) - kept
    if not c_r > 0:
        raise InvalidInput(
            f"static_compliance {static_compliance:.4g} m/N must exceed {kept:.4g} m/N, that of the modes of the file;"
            " of a free body it is without rigid motions, by inertia relief"
        )
    u_r = float(require_finite(displacement_per_volt=displacement_per_volt))
    u_r -= float(np.sum(drive * contact / omega[elastic] ** 2))
    left = clamped_capacitance - u_r**2 / c_r
    if not left > 0:
        raise InvalidInput(
            f"displacement_per_volt leaves {u_r:.4g} m/V to the truncated modes, whose capacitance {u_r**2 / c_r:.4g} F"
            f" exceeds clamped_capacitance {clamped_capacitance:.4g} F; it is positive away from the other body"
        )
    highest = _RESIDUAL_FREQUENCY * float(omega.max())
    added = {
        "natural_frequency": highest / (2 * np.pi),
        "damping_ratio": float(lists["damping_ratio"][np.argmax(omega)]),
        "drive_participation": highest * u_r / np.sqrt(c_r),
        "contact_participation": highest * np.sqrt(c_r),
    }
    return {name: np.append(values, added[name]) for name, values in lists.items()}, left


def kept_compliance(lists: Mapping[str, Floats]) -> float:
    """Static compliance of the contact by the elastic modes of a file, for a modal mass of 1 kg. [m/N]"""
    omega = 2 * np.pi * lists["natural_frequency"]
    elastic = omega > 0
    return float(np.sum((lists["contact_participation"][elastic] / omega[elastic]) ** 2))


def truncated_compliance(lists: Mapping[str, Floats]) -> float:
    r"""Estimated static compliance of the contact by the modes above those of a file. [m/N]

    Parameters
    ----------
    lists : mapping of str to ndarray, shape (m,)
        Columns of a file of modes for a modal mass of 1 kg.

    Returns
    -------
    float
        NaN with fewer than two elastic modes.

    Notes
    -----
    .. math:: c_r \approx \frac{\overline{\phi^2}}{\Delta\omega\, (\omega_n + \Delta\omega/2)}

    if the modes above go on with the mean square participation and the mean distance of the upper half of those below,
    which a slender bar does. Bodies that are wide beside the wavelength have more modes, and a larger sum.
    """
    omega = 2 * np.pi * lists["natural_frequency"]
    order = np.argsort(omega)
    order = order[omega[order] > 0]
    if order.size < 2:
        return float("nan")
    last = order[int(_LAST * (order.size - 1)) :]
    spacing = float(omega[last[-1]] - omega[last[0]]) / (last.size - 1)
    square = float(np.mean(lists["contact_participation"][last] ** 2))
    return square / (spacing * (float(omega[last[-1]]) + spacing / 2)) if spacing > 0 else float("nan")


def _filled(values: Floats, value: float | None, *, needed: NDArray[np.bool_], name: str, text: str) -> Floats:
    """Values of a file, those that it lacks replaced by the one given."""
    if value is None and np.any(needed):
        raise InvalidInput(f"the file states no {text} of {int(needed.sum())} of {needed.size} modes; give {name}")
    if value is None:
        return values
    if not np.any(needed):
        raise InvalidInput(f"{name}: the file states the {text} of every mode; leave it out")
    return np.where(np.isnan(values), float(require_positive(**{name: value})), values)


def _point(text: str, name: str) -> Floats:
    """Point in m of three coordinates, each with a unit or all with that of the last."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 3:
        raise InvalidInput(f"{name} {text} must be the number of a node, or a point such as 0,0,50mm")
    found = _NUMBER.match(parts[2])
    unit = parts[2][found.end() :].strip() if found else ""
    with_units = [f"{part} {unit}" if _NUMBER.fullmatch(part) else part for part in parts]
    return np.array([to_si(part, unit="m", name=name) for part in with_units])
