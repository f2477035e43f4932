"""Natural modes in files of other programs: universal files (UFF) and ASCII results of CalculiX (.frd), in SI."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import read_head, refuse_unreadable, require_channels, require_values
from sonolube.measurement.recordings.raw_table import refuse_library_errors
from sonolube.storage.user_files import input_bytes, require_file
from sonolube.text.units import convert

UNIVERSAL_FILE: Final = "universal file"
CALCULIX: Final = "CalculiX result"
_RIGID_GAP = 100.0  # ratio of the lowest elastic frequency to the highest of rigid motions
_RIGID_MOTIONS = 6  # of a free body
_LARGEST_FACTOR = 1e12  # between a unit of a file and that of SI
_SKEW = 0.02  # share of a complex shape out of phase that needs no caveat


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ModeShapes:
    """Natural modes of a structure with their shapes at nodes.

    Parameters
    ----------
    natural_frequency : ndarray, shape (m,)
        Zero for rigid motions. [Hz]
    damping_ratio : ndarray, shape (m,)
        Over critical damping; NaN where the file states none. []
    modal_mass : ndarray, shape (m,)
        Of the shapes as they are; NaN where the file states none. [kg]
    node : ndarray of int, shape (n,)
        Number of each node.
    position : ndarray, shape (n, 3)
        Of the nodes; NaN where the file has none. [m]
    shape : ndarray, shape (m, n, 3)
        Displacement along x, y and z per modal coordinate.
    format_name : str
        `UNIVERSAL_FILE` or `CALCULIX`.
    caveats : tuple of str
        What was done to the modes in reading, such as the real part of complex shapes.
    """

    natural_frequency: Floats
    damping_ratio: Floats
    modal_mass: Floats
    node: Integers
    position: Floats
    shape: Floats
    format_name: str
    caveats: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, slots=True)
class UnitSystem:
    """Units of a file without data on them; times are in seconds.

    Parameters
    ----------
    length_unit, force_unit : str
        Such as "mm" and "N", with which masses are in tonnes.
    """

    length_unit: str
    force_unit: str

    @property
    def scales(self) -> tuple[float, float]:
        """Metres and newtons of one unit of the file."""
        return (
            convert(1.0, from_unit=self.length_unit, to_unit="m"),
            convert(1.0, from_unit=self.force_unit, to_unit="N"),
        )


def read_mode_shapes(path: str | Path, *, units: UnitSystem | None = None) -> ModeShapes:
    r"""Natural modes of a universal file or an ASCII result file of CalculiX, in SI.

    Parameters
    ----------
    path : str or Path
        Data sets 55 with nodes in 2411 or 15 and units in 164, or a file .frd with displacements of natural modes.
    units : UnitSystem, optional
        Of a file that states none: a universal file without data set 164, and every result of CalculiX.

    Returns
    -------
    ModeShapes
        By frequency. Frequencies of up to six modes that lie a factor of 100 below all others become zero.

    Raises
    ------
    InvalidInput
        In one line that names the file: if it is of neither format, damaged, has no modes, or its units are not known
        or stated twice.

    Notes
    -----
    The mass unit is that of force over acceleration. A hysteretic loss factor :math:`\eta` of data set 55 becomes the
    damping ratio :math:`\eta/2`. A complex shape is turned by the phase that makes its real part greatest, and that
    part is taken; with the eigenvalue :math:`\lambda` the frequency is :math:`|\lambda|/2\pi`, the damping ratio
    :math:`-\mathrm{Re}\lambda/|\lambda|` and the modal mass :math:`|a|/2|\lambda|` of modal A, :math:`a`.
    """
    path = Path(path)
    head = read_head(path)
    with refuse_unreadable(path):
        if head.lstrip()[:2] == b"-1":
            require_file(path)
            found = _universal(path, units)
        elif head[:6].split() == [b"1C"] or path.suffix.lower() == ".frd":
            found = _frd(path, units)
        else:
            raise InvalidInput(f"{path}: is neither a universal file nor a result of CalculiX (.frd)")
    return _checked(found, path)


def _checked(found: ModeShapes, path: Path) -> ModeShapes:
    """Modes by frequency, finite, without negative values, and with rigid motions at zero."""
    stated = [np.where(np.isnan(each), 0.0, each) for each in (found.modal_mass, found.damping_ratio)]
    known = found.natural_frequency, found.shape, *stated
    if not all(np.all(np.isfinite(each)) for each in known):
        raise InvalidInput(f"{path}: a frequency, mass or displacement of a mode is not finite")
    if any(np.any(each < 0) for each in (found.natural_frequency, *stated)):
        raise InvalidInput(f"{path}: a mode has a negative frequency, modal mass or damping; it is no stable vibration")
    order = np.argsort(found.natural_frequency, kind="stable")
    frequency = found.natural_frequency[order]
    rigid = _rigid_count(frequency)
    caveats = list(found.caveats)
    if rigid and frequency[rigid - 1] > 0:
        caveats.append(
            f"{rigid} modes up to {frequency[rigid - 1]:.3g} Hz are taken for rigid motions, of frequency zero: the"
            f" next has {frequency[rigid]:.4g} Hz"
        )
        frequency[:rigid] = 0.0
    return ModeShapes(
        natural_frequency=frequency,
        damping_ratio=found.damping_ratio[order],
        modal_mass=found.modal_mass[order],
        node=found.node,
        position=found.position,
        shape=found.shape[order],
        format_name=found.format_name,
        caveats=tuple(caveats),
    )


def _rigid_count(frequency: Floats) -> int:
    """Number of modes, among the lowest six, far below all others."""
    last = min(_RIGID_MOTIONS, frequency.size - 1)
    return next((k for k in range(last, 0, -1) if frequency[k] > _RIGID_GAP * frequency[k - 1]), 0)


@dataclass(kw_only=True, slots=True)
class _Mode:
    """One mode as a file states it."""

    frequency: float
    node: Integers
    shape: Floats
    mass: float = math.nan
    damping: float = math.nan
    skew: float = 0.0


def _mode_shapes(
    modes: Sequence[_Mode],
    positions: dict[int, Floats],
    scales: tuple[float, float],
    *,
    format_name: str,
    path: Path,
    caveats: Sequence[str] = (),
) -> ModeShapes:
    """Modes at the nodes of all; a node that a mode leaves out does not move in it."""
    numbers = np.unique(np.concatenate([*(mode.node for mode in modes), np.array([*positions], dtype=np.int64)]))
    require_values(3 * numbers.size * len(modes), path)
    shape = np.zeros((len(modes), numbers.size, 3))
    for k, mode in enumerate(modes):
        shape[k, np.searchsorted(numbers, mode.node)] = mode.shape
    length, force = scales
    nowhere = np.full(3, np.nan)
    return ModeShapes(
        natural_frequency=np.array([mode.frequency for mode in modes]),
        damping_ratio=np.array([mode.damping for mode in modes]),
        modal_mass=np.array([mode.mass for mode in modes]) * force / length,
        node=numbers,
        position=length * np.array([positions.get(int(number), nowhere) for number in numbers]),
        shape=shape,
        format_name=format_name,
        caveats=tuple(caveats),
    )


def _given_scales(units: UnitSystem | None, path: Path, why: str) -> tuple[float, float]:
    if units is None:
        raise InvalidInput(f"{path}: {why}; give length_unit and force_unit, such as mm and N")
    return units.scales


# Universal files

_NODES = (2411, 15)
_NORMAL_MODE = 2
_COMPLEX_MODES = (3, 7)
_TRANSLATIONS = (2, 3)  # data characteristics: with and without rotations
_DISPLACEMENTS = (0, 1, 8)  # specific data types: unknown, general, displacement


def _universal(path: Path, units: UnitSystem | None) -> ModeShapes:
    """Modes of the data sets 55 of a universal file."""
    import pyuff

    with refuse_library_errors(path, format_name=UNIVERSAL_FILE), np.errstate(all="ignore"):
        file = pyuff.UFF(str(path))
        types = np.atleast_1d(file.get_set_types())
        require_channels(types.size, path, kind="data sets")
        rows = {number: np.flatnonzero(types == number) for number in (55, *_NODES, 164)}
        sets = {number: [file.read_sets(int(row)) for row in found] for number, found in rows.items()}
        shapes = [each for each in sets[55] if _is_shape(each)]
        modes = [_universal_mode(each) for each in shapes]
        positions = {k: v for number in reversed(_NODES) for each in sets[number] for k, v in _positions(each).items()}
        own = _own_scales(sets[164])
    if not modes:
        raise InvalidInput(f"{path}: holds no mode shape (data set 55 of normal or complex modes, displacements)")
    if own is not None and units is not None:
        raise InvalidInput(f"{path}: states its units in data set 164; leave out length_unit")
    scales = own or _given_scales(units, path, "states no units (data set 164)")
    skew = max(mode.skew for mode in modes)
    caveats = [
        f"of complex shapes the real part at the best phase is taken; up to {skew:.0%} of a shape is out of phase"
    ] * (skew > _SKEW)
    return _mode_shapes(modes, positions, scales, format_name=UNIVERSAL_FILE, path=path, caveats=caveats)


def _is_shape(data: dict[str, Any]) -> bool:
    """Whether a data set 55 holds displacements of a natural mode."""
    return (
        data["analysis_type"] in (_NORMAL_MODE, *_COMPLEX_MODES)
        and data["data_ch"] in _TRANSLATIONS
        and data["spec_data_type"] in _DISPLACEMENTS
    )


def _universal_mode(data: dict[str, Any]) -> _Mode:
    """Mode of one data set 55."""
    node = np.asarray(data["node_nums"], dtype=np.int64)
    values = np.column_stack([data["r1"], data["r2"], data["r3"]])
    if values.shape != (node.size, 3):
        raise ValueError(f"{node.size} nodes with displacements of {len(values)}")
    shape, skew = _real_shape(values)
    if data["analysis_type"] == _NORMAL_MODE:
        damping = data["modal_damp_vis"] or data["modal_damp_his"] / 2 or math.nan
        return _Mode(
            frequency=float(data["freq"]),
            node=node,
            shape=shape,
            mass=data["modal_m"] or math.nan,
            damping=damping,
            skew=skew,
        )
    omega = abs(data["eig"])
    return _Mode(
        frequency=omega / (2 * math.pi),
        node=node,
        shape=shape,
        mass=abs(data["modal_a"]) / (2 * omega) or math.nan if omega else math.nan,
        damping=-data["eig"].real / omega or math.nan if omega else math.nan,
        skew=skew,
    )


def _real_shape(values: Any) -> tuple[Floats, float]:
    """Real part of a shape at the phase at which it is greatest, and the share out of phase."""
    if not np.iscomplexobj(values):
        return np.asarray(values, dtype=np.float64), 0.0
    turned = values * np.exp(-0.5j * np.angle(np.sum(values**2)))
    size = float(np.linalg.norm(turned))
    return np.ascontiguousarray(turned.real), float(np.linalg.norm(turned.imag)) / size if size else 0.0


def _positions(data: dict[str, Any]) -> dict[int, Floats]:
    """Positions of nodes in the unit of the file, by number."""
    number = np.asarray(data["node_nums"], dtype=np.float64)
    place = np.column_stack([data["x"], data["y"], data["z"]]).astype(np.float64)
    if not (np.all(np.isfinite(number)) and np.all(np.isfinite(place)) and np.all(abs(number) < 2**53)):
        raise ValueError("a node is not finite")
    return {int(each): row for each, row in zip(number, place, strict=True)}


def _own_scales(sets: Sequence[dict[str, Any]]) -> tuple[float, float] | None:
    """Metres and newtons of one unit of the file: its numbers are to be divided by the factors of data set 164."""
    if not sets:
        return None
    factors = float(sets[0]["length"]), float(sets[0]["force"])
    if not all(_LARGEST_FACTOR > each > 1 / _LARGEST_FACTOR for each in factors):
        raise ValueError("a factor of data set 164 is none between units")
    return 1 / factors[0], 1 / factors[1]


# CalculiX

_FREQUENCY_STEP = b" 2"  # type of a result block in columns 57 and 58 of its record 100C
_WIDTHS = {b"0": 5, b"1": 10}  # of node numbers by the digit in column 75: short and long ASCII


@dataclass(slots=True)
class _FrdState:
    """What was read of an .frd file so far."""

    positions: dict[int, Floats] = field(default_factory=dict)
    modes: list[_Mode] = field(default_factory=list)
    mass: float = math.nan
    frequency: float = math.nan
    width: int = 10
    is_mode: bool = False


def _frd(path: Path, units: UnitSystem | None) -> ModeShapes:
    """Modes of the displacements in the frequency steps of an .frd file."""
    scales = _given_scales(units, path, "results of CalculiX have no units")
    with refuse_library_errors(path, format_name=CALCULIX):
        state = _frd_state(input_bytes(path).splitlines(), path)
    if not state.modes:
        raise InvalidInput(f"{path}: holds no natural mode (*FREQUENCY with *NODE FILE, U)")
    return _mode_shapes(state.modes, state.positions, scales, format_name=CALCULIX, path=path)


def _frd_state(lines: Sequence[bytes], path: Path) -> _FrdState:
    """Nodes and modes of the lines of an .frd file."""
    state, at = _FrdState(), 0
    while at < len(lines):
        line = lines[at]
        at += 1
        if line[:6] == b"    2C":
            end = _end(lines, at)
            number, place = _nodal(lines[at:end], _width(line, path))
            state.positions = {int(each): row for each, row in zip(number, place, strict=True)}
            at = end
        elif line[:9] == b"    1PGM ":
            state.mass = float(line[9:])
        elif line[:6] == b"  100C":
            state.is_mode, state.frequency = line[56:58] == _FREQUENCY_STEP, float(line[12:24])
            state.width = _width(line, path)
        elif line[:7] == b" -4  DI" and state.is_mode:
            at = _frd_mode(state, lines, at, path)
    return state


def _frd_mode(state: _FrdState, lines: Sequence[bytes], at: int, path: Path) -> int:
    """Add the mode whose block of displacements begins here; the line behind it."""
    if lines[at - 1][5:13].strip() != b"DISP":
        raise InvalidInput(f"{path}: line {at}: has complex modes; export real ones (*FREQUENCY without symmetry)")
    while at < len(lines) and lines[at][:3] == b" -5":
        at += 1
    end = _end(lines, at)
    node, shape = _nodal(lines[at:end], state.width)
    state.modes.append(_Mode(frequency=state.frequency, node=node, shape=shape, mass=state.mass))
    require_channels(len(state.modes), path, kind="modes")
    state.mass = math.nan
    return end


def _width(line: bytes, path: Path) -> int:
    """Width of the node numbers of a block by its header."""
    digit = line[73:75].strip()
    if digit not in _WIDTHS:
        raise InvalidInput(f"{path}: a block is in binary form, or cut; write results as text (*NODE FILE)")
    return _WIDTHS[digit]


def _end(lines: Sequence[bytes], start: int) -> int:
    """Line that ends a block."""
    for at in range(start, len(lines)):
        if lines[at][:3] == b" -3":
            return at
    raise ValueError(f"the block of line {start} has no end (-3)")


def _nodal(lines: Sequence[bytes], width: int) -> tuple[Integers, Floats]:
    """Numbers of nodes and three values at each, of twelve columns."""
    stop = 3 + width + 36
    rows = [line[:stop] for line in lines]
    if any(len(row) != stop or row[:3] != b" -1" for row in rows):
        raise ValueError("a node is not ' -1', its number and three values of twelve columns")
    if not rows:
        return np.empty(0, dtype=np.int64), np.empty((0, 3))
    table = np.frombuffer(b"".join(rows), dtype="S1").reshape(len(rows), stop)
    number = np.ascontiguousarray(table[:, 3 : 3 + width]).view(f"S{width}").ravel().astype(np.int64)
    values = np.ascontiguousarray(table[:, 3 + width :]).view("S12").astype(np.float64)
    if not np.all(np.isfinite(values)):
        raise ValueError("a value at a node is not finite")
    return number, values
