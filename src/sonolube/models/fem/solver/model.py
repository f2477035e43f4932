"""Boundary-value problem of a piezoelectric body: mesh, media, displacement supports, springs and electrodes."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.fem.mesh.mesh import DIRECTIONS, Mesh
from sonolube.models.fem.solver.medium import Medium


@dataclass(frozen=True, kw_only=True, slots=True)
class FixedSupport:
    """Homogeneous displacement boundary condition: zero displacement components on a face.

    Parameters
    ----------
    face : str or None
        Name of the face; None for all nodes of the body.
    along : str
        Directions in which the displacement is zero, letters of "xyz".

    Raises
    ------
    InvalidInput
        If a direction is none of x, y and z.
    """

    face: str | None
    along: str = DIRECTIONS

    def __post_init__(self) -> None:
        if not self.along or set(self.along) - set(DIRECTIONS):
            raise InvalidInput(f"the directions held must be letters of 'xyz', got {self.along!r}")


@dataclass(frozen=True, kw_only=True, slots=True)
class FaceSpring:
    """Elastic foundation (Winkler): a spring to the ground, distributed evenly over a face.

    Parameters
    ----------
    face : str
        Name of the face.
    spring_stiffness : float
        Stiffness of the whole face against a rigid translation. [N/m]
    along : tuple of three float, optional
        Direction in which the spring acts; all directions alike where absent.

    Raises
    ------
    InvalidInput
        If the stiffness is not positive, or the direction the zero vector.
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
    """Equipotential faces, by the condition on their potential or charge.

    Parameters
    ----------
    driven : tuple of str
        Faces at the drive voltage, connected to each other.
    grounded : tuple of str
        Faces at zero potential.
    floating : tuple of str
        Unconnected faces, each at the uniform potential at which its net charge is zero (open circuit).

    Raises
    ------
    InvalidInput
        If a face is listed twice.
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
    """Finite-element model: mesh, media of its regions, supports and electrodes.

    Parameters
    ----------
    mesh : Mesh
    media : mapping of str to Medium
        Medium of each region of the mesh, by the region's name.
    fixed : tuple of FixedSupport
        Displacement boundary conditions; a body without any is free.
    springs : tuple of FaceSpring
        Elastic foundations.
    electrodes : Electrodes
        Electrical boundary conditions; needed where a region is piezoelectric.

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
        known_potential = (*self.electrodes.driven, *self.electrodes.grounded)
        supported = [support.face for support in self.fixed if support.face is not None]
        supported += [spring.face for spring in self.springs]
        for face in (*supported, *known_potential, *self.electrodes.floating):
            self.mesh.face_nodes(face)
        if self.is_piezoelectric and not known_potential:
            raise InvalidInput(
                "a piezoelectric body needs a driven or grounded electrode; without one its potential is undetermined"
            )

    @property
    def is_piezoelectric(self) -> bool:
        """Whether any region is piezoelectric."""
        return any(medium.is_piezoelectric for medium in self.media.values())
