"""Mean friction ratio of a vibrating face on a soft layer: a linear layer of known thickness, or one that stiffens."""

import math
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.contact.contact_motion import ContactMotion
from sonolube.models.contact.elastic_bodies import ElasticBody
from sonolube.models.contact.rough import RoughContact
from sonolube.models.contact.soft_layer import (
    SoftLayer,
    dynamic_stiffness_ratio,
    layer_loss_power,
    layer_normal_stiffness,
    layer_tangential_stiffness,
)
from sonolube.models.friction.models.model import FrictionModel, parameter
from sonolube.models.friction.oscillating_contact.rigid_guide import normal_oscillation_ratio
from sonolube.models.friction.oscillating_contact.spring_contact import SpringContact
from sonolube.models.friction.soft_counterface import (
    FaceVibrationMode,
    balanced_indentation,
    exponential_layer_ratio,
    face_patches,
    mean_force,
)

_LARGE_STRAIN = 0.2  # of a layer, beyond which it is no longer linear
_NO_FORCE = 1e-12  # mean force over the load below which a patch carries nothing


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class SoftLayerModel(FrictionModel):
    r"""A vibrating face on a soft layer, such as felt, rubber or plastic: every patch of it is a spring of its own.

    Parameters
    ----------
    layer_thickness : float
        Thickness of the layer on its rigid base; 0 for a layer that stiffens, whose pressure falls by a factor of e
        over the decay length of the contact. [m]
    dynamic_modulus_ratio : float
        Storage modulus at the drive frequency over the modulus at rest. []
    layer_loss : float
        Loss factor at the drive frequency. []
    layer_density : float
        Density; 0 leaves the inertia of the layer out. [kg/m3]
    rim_displacement_ratio : float
        Displacement of the rim of the face over that of its centre, from -1 to 1; 1 for a uniform motion. []
    following_fraction : float
        Fraction of the mean motion of the face that the body behind the layer follows, from 0 to 1. []

    Raises
    ------
    InvalidInput
        If a value is out of range.

    Notes
    -----
    Modulus and Poisson's ratio of the layer are those of the softer body, and the face is a circle of the nominal area.
    A linear layer has the stiffness k of `sonolube.models.contact.layer_normal_stiffness`, and under vibration the
    complex k* of `dynamic_stiffness_ratio`. Each patch is a spring contact with the approach of the face, the amplitude
    :math:`a |k^*|/k` and the ratio of tangential to normal stiffness of the layer: friction rises from that of
    `linear_layer_ratio` for slow sliding to that without vibration at the critical speed. A loss enters exactly while
    contact is kept; where it is lost the recovery of the layer is taken as that of a spring.

    A layer that stiffens is `exponential_layer_ratio`, for slow sliding only.

    See Also
    --------
    sonolube.models.friction.exponential_layer_ratio : The layer of D 4.4, which is felt.

    References
    ----------
    .. [1] D 4.4.
    .. [2] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4
    """

    name: ClassVar[str] = "soft_layer"
    citation: ClassVar[str] = "D 4.4 for felt; M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017) for springs"
    needs_open_gap: ClassVar[bool] = False
    for_soft_bodies: ClassVar[bool] = True
    tested: ClassVar[str] = (
        "theory alone: its layer that stiffens was fitted to three tests of D 4.4 on felt (0.32 for 0.37, 0.28 and"
        " 0.31), whose amplitude and felt are not printed; a linear layer is compared with no experiment"
    )

    layer_thickness: float = parameter(0.0, lowest=0.0)
    dynamic_modulus_ratio: float = parameter(1.0, positive=True)
    layer_loss: float = parameter(0.0, lowest=0.0)
    layer_density: float = parameter(0.0, lowest=0.0)
    rim_displacement_ratio: float = parameter(1.0)
    following_fraction: float = parameter(0.0)

    def __post_init__(self) -> None:
        FrictionModel.__post_init__(self)
        _ = self.mode

    @property
    def mode(self) -> FaceVibrationMode:
        """Mode of the face."""
        return FaceVibrationMode(
            rim_displacement_ratio=self.rim_displacement_ratio, following_fraction=self.following_fraction
        )

    def layer(self, contact: RoughContact) -> SoftLayer:
        """Layer of a contact, of the constants of its softer body."""
        ratio = contact.pair.poisson_ratio
        return SoftLayer(
            body=ElasticBody(youngs_modulus=contact.pair.effective_modulus * (1 - ratio**2), poisson_ratio=ratio),
            layer_thickness=self.layer_thickness,
            dynamic_modulus_ratio=self.dynamic_modulus_ratio,
            layer_loss=self.layer_loss,
            layer_density=self.layer_density,
        )

    def mechanism(self, contact: RoughContact, motion: ContactMotion) -> str:
        """Stiffness at rest and at the frequency, indentation, and heat of the loss; empty without a thickness."""
        if self.layer_thickness == 0:
            return ""
        layer, radius = self.layer(contact), math.sqrt(contact.nominal_area / math.pi)
        k = layer_normal_stiffness(layer, face_radius=radius)
        moving = complex(dynamic_stiffness_ratio(layer, frequency=motion.frequency))
        amplitude, indentation = float(np.ptp(motion.displacement)) / 2, motion.normal_load / k
        large = indentation > _LARGE_STRAIN * self.layer_thickness
        beyond = ", more than a fifth of its thickness, where it is no longer linear" if large else ""
        heat = layer_loss_power(layer, face_radius=radius, vibration_amplitude=amplitude, frequency=motion.frequency)
        return (
            f"layer of {k:.3g} N/m at rest, indented by {1e6 * indentation:.3g} um{beyond}, {abs(moving):.3g} times"
            f" as stiff at the drive frequency; its loss takes {1e3 * float(heat):.3g} mW in contact throughout, by a"
            " uniform motion"
        )

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        amplitude = float(np.ptp(motion.displacement)) / 2
        if self.layer_thickness > 0:
            return self._linear(contact, motion, amplitude, v_r, mu)
        if contact.decay_length is None:
            raise InvalidInput(
                "friction model soft_layer needs friction.layer_thickness, or for a layer that stiffens its own"
                " contact.decay_length, which its roughness does not tell"
            )
        ratio = exponential_layer_ratio(self.mode, vibration_amplitude=amplitude, decay_length=contact.decay_length)
        return np.full(v_r.shape, float(ratio))

    def _linear(
        self, contact: RoughContact, motion: ContactMotion, amplitude: float, v_r: Floats, mu: ArrayLike | None
    ) -> Floats:
        """Ratio on a layer of constant stiffness, shape (n,)."""
        if mu is None:
            raise InvalidInput(f"{self.name} requires a friction_coefficient, which limits the force of every patch")
        layer, radius = self.layer(contact), math.sqrt(contact.nominal_area / math.pi)
        k = layer_normal_stiffness(layer, face_radius=radius)
        stiffened = abs(complex(dynamic_stiffness_ratio(layer, frequency=motion.frequency)))
        patches, area = face_patches(self.mode)
        own = amplitude * stiffened * patches
        at_rest = motion.normal_load / k
        mean = at_rest * float(balanced_indentation(own / at_rest, area))
        carried = mean_force(np.full(own.shape, mean), own)[0] / at_rest
        loaded = carried > _NO_FORCE
        springs = SpringContact(
            friction_coefficient=float(require_positive(friction_coefficient=mu)),
            mindlin_ratio=abs(layer.modulus_factor) * layer_tangential_stiffness(layer, face_radius=radius) / k,
            profile="flat",
        )
        ratios = normal_oscillation_ratio(
            springs,
            approach=mean,
            normal_amplitude=own[loaded],
            frequency=motion.frequency,
            sliding_speed=v_r[:, np.newaxis],
        )
        return np.asarray(ratios @ (area * carried)[loaded])
