r"""Elastic and viscoelastic layers under a flat face: complex modulus, static stiffness, and stiffness at a frequency.

The layer is bonded to a rigid base. Its complex modulus has the same Poisson's ratio at every frequency, so that loss
and stiffening at the drive frequency multiply the elastic stiffness (correspondence principle).
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact.elastic_bodies import (
    MAXIMUM_RADIUS_RATIO,
    CoatedBody,
    ElasticBody,
    equivalent_plane_strain_modulus,
)

_RIGID = 1e9  # modulus of the base over that of the layer


@dataclass(frozen=True, kw_only=True, slots=True)
class PronySeries:
    r"""Young's modulus of a viscoelastic solid as a Prony series, springs and dampers in parallel (Maxwell).

    Parameters
    ----------
    relaxed_modulus : float
        Modulus after infinite time, E_inf. [Pa]
    relaxation_modulus : tuple of float
        Modulus of each element, E_k. [Pa]
    relaxation_time : tuple of float
        Relaxation time of each element, tau_k. [s]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite, or there are not as many moduli as times.

    Notes
    -----
    .. math:: E(t) = E_\infty + \sum_k E_k e^{-t/\tau_k}
    """

    relaxed_modulus: float
    relaxation_modulus: tuple[float, ...]
    relaxation_time: tuple[float, ...]

    def __post_init__(self) -> None:
        require_positive(relaxed_modulus=self.relaxed_modulus)
        if len(self.relaxation_modulus) != len(self.relaxation_time):
            raise InvalidInput(
                "relaxation_modulus and relaxation_time must have one entry per element, got"
                f" {len(self.relaxation_modulus)} and {len(self.relaxation_time)}"
            )
        if self.relaxation_time:
            require_positive(relaxation_modulus=self.relaxation_modulus, relaxation_time=self.relaxation_time)

    @property
    def instantaneous_modulus(self) -> float:
        """Modulus at infinite frequency, the sum of all moduli. [Pa]"""
        return self.relaxed_modulus + sum(self.relaxation_modulus)


def complex_modulus(series: PronySeries, *, frequency: ArrayLike) -> Complexes:
    r"""Complex Young's modulus: storage modulus and, as its imaginary part, loss modulus. [Pa]

    Parameters
    ----------
    series : PronySeries
    frequency : array_like, any shape
        Frequency of the vibration. [Hz]

    Returns
    -------
    ndarray of complex, shape of `frequency`

    Raises
    ------
    InvalidInput
        If a frequency is negative or not finite.

    Notes
    -----
    .. math:: E^*(\omega) = E_\infty + \sum_k E_k \frac{\mathrm{i}\omega\tau_k}{1 + \mathrm{i}\omega\tau_k}

    Examples
    --------
    >>> from sonolube.models.contact import PronySeries, complex_modulus
    >>> rubber = PronySeries(relaxed_modulus=2e6, relaxation_modulus=(8e6,), relaxation_time=(1e-5,))
    >>> modulus = complex_modulus(rubber, frequency=20e3)
    >>> round(1e-6 * float(modulus.real), 1), round(float(modulus.imag / modulus.real), 2)  # MPa, loss factor
    (6.9, 0.57)
    """
    omega = 2 * np.pi * require_non_negative(frequency=frequency)
    turned = 1j * np.multiply.outer(omega, np.asarray(series.relaxation_time, dtype=np.float64))
    elements = np.asarray(series.relaxation_modulus, dtype=np.float64)
    return np.asarray(series.relaxed_modulus + (elements * turned / (1 + turned)).sum(axis=-1))


def oedometric_modulus(layer: ElasticBody) -> float:
    r"""Modulus of compression of a solid that cannot spread, as of a wide bonded layer. [Pa]

    Parameters
    ----------
    layer : ElasticBody

    Returns
    -------
    float
        Infinite for an incompressible solid.

    Notes
    -----
    .. math:: M = \frac{E\,(1 - \nu)}{(1 + \nu)(1 - 2\nu)}
    """
    E, nu = layer.youngs_modulus, layer.poisson_ratio
    return math.inf if nu == 0.5 else E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))


@dataclass(frozen=True, kw_only=True, slots=True)
class SoftLayer:
    """Soft layer of constant thickness on a rigid base, with its stiffening and its loss at the drive frequency.

    Parameters
    ----------
    body : ElasticBody
        Constants at rest.
    layer_thickness : float
        Thickness of the layer. [m]
    dynamic_modulus_ratio : float
        Storage modulus at the drive frequency over the modulus at rest. []
    layer_loss : float
        Loss factor at the drive frequency, loss over storage modulus. []
    layer_density : float
        Density; 0 leaves inertia out. [kg/m3]

    Raises
    ------
    InvalidInput
        If thickness or modulus ratio is not positive, or another value negative.
    """

    body: ElasticBody
    layer_thickness: float
    dynamic_modulus_ratio: float = 1.0
    layer_loss: float = 0.0
    layer_density: float = 0.0

    def __post_init__(self) -> None:
        require_positive(layer_thickness=self.layer_thickness, dynamic_modulus_ratio=self.dynamic_modulus_ratio)
        require_non_negative(layer_loss=self.layer_loss, layer_density=self.layer_density)

    @property
    def modulus_factor(self) -> complex:
        """Complex modulus at the drive frequency over the modulus at rest. []"""
        return self.dynamic_modulus_ratio * (1 + 1j * self.layer_loss)


def layer_normal_stiffness(layer: SoftLayer, *, face_radius: float) -> float:
    r"""Static normal stiffness of the layer under a flat circular face without friction. [N/m]

    Parameters
    ----------
    layer : SoftLayer
    face_radius : float
        Radius of the face. [m]

    Returns
    -------
    float
        From M pi R^2/t of a thin layer, a Winkler bed with the oedometric modulus, to 2 R E/(1 - nu^2) of a thick one,
        a half-space.

    Raises
    ------
    InvalidInput
        If the radius is not positive.
    OutsideRange
        If the layer is incompressible and thinner than the radius over `MAXIMUM_RADIUS_RATIO`.

    Notes
    -----
    That of a bonded layer on a half-space a billion times stiffer, `equivalent_plane_strain_modulus`; the closed form
    of the thin layer where the radius exceeds the range of the integral equation.

    References
    ----------
    .. [1] K. L. Johnson, Contact Mechanics (1985), sections 4.3 and 5.8. doi:10.1017/CBO9781139171731
    """
    R, t, body = float(require_positive(face_radius=face_radius)), layer.layer_thickness, layer.body
    if MAXIMUM_RADIUS_RATIO * t >= R:
        base = replace(body, youngs_modulus=_RIGID * body.youngs_modulus)
        bonded = CoatedBody(layer=body, substrate=base, thickness=t)
        return 2 * R * float(equivalent_plane_strain_modulus(bonded, contact_radius=R))
    if body.poisson_ratio == 0.5:
        raise OutsideRange(
            f"layer_thickness {t:.3g} m is too thin for an incompressible layer under a face of {R:.3g} m in radius;"
            " take a Poisson's ratio below 0.5, such as 0.49"
        )
    return oedometric_modulus(body) * math.pi * R**2 / t


def layer_tangential_stiffness(layer: SoftLayer, *, face_radius: float) -> float:
    r"""Static tangential stiffness of the layer under a sticking flat circular face. [N/m]

    Parameters
    ----------
    layer : SoftLayer
    face_radius : float
        Radius of the face. [m]

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If the radius is not positive.

    Notes
    -----
    The larger of G pi R^2/t, which a thin layer has, and 8 G R/(2 - nu), which a thick one has: a lower bound in
    between.
    """
    R, G = float(require_positive(face_radius=face_radius)), layer.body.shear_modulus
    return max(G * math.pi * R**2 / layer.layer_thickness, 8 * G * R / (2 - layer.body.poisson_ratio))


def dynamic_stiffness_ratio(layer: SoftLayer, *, frequency: ArrayLike) -> Complexes:
    r"""Complex normal stiffness of the layer at a frequency over that at rest. []

    Parameters
    ----------
    layer : SoftLayer
    frequency : array_like, any shape
        Frequency of the vibration. [Hz]

    Returns
    -------
    ndarray of complex, shape of `frequency`
        The factor of the modulus where the layer has no density.

    Raises
    ------
    InvalidInput
        If a frequency is negative, or the layer is incompressible and has a density.

    Notes
    -----
    .. math:: \frac{k^*(\omega)}{k} = \frac{M^*}{M}\, q t \cot qt, \qquad q = \omega \sqrt{\rho/M^*}

    Compression waves between face and rigid base, whose oedometric modulus is M*: exact for a wide layer. A thick layer
    with loss has the impedance of an endless one, i omega sqrt(rho M*) for each area.
    """
    omega = 2 * np.pi * require_non_negative(frequency=frequency)
    factor = layer.modulus_factor
    if layer.layer_density == 0:
        return np.full(omega.shape, factor, dtype=np.complex128)
    modulus = oedometric_modulus(layer.body)
    if math.isinf(modulus):
        raise InvalidInput("layer_density needs a compressible layer: waves in it need a Poisson's ratio below 0.5")
    phase = omega * layer.layer_thickness * np.sqrt(layer.layer_density / (modulus * factor))
    small = np.abs(phase) < 1e-4
    safe = np.where(small, 1.0, phase)
    turned = np.exp(2j * np.where(safe.imag >= 0, safe, -safe))  # even in the phase; decays
    cotangent = np.where(safe.imag >= 0, 1, -1) * 1j * (turned + 1) / (turned - 1)
    return np.asarray(factor * np.where(small, 1 - phase**2 / 3, safe * cotangent))


def layer_loss_power(
    layer: SoftLayer, *, face_radius: float, vibration_amplitude: ArrayLike, frequency: ArrayLike
) -> np.ndarray:
    r"""Heat of a vibrating face in the layer by its loss, in contact throughout. [W]

    Parameters
    ----------
    layer : SoftLayer
    face_radius : float
        Radius of the face. [m]
    vibration_amplitude : array_like, any shape
        Amplitude of the deformation, zero to peak. [m]
    frequency : array_like, broadcast against `vibration_amplitude`
        Frequency of the vibration. [Hz]

    Returns
    -------
    ndarray, the broadcast shape

    Raises
    ------
    InvalidInput
        If the radius is not positive, or another value negative.

    Notes
    -----
    .. math:: P = \tfrac12\, \omega\, a^2\, \mathrm{Im}\, k^*(\omega)
    """
    a, f = require_non_negative(vibration_amplitude=vibration_amplitude), require_non_negative(frequency=frequency)
    loss = dynamic_stiffness_ratio(layer, frequency=f).imag * layer_normal_stiffness(layer, face_radius=face_radius)
    return np.asarray(np.pi * f * a**2 * loss)
