"""Solid geometry in the optional CAD kernel (OpenCASCADE through netgen-mesher), and STEP files.

The CAD kernel works in mm, for which its tolerances are set; everything else is in m. Plane faces at the ends of a body
along an axis are named "-x", "+x", "-y", "+y", "-z" and "+z", all others "side". A STEP file is read on trial in a
process of its own, with limits of time and memory.
"""

import ctypes
import os
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from threading import RLock
from typing import Any, Final

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.extras import missing_package

MILLIMETRE = 1e-3
"""Length unit of the CAD kernel, in m."""

_STREAMS = (1, 2)  # file descriptors of standard output and error
_REDIRECTION = RLock()  # file descriptors belong to the process, not to a thread


def cad_kernel() -> Any:
    """CAD kernel, the module `netgen.occ`, of which bodies of other shapes are made.

    Returns
    -------
    module
        Its lengths are millimetres; `MILLIMETRE` is one in metres.

    Raises
    ------
    MissingPackage
        If netgen is not installed.
    """
    try:
        return import_module("netgen.occ")
    except ImportError:
        raise missing_package("fem") from None


@contextmanager
def captured_output() -> Iterator[list[str]]:
    """Context in which text printed by the CAD kernel is captured instead of reaching standard output and error.

    The distinct lines printed, filled on leaving the context.
    """
    lines: list[str] = []
    with _REDIRECTION, TemporaryFile() as file:
        _flush()
        saved = [os.dup(stream) for stream in _STREAMS]
        try:
            for stream in _STREAMS:
                os.dup2(file.fileno(), stream)
            yield lines
        finally:
            _flush()
            for stream, original in zip(_STREAMS, saved, strict=True):
                os.dup2(original, stream)
                os.close(original)
            file.seek(0)
            printed = file.read().decode(errors="replace").splitlines()
            lines += dict.fromkeys(line.strip() for line in printed if line.strip())


def _flush() -> None:
    """Flush the buffers of Python and of the C library, so that text stays on its side of the redirection."""
    sys.stdout.flush()
    sys.stderr.flush()
    with suppress(AttributeError, OSError, TypeError):  # platforms without a C library of this name
        ctypes.CDLL(None).fflush(None)


_SECONDS: Final = 60  # of processor time
_WAIT: Final = 300  # s, for a machine that gives the process a fifth of a processor
_BYTES: Final = 4 * 2**30
_REFUSED: Final = 3  # exit status of the trial where it refuses the file
_TRIAL: Final = (
    "from sonolube.models.fem.mesh.geometry import unguarded_step_geometry;"
    "from sonolube.models.fem.mesh.geometry import run_trial;"
    "run_trial(unguarded_step_geometry)"
)


def try_step_file(path: Path) -> None:
    """Raise where reading a STEP file refuses it, ends the program, or needs too much time or memory."""
    command = [sys.executable, "-c", _TRIAL, str(path)]
    try:
        ended = subprocess.run(command, capture_output=True, check=False, timeout=_WAIT)
    except subprocess.TimeoutExpired:
        raise InvalidInput(f"{path}: not read within {_WAIT} s; export it anew, with fewer faces") from None
    if ended.returncode == _REFUSED:
        raise InvalidInput(ended.stderr.decode(errors="replace").strip().splitlines()[-1])
    if ended.returncode:
        raise InvalidInput(
            f"{path}: the CAD kernel ends on it without an answer, or needs more than {_SECONDS} s or"
            f" {_BYTES >> 30} GiB: the file is damaged or too large; export it anew"
        )


def run_trial(read: Callable[[Path], object]) -> None:
    """Read the file that the command line of this process names within the limits; print a refusal and exit with it."""
    _limit()
    try:
        read(Path(sys.argv[1]))
    except InvalidInput as refusal:
        sys.stderr.write(f"{refusal}\n")
        sys.exit(_REFUSED)


def _limit() -> None:
    """Limit the time and the memory of this process, where the system can."""
    with suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_CPU, (_SECONDS, _SECONDS))
        resource.setrlimit(resource.RLIMIT_AS, (_BYTES, _BYTES))


_AXES = "xyz"
_MIN_VOLUME = 1e-9  # of the bounding box, below which a body counts as having no thickness
_TIME_OF_WRITING = re.compile(r"(?<=')\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(?=')")
_NUMBER_OF_WRITING = re.compile(r"(?<= STEP translator )([\d.]+) \d+(?=')")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Geometry:
    """Solid bodies with conforming shared faces where they touch.

    Parameters
    ----------
    shape : netgen.occ.TopoDS_Shape
        Solids with lengths in mm.
    regions : tuple of str
        Names of the bodies, in the order of the shape's solids.
    """

    shape: Any
    regions: tuple[str, ...]

    @property
    def volume(self) -> float:
        """Total volume of the bodies, in m3."""
        return float(sum(solid.mass for solid in self.shape.solids)) * MILLIMETRE**3


def read_step(path: Path) -> Geometry:
    """Solids of a STEP file as a geometry, bonded where they touch.

    Parameters
    ----------
    path : Path
        The STEP file.

    Returns
    -------
    Geometry
        Regions carry the names of the solids in the file, "body1", "body2", ... where these have none.

    Raises
    ------
    InvalidInput
        If the file cannot be read, contains no closed solid, or its solids overlap.

    Notes
    -----
    The CAD kernel ends the program, or never ends, on some damaged files. A process of its own with limits of time and
    memory reads the file first.
    """
    if not path.is_file():
        raise InvalidInput(f"{path}: no such file")
    cad_kernel()  # a package that is missing is said before the trial
    try_step_file(path)
    return unguarded_step_geometry(path)


def unguarded_step_geometry(path: Path) -> Geometry:
    """Solids of a STEP file as `read_step`, in this process, which a damaged file can end."""
    occ = cad_kernel()
    try:
        with captured_output():
            shape = occ.OCCGeometry(str(path)).shape
    except Exception as failure:  # the kernel raises no narrower class
        raise InvalidInput(f"{path}: not a STEP file that can be read: {failure}") from None
    solids = list(shape.solids)
    if not solids:
        raise InvalidInput(f"{path}: no closed solid in it; sew its surfaces into one before exporting")
    if any(map(_has_open_face, solids)):
        raise InvalidInput(f"{path}: an edge of a face is missing, so that it is open; export it anew")
    parts = {
        solid.name or f"body{k}": single_body(solid, solid.name or f"body{k}") for k, solid in enumerate(solids, 1)
    }
    return bond(parts) if len(parts) > 1 else next(iter(parts.values()))


def _has_open_face(solid: Any) -> bool:
    """Whether the edges about a face of a solid lead nowhere, which a mesher never fills: one lacks in the file."""
    for wire in (wire for face in solid.faces for wire in face.wires):
        ends = Counter(hash(vertex) for edge in wire.edges for vertex in edge.vertices)
        if any(count % 2 for count in ends.values()):
            return True
    return False


def step_text(geometry: Geometry) -> str:
    """Content of a STEP file of a geometry, in mm, without time and number of writing.

    Parameters
    ----------
    geometry : Geometry

    Returns
    -------
    str
    """
    with TemporaryDirectory() as folder, captured_output():
        path = Path(folder) / "solid.step"
        geometry.shape.WriteStep(str(path))
        text = path.read_text(encoding="utf-8")
    return _NUMBER_OF_WRITING.sub(r"\1", _TIME_OF_WRITING.sub("1970-01-01T00:00:00", text, count=1))


def translate(geometry: Geometry, *, by: tuple[float, float, float]) -> Geometry:
    """Geometry translated by a vector.

    Parameters
    ----------
    geometry : Geometry
    by : tuple of three float
        Translation vector, in m.

    Returns
    -------
    Geometry
    """
    shift = tuple(component / MILLIMETRE for component in by)
    return Geometry(shape=geometry.shape.Move(shift), regions=geometry.regions)


def bond(parts: Mapping[str, Geometry]) -> Geometry:
    """Assembly of bodies perfectly bonded where they touch: their contact faces become shared.

    Parameters
    ----------
    parts : mapping of str to Geometry
        One body each, by the name of its region in the assembly.

    Returns
    -------
    Geometry
        Free faces are named "part.+z", "part.side" and so on, shared ones "one|other".

    Raises
    ------
    InvalidInput
        If bodies overlap, or a part is not one body.
    """
    occ, shapes = cad_kernel(), []
    for name, part in parts.items():
        if len(part.regions) != 1:
            raise InvalidInput(f"{name} must be one body, got {len(part.regions)}")
        solid = part.shape.solids[0]
        for face in solid.faces:
            face.name = f"{name}.{face.name or 'side'}"
        shapes.append(solid.mat(name))
    glued = occ.Glue(shapes)
    names = [solid.name for solid in glued.solids]
    sum_of_parts = sum(shape.mass for shape in shapes)  # the kernel's mass is the volume
    total = sum(solid.mass for solid in glued.solids)
    if sorted(names) != sorted(parts) or abs(total - sum_of_parts) > 1e-6 * sum_of_parts:
        raise InvalidInput(f"the bodies {', '.join(parts)} overlap; move them apart until they only touch")
    return Geometry(shape=glued, regions=tuple(names))


def single_body(shape: Any, name: str) -> Geometry:
    """Geometry of one closed body, with its end faces named.

    Parameters
    ----------
    shape : shape of the CAD kernel
        In mm.
    name : str
        Of its region.

    Returns
    -------
    Geometry
        Faces "+x", "-x" and so on lie at the ends of the body, all others are "side".

    Raises
    ------
    InvalidInput
        If the shape is not one body, or has no volume.
    """
    solids = list(shape.solids)
    if len(solids) != 1:
        raise InvalidInput(f"{name} must be one closed body with a volume, got {len(solids)} solids")
    solid = solids[0]
    low, high = (np.array([corner.x, corner.y, corner.z]) for corner in solid.bounding_box)
    if not solid.mass > _MIN_VOLUME * np.prod(high - low):
        raise InvalidInput(f"{name} must be one closed body with a volume: it has no thickness, or its faces cut it")
    for face in solid.faces:
        centre = np.array([face.center.x, face.center.y, face.center.z])
        ends = [(axis, end) for axis in range(3) for end in (low, high) if _is_at(centre, end, high - low, axis)]
        face.name = ("+" if ends[0][1] is high else "-") + _AXES[ends[0][0]] if ends else "side"
    return Geometry(shape=solid.mat(name), regions=(name,))


def _is_at(centre: Any, end: Any, extent: Any, axis: int) -> bool:
    """Whether a face's centre lies at one end of the bounding box along an axis."""
    # The kernel enlarges the bounding box of curved bodies by a few thousandths of its size.
    return bool(abs(centre[axis] - end[axis]) < 0.008 * extent[axis])
