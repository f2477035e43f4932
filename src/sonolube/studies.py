"""Studies: packages that judge a publication by sonolube, found by their entry points, with the hardware they define.

A package adds a study by an object of the form `Study` and one line in its pyproject.toml::

    [project.entry-points."sonolube.studies"]
    dong2015 = "dong2015.study:STUDY"

Commands find horns and transducers of a study by their names; `sonolube reproduce` runs the study of the dissertation.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Protocol

from sonolube.errors import InvalidInput, MissingPackage, UnknownName

if TYPE_CHECKING:
    from sonolube.design.horns.face import HornFace
    from sonolube.models.fem import Transducer

GROUP: Final = "sonolube.studies"
"""Group of entry points by which packages add studies."""

Advance = Callable[[str, int, int], None]
"""Called with the step that is computed, the number of steps done and their total."""


class StudyReport(Protocol):
    """What a study found: claims with their verdicts, published numbers beside computed ones, and figures."""

    @property
    def caveats(self) -> Sequence[str]:
        """Assumptions that contradict the publication, a line each."""

    def lines(self) -> Sequence[str]:
        """Claims with their verdicts and counts of rows, in at most 80 columns."""

    def object(self) -> dict[str, Any]:
        """Claims and rows for JSON."""

    def files(self, *, advance: Advance) -> Mapping[str, str | bytes]:
        """Page, claims and rows, and figures, by the names of their files."""


class Study(Protocol):
    """A publication judged by sonolube, with the hardware that it defines."""

    @property
    def title(self) -> str:
        """Author, title and year of the publication."""

    @property
    def transducers(self) -> Mapping[str, "Callable[..., Transducer]"]:
        """Its transducers by name, each a function of their sizes."""

    @property
    def horn_faces(self) -> Mapping[str, "HornFace"]:
        """Faces of its horns by name, each with a model of the friction on it."""

    def reproduce(self, *, chapter: int | None, advance: Advance) -> StudyReport:
        """Claims judged, and published numbers beside computed ones, of a chapter or of the whole publication."""


@cache
def studies() -> Mapping[str, Study]:
    """Studies of all installed packages.

    Returns
    -------
    mapping of str to Study
        By name, in the order of the names.

    Raises
    ------
    InvalidInput
        If a study cannot be imported.
    """
    points = sorted(entry_points(group=GROUP), key=lambda point: point.name)
    return MappingProxyType({point.name: _loaded(point) for point in points})


def study(name: str) -> Study:
    """Study by its name.

    Parameters
    ----------
    name : str

    Returns
    -------
    Study

    Raises
    ------
    MissingPackage
        If no package adds it.
    """
    found = studies()
    if name not in found:
        known = f"; installed: {', '.join(found)}" if found else ""
        raise MissingPackage(f"the study {name} is not installed{known}: install sonolube anew, which brings it")
    return found[name]


def study_transducers() -> "dict[str, Callable[..., Transducer]]":
    """Transducers of all studies by name.

    Returns
    -------
    dict of str to callable
    """
    return {name: made for each in studies().values() for name, made in each.transducers.items()}


def study_horn_face(name: str) -> "HornFace":
    """Face of a horn of any study.

    Parameters
    ----------
    name : str
        Such as "aluminium".

    Returns
    -------
    HornFace

    Raises
    ------
    MissingPackage
        If no study has horns.
    UnknownName
        If none has this one.
    """
    faces = {known: face for each in studies().values() for known, face in each.horn_faces.items()}
    if not faces:
        raise MissingPackage("no study with horns is installed: install sonolube anew, which brings dong2015")
    if name not in faces:
        raise UnknownName.among(faces, kind="horn", name=name)
    return faces[name]


def _loaded(point: EntryPoint) -> Study:
    """Study of an entry point."""
    try:
        found: Study = point.load()
    except Exception as failure:  # whatever the module of another package raises
        reason = (str(failure).strip().splitlines() or [""])[0][:120]
        raise InvalidInput(
            f"the study {point.name} cannot be loaded ({type(failure).__name__}: {reason}); mend or remove its package"
        ) from None
    return found
