"""Boundary-value problem of a piezoelectric body: mesh, media, displacement supports, springs and electrodes.

A medium is the linear constitutive law of a region: elastic, piezoelectric and dielectric constants in the axes of the
model.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.materials import Material, PiezoCeramic
from sonolube.models.fem.mesh.mesh import DIRECTIONS, Mesh

_VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))  # index pairs of the rows in Voigt notation


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Medium:
    r"""Elastic, piezoelectric and dielectric constants in the axes of the model, in stress-charge form.

    Parameters
    ----------
    elastic_stiffness : ndarray, shape (6, 6)
        Stress per strain, at constant field. [Pa]
    density : float
        Mass density. [kg/m3]
    stress_constants : ndarray, shape (3, 6), or None
        Charge density per strain, equal to negative stress per field; None if not piezoelectric. [C/m2]
    permittivity : ndarray, shape (3, 3), or None
        Permittivity at constant strain; None for conductors, which have no potential unknowns. [F/m]
    elastic_loss : float
        Loss tangent of the stiffness, the inverse of the mechanical quality factor. []
    loss_tangent : float
        Dielectric loss tangent of the permittivity. []

    Raises
    ------
    InvalidInput
        If a tensor is missing, has the wrong shape, or is not positive definite.

    Notes
    -----
    In Voigt notation, stresses and strains in the order xx, yy, zz, yz, xz, xy and shear strains twice those of the
    tensor, for harmonic fields proportional to exp(i omega t):

    .. math::

        T = c^E (1 + i\eta) S - e^\mathsf{T} E, \qquad D = e S + \varepsilon^S (1 - i \tan\delta) E

    References
    ----------
    .. [1] IEEE Standard on Piezoelectricity, ANSI/IEEE Std 176-1987, section 2.3.
    """

    elastic_stiffness: Floats
    density: float
    stress_constants: Floats | None = None
    permittivity: Floats | None = None
    elastic_loss: float = 0.0
    loss_tangent: float = 0.0

    def __post_init__(self) -> None:
        require_positive(density=self.density)
        require_non_negative(elastic_loss=self.elastic_loss, loss_tangent=self.loss_tangent)
        _require_positive_definite("elastic_stiffness", self.elastic_stiffness, 6)
        if (self.stress_constants is None) != (self.permittivity is None):
            raise InvalidInput("a piezoelectric medium needs both stress_constants and permittivity; one is missing")
        if self.stress_constants is not None and self.permittivity is not None:
            if np.shape(require_finite(stress_constants=self.stress_constants)) != (3, 6):
                raise InvalidInput(f"stress_constants must have shape (3, 6), got {np.shape(self.stress_constants)}")
            _require_positive_definite("permittivity", self.permittivity, 3)

    @property
    def is_piezoelectric(self) -> bool:
        """Whether the electric potential is an unknown in the medium."""
        return self.permittivity is not None


def isotropic_medium(
    *, youngs_modulus: float, poisson_ratio: float, density: float, elastic_loss: float = 0.0
) -> Medium:
    r"""Isotropic elastic medium from its engineering constants.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus. [Pa]
    poisson_ratio : float
        Poisson's ratio, above -1 and below 0.5. []
    density : float
        Mass density. [kg/m3]
    elastic_loss : float
        Loss tangent of the stiffness. []

    Returns
    -------
    Medium

    Raises
    ------
    InvalidInput
        If the modulus or density is not positive, or Poisson's ratio outside its range.

    Notes
    -----
    With Lamé's constants

    .. math:: \mu = \frac{E}{2(1 + \nu)}, \qquad \lambda = \frac{2 \mu \nu}{1 - 2\nu}

    the stiffness is

    .. math::

        c_{ijkl} = \lambda \delta_{ij}\delta_{kl} + \mu(\delta_{ik}\delta_{jl} + \delta_{il}\delta_{jk})
    """
    require_positive(youngs_modulus=youngs_modulus)
    nu = float(require_within(-0.99, 0.4999, poisson_ratio=poisson_ratio))
    mu = youngs_modulus / (2 * (1 + nu))
    stiffness = np.diag([2 * mu] * 3 + [mu] * 3)
    stiffness[:3, :3] += 2 * mu * nu / (1 - 2 * nu)
    return Medium(elastic_stiffness=stiffness, density=density, elastic_loss=elastic_loss)


def medium_from_material(material: Material, *, elastic_loss: float = 0.0) -> Medium:
    """Isotropic elastic medium from a material of the data tables.

    Parameters
    ----------
    material : Material
    elastic_loss : float
        Loss tangent of the stiffness. []

    Returns
    -------
    Medium

    Raises
    ------
    MissingProperty
        If Young's modulus, Poisson's ratio or density is not known.
    """
    constants = {name: material.value(name) for name in ("youngs_modulus", "poisson_ratio", "density")}
    return isotropic_medium(**constants, elastic_loss=elastic_loss)


def poled_medium(ceramic: PiezoCeramic, *, along: tuple[float, float, float], lossless: bool = False) -> Medium:
    r"""Piezoelectric medium of a ceramic poled along a direction of the model.

    Parameters
    ----------
    ceramic : PiezoCeramic
    along : tuple of three float
        Direction of poling; its length does not matter.
    lossless : bool
        Neglect the losses given by the ceramic's quality factor and loss tangent, where its data have them.

    Returns
    -------
    Medium

    Raises
    ------
    InvalidInput
        If the direction is the zero vector: an unpoled ceramic is not piezoelectric, use `isotropic_medium` for it.

    Notes
    -----
    With the crystal axes as rows of the rotation matrix :math:`a` and Bond's stress transformation matrix :math:`M`,

    .. math::

        c' = M c^E M^\mathsf{T}, \qquad e' = a^\mathsf{T} e M^\mathsf{T}, \qquad
        \varepsilon' = a^\mathsf{T} \varepsilon^S a

    References
    ----------
    .. [1] W. L. Bond, Bell Syst. Tech. J. 22, 1 (1943).
    """
    direction = require_finite(along=along)
    if direction.shape != (3,) or not np.any(direction):
        raise InvalidInput(f"a piezoelectric ceramic must be poled along a direction, got {along!r}")
    axes = _crystal_axes(direction / np.linalg.norm(direction))
    properties = {} if lossless else ceramic.material.properties
    quality = properties["mechanical_quality_factor"].value if "mechanical_quality_factor" in properties else np.inf
    bond = _bond_matrix(axes)
    return Medium(
        elastic_stiffness=bond @ ceramic.stiffness_short_circuit @ bond.T,
        density=ceramic.material.value("density"),
        stress_constants=axes.T @ ceramic.stress_constants @ bond.T,
        permittivity=axes.T @ np.diag(ceramic.permittivity_clamped) @ axes,
        elastic_loss=float(1 / quality),
        loss_tangent=properties["loss_tangent"].value if "loss_tangent" in properties else 0.0,
    )


def _crystal_axes(third: Floats) -> Floats:
    """Right-handed orthonormal axes as rows, the third one given."""
    seed = np.eye(3)[np.argmin(np.abs(third))]
    first = np.cross(seed, third)
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(third, first), third])


def _bond_matrix(a: Floats) -> Floats:
    """Bond's matrix M: stresses in the model's axes from those in the crystal's, which are the rows of `a`."""
    return np.array(
        [[a[k, i] * a[m, j] + (a[m, i] * a[k, j] if k != m else 0.0) for k, m in _VOIGT] for i, j in _VOIGT]
    )


def _require_positive_definite(name: str, tensor: Floats, n: int) -> None:
    """Refuse a matrix that is not symmetric and positive definite of size n."""
    matrix = require_finite(**{name: tensor})
    if matrix.shape != (n, n) or not np.allclose(matrix, matrix.T, rtol=1e-9, atol=1e-12 * np.abs(matrix).max()):
        raise InvalidInput(f"{name} must be symmetric of shape ({n}, {n}), got shape {matrix.shape}")
    if np.linalg.eigvalsh(matrix)[0] <= 0:
        raise InvalidInput(f"{name} must be positive definite: some state of the medium would store negative energy")


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
