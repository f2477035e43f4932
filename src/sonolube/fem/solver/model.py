"""A body to be computed: its mesh, what it is made of, how it is held and where its electrodes are."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.fem.solver.medium import Medium
from sonolube.fem.solver.mesh import Mesh

DIRECTIONS = "xyz"


@dataclass(frozen=True, kw_only=True, slots=True)
class FixedSupport:
    """Nodes that do not move in some directions.

    Parameters
    ----------
    face : str or None
        Name of the face they lie on; None for all nodes of the body.
    along : str
        The directions held, letters of "xyz".
    """

    face: str | None
    along: str = DIRECTIONS

    def __post_init__(self) -> None:
        if not self.along or set(self.along) - set(DIRECTIONS):
            raise InvalidInput(f"the directions held must be letters of 'xyz', got {self.along!r}")


@dataclass(frozen=True, kw_only=True, slots=True)
class FaceSpring:
    """A spring to the ground, spread evenly over a face.

    Parameters
    ----------
    face : str
        Name of the face.
    spring_stiffness : float
        Stiffness of the whole face moved as one. [N/m]
    along : tuple of three float, optional
        The one direction in which it acts; in all three alike where absent.
    """

    face: str
    spring_stiffness: float
    along: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        require_positive(spring_stiffness=self.spring_stiffness)
        if self.along is not None and not np.any(self.along):
            raise InvalidInput(f"the spring's direction must have a length, got {self.along!r}")


@dataclass(frozen=True, kw_only=True, slots=True)
class Electrodes:
    """Faces that are equipotentials.

    Parameters
    ----------
    driven : tuple of str
        Faces at the drive voltage, wired together.
    grounded : tuple of str
        Faces at zero volts.
    floating : tuple of str
        Faces of no wire: each at the one potential at which its charge vanishes.
    """

    driven: tuple[str, ...] = ()
    grounded: tuple[str, ...] = ()
    floating: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        names = (*self.driven, *self.grounded, *self.floating)
        twice = {name for name in names if names.count(name) > 1}
        if twice:
            raise InvalidInput(f"electrodes given twice: {', '.join(sorted(twice))}")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Model:
    """A body to be computed.

    Parameters
    ----------
    mesh : Mesh
    media : mapping of str to Medium
        What each region of the mesh is made of.
    fixed : tuple of Fixed
        Where it is held.
    springs : tuple of FaceSpring
        Where it rests on springs.
    electrodes : Electrodes
        Needed where a region is piezoelectric.

    Raises
    ------
    InvalidInput
        If a region has no medium, or a piezoelectric body no electrode of known potential.
    UnknownName
        If a face or region named is not in the mesh.
    """

    mesh: Mesh
    media: Mapping[str, Medium]
    fixed: tuple[FixedSupport, ...] = ()
    springs: tuple[FaceSpring, ...] = ()
    electrodes: Electrodes = field(default_factory=Electrodes)

    def __post_init__(self) -> None:
        missing = [region for region in self.mesh.regions if region not in self.media]
        if missing:
            raise InvalidInput(f"regions without a medium: {', '.join(missing)}")
        for region in self.media:
            if region not in self.mesh.regions:
                raise UnknownName.among(self.mesh.regions, kind="region", name=region)
        wired = (*self.electrodes.driven, *self.electrodes.grounded)
        held = [support.face for support in self.fixed if support.face is not None]
        held += [spring.face for spring in self.springs]
        for face in (*held, *wired, *self.electrodes.floating):
            self.mesh.face_nodes(face)
        if self.is_piezoelectric and not wired:
            raise InvalidInput(
                "a piezoelectric body needs a driven or grounded electrode; potentials float without one"
            )

    @property
    def is_piezoelectric(self) -> bool:
        """Whether any region is piezoelectric."""
        return any(medium.is_piezoelectric for medium in self.media.values())
