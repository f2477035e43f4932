"""What a region is made of: elastic, and where it is poled piezoelectric, in the axes of the model."""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.materials import Material, PiezoCeramic

_VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Medium:
    """Elastic, piezoelectric and dielectric constants in the axes of the model.

    Stresses and strains are ordered xx, yy, zz, yz, xz, xy, the last three strains being twice the tensor's.

    Parameters
    ----------
    elastic_stiffness : ndarray, shape (6, 6)
        Stress per strain, at constant field. [Pa]
    density : float
        Mass density. [kg/m3]
    stress_constants : ndarray, shape (3, 6), or None
        Charge density per strain, which is stress per field; None for what is not piezoelectric. [C/m2]
    permittivity : ndarray, shape (3, 3), or None
        Permittivity at constant strain; None for conductors, in which no potential is sought. [F/m]
    elastic_loss : float
        Loss tangent of the stiffness, one over the mechanical quality factor. []
    loss_tangent : float
        Loss tangent of the permittivity. []

    Raises
    ------
    InvalidInput
        If a tensor is missing, has the wrong shape, or stores no positive energy.
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
        _require_energy("elastic_stiffness", self.elastic_stiffness, 6)
        if (self.stress_constants is None) != (self.permittivity is None):
            raise InvalidInput("a piezoelectric medium needs both stress_constants and permittivity; one is missing")
        if self.stress_constants is not None and self.permittivity is not None:
            if np.shape(require_finite(stress_constants=self.stress_constants)) != (3, 6):
                raise InvalidInput(f"stress_constants must have shape (3, 6), got {np.shape(self.stress_constants)}")
            _require_energy("permittivity", self.permittivity, 3)

    @property
    def is_piezoelectric(self) -> bool:
        """Whether a potential is sought in it."""
        return self.permittivity is not None


def isotropic_medium(
    *, youngs_modulus: float, poisson_ratio: float, density: float, elastic_loss: float = 0.0
) -> Medium:
    """Return an isotropic medium.

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
    """
    require_positive(youngs_modulus=youngs_modulus)
    nu = float(require_within(-0.99, 0.4999, poisson_ratio=poisson_ratio))
    mu = youngs_modulus / (2 * (1 + nu))
    stiffness = np.diag([2 * mu] * 3 + [mu] * 3)
    stiffness[:3, :3] += 2 * mu * nu / (1 - 2 * nu)
    return Medium(elastic_stiffness=stiffness, density=density, elastic_loss=elastic_loss)


def medium_from_material(material: Material, *, elastic_loss: float = 0.0) -> Medium:
    """Return the isotropic medium that a material of the tables is.

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
    return isotropic_medium(
        youngs_modulus=material.value("youngs_modulus"),
        poisson_ratio=material.value("poisson_ratio"),
        density=material.value("density"),
        elastic_loss=elastic_loss,
    )


def poled_medium(ceramic: PiezoCeramic, *, along: tuple[float, float, float], lossless: bool = False) -> Medium:
    """Return a piezoelectric ceramic poled along a direction of the model.

    Parameters
    ----------
    ceramic : PiezoCeramic
    along : tuple of three float
        Direction of poling; its length does not matter.
    lossless : bool
        Leave out the losses that the ceramic's quality factor and loss tangent say, where its tables have them.

    Returns
    -------
    Medium

    Raises
    ------
    InvalidInput
        If the direction has no length: an unpoled ceramic is not piezoelectric, take `isotropic_medium` for it.
    """
    direction = require_finite(along=along)
    if direction.shape != (3,) or not np.any(direction):
        raise InvalidInput(f"a piezoelectric ceramic must be poled along a direction, got {along!r}")
    a = _axes(direction / np.linalg.norm(direction))
    known = {} if lossless else ceramic.material.properties
    quality = known["mechanical_quality_factor"].value if "mechanical_quality_factor" in known else np.inf
    stress = _bond(a)
    return Medium(
        elastic_stiffness=stress @ ceramic.stiffness_short_circuit @ stress.T,
        density=ceramic.material.value("density"),
        stress_constants=a.T @ ceramic.stress_constants @ stress.T,
        permittivity=a.T @ np.diag(ceramic.permittivity_clamped) @ a,
        elastic_loss=float(1 / quality),
        loss_tangent=known["loss_tangent"].value if "loss_tangent" in known else 0.0,
    )


def _axes(third: Floats) -> Floats:
    """Return a right-handed set of axes as rows, the last as given."""
    seed = np.eye(3)[np.argmin(np.abs(third))]
    first = np.cross(seed, third)
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(third, first), third])


def _bond(a: Floats) -> Floats:
    """Return what turns stresses in the crystal's axes, the rows of `a`, into those in the model's.

    After W. L. Bond, Bell Syst. Tech. J. 22, 1 (1943).
    """
    return np.array(
        [[a[k, i] * a[m, j] + (a[m, i] * a[k, j] if k != m else 0.0) for k, m in _VOIGT] for i, j in _VOIGT]
    )


def _require_energy(name: str, tensor: Floats, n: int) -> None:
    matrix = require_finite(**{name: tensor})
    if matrix.shape != (n, n) or not np.allclose(matrix, matrix.T, rtol=1e-9, atol=1e-12 * np.abs(matrix).max()):
        raise InvalidInput(f"{name} must be symmetric of shape ({n}, {n}), got shape {matrix.shape}")
    if np.linalg.eigvalsh(matrix)[0] <= 0:
        raise InvalidInput(f"{name} stores no positive energy: it must be positive definite")
