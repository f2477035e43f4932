"""Contact of a rig at its operating point, and records of its friction and wear under a vibration."""

from dataclasses import dataclass
from typing import TypedDict

from sonolube.models.contact.rough import contact_count, normal_stiffness, real_contact_area
from sonolube.models.contact.tangential_stiffness import DEFAULT_TANGENTIAL_STIFFNESS, TANGENTIAL_STIFFNESSES
from sonolube.rig.friction_and_wear import resting_caveats
from sonolube.rig.power import PowerToSupply
from sonolube.rig.record import AmplitudeSource, Rig
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig

COMPUTED = "computed"
"""Status of a result within the range of its model."""


class VibrationOrigin(TypedDict):
    """Amplitude of a vibration with its source, and the source in words, under the names that results have for them."""

    vibration_amplitude: float
    amplitude_source: AmplitudeSource
    amplitude_origin: str


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactPoint:
    """Contact of a rig at rest.

    Parameters
    ----------
    normal_load : float
        Force pressing the bodies together. [N]
    separation : float
        Distance of the mean planes. [m]
    real_contact_area : float
        Area of all touching asperities. [m2]
    contact_count : float
        Number of touching asperities. []
    normal_stiffness : float
        Slope of the load against the separation. [N/m]
    tangential_stiffness : float
        Force over displacement along the surface before any asperity slips. [N/m]
    tangential_stiffness_model : str
        Name of its model.
    mindlin_ratio : float
        Tangential over normal stiffness by Mindlin's theory. []
    caveats : tuple of str
        Reasons for caution about the numbers, one line each.
    """

    normal_load: float
    separation: float
    real_contact_area: float
    contact_count: float
    normal_stiffness: float
    tangential_stiffness: float
    tangential_stiffness_model: str
    mindlin_ratio: float
    caveats: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionPoint:
    """Friction of a rig under its vibration.

    Parameters
    ----------
    friction_force : float
        Mean friction force with vibration. [N]
    friction_coefficient : float
        That force over the normal load. []
    intrinsic_friction_force : float
        Friction force without vibration. [N]
    friction_ratio : float
        Friction with vibration over friction without. []
    raw_friction_ratio : float
        That ratio by the formula of the model, also outside its range; NaN where the formula has none. []
    friction_reduction : float
        One minus the friction ratio. []
    status : str
        "computed"; "outside_model_range" where the model has no meaning, and force, coefficient, ratio and reduction
        are NaN.
    reason : str or None
        Why the result is outside the range of the model, and advice.
    friction_model : str
        Name of the friction model.
    citation : str
        Source of the friction model.
    vibration_amplitude : float
        Vibration normal to the contact, zero to peak. [m]
    amplitude_source : {"measured", "computed", "waveguide", "per-volt"}
        Where the amplitude comes from.
    amplitude_origin : str
        The same in words, with the numbers behind it.
    power : PowerToSupply or None
        Power that the amplifier has to supply, with its parts; None where voltage and capacitance are not known.
    caveats : tuple of str
        Reasons for caution about the numbers, one line each.
    """

    friction_force: float
    friction_coefficient: float
    intrinsic_friction_force: float
    friction_ratio: float
    raw_friction_ratio: float
    friction_reduction: float
    status: str
    reason: str | None
    friction_model: str
    citation: str
    vibration_amplitude: float
    amplitude_source: AmplitudeSource
    amplitude_origin: str
    power: PowerToSupply | None
    caveats: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class WearPoint:
    """Wear of the softer body of a rig under its vibration, by the cube model.

    Parameters
    ----------
    wear_rate : float
        Volume per sliding distance with vibration. [m2]
    intrinsic_wear_rate : float
        Volume per sliding distance without vibration. [m2]
    wear_rate_ratio : float
        The one over the other. []
    raw_wear_rate_ratio : float
        That ratio by the formula of the model, also outside its range. []
    wear_reduction : float
        One minus the ratio. []
    status : str
        "computed"; "outside_model_range" where the model has no meaning, and rate, ratio and reduction with vibration
        are NaN.
    reason : str or None
        Why the result is outside the range of the model, and advice.
    wear_model : str
        Name of the wear model.
    vibration_amplitude : float
        Vibration normal to the contact, zero to peak. [m]
    amplitude_source : {"measured", "computed", "waveguide", "per-volt"}
        Where the amplitude comes from.
    amplitude_origin : str
        The same in words, with the numbers behind it.
    caveats : tuple of str
        Reasons for caution about the numbers, one line each.
    """

    wear_rate: float
    intrinsic_wear_rate: float
    wear_rate_ratio: float
    raw_wear_rate_ratio: float
    wear_reduction: float
    status: str
    reason: str | None
    wear_model: str
    vibration_amplitude: float
    amplitude_source: AmplitudeSource
    amplitude_origin: str
    caveats: tuple[str, ...]


def contact_point(
    rig: Rig | ResolvedRig, *, tangential_stiffness_model: str = DEFAULT_TANGENTIAL_STIFFNESS
) -> ContactPoint:
    """State of the contact under the rig's load, without vibration.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    tangential_stiffness_model : str
        Model of the tangential stiffness, of `sonolube.models.contact.TANGENTIAL_STIFFNESSES`.

    Returns
    -------
    ContactPoint

    Raises
    ------
    UnknownName
        If there is no such model.
    OutsideRange
        If the surfaces would be pressed through each other, so that no separation is left.

    Examples
    --------
    >>> from sonolube.rig import contact_point, read_rig
    >>> point = contact_point(read_rig("examples/rigs/tribometer.toml"))
    >>> round(1e12 * point.real_contact_area), round(point.contact_count)  # um2, asperities
    (4981, 264)
    """
    model = TANGENTIAL_STIFFNESSES.named(tangential_stiffness_model)
    resolved = resolved_rig(rig)
    rig, gap = resolved.rig, resolved.separation
    normal, tangential = (float(of(rig.contact, separation=gap)) for of in (normal_stiffness, model))
    above = tangential / normal if tangential > normal else None
    return ContactPoint(
        normal_load=rig.normal_load,
        separation=gap,
        real_contact_area=float(real_contact_area(rig.contact, separation=gap)),
        contact_count=float(contact_count(rig.contact, separation=gap)),
        normal_stiffness=normal,
        tangential_stiffness=tangential,
        tangential_stiffness_model=tangential_stiffness_model,
        mindlin_ratio=rig.contact.pair.mindlin_ratio,
        caveats=(
            *resting_caveats(resolved),
            *(() if above is None else (_stiffer_along(tangential_stiffness_model, above),)),
        ),
    )


def _stiffer_along(model: str, ratio: float) -> str:
    """Caveat of a tangential stiffness above the normal one."""
    return (
        f"the tangential stiffness by {model} is {ratio:.3g} times the normal one; that of asperities that stick is "
        f"below it, see the model {DEFAULT_TANGENTIAL_STIFFNESS}"
    )
