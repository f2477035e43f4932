"""Contact, friction and wear of a rig at its operating point, the stated vibration taken for a sine."""

from dataclasses import dataclass, replace

from sonolube.contact import contact_caveats, cube_tangential_stiffness, sinusoidal_motion
from sonolube.contact.rough import contact_count, normal_stiffness, real_contact_area
from sonolube.friction.models import FRICTION_MODELS, FrictionModel
from sonolube.friction.models.range_check import OUTSIDE_MODEL_RANGE, CheckedRatio
from sonolube.rig.excitation import amplifier_power
from sonolube.rig.friction_and_wear import stated_friction_ratios
from sonolube.rig.linear_response import rest_separation
from sonolube.rig.record import Rig
from sonolube.wear import DEFAULT_WEAR_MODEL, WEAR_MODELS, cube_wear_rate, vibrating_cube_wear_rate

COMPUTED = "computed"
"""Status of a result within the range of its model."""


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
        Bending stiffness of the cube, D 3.9. [N/m]
    mindlin_ratio : float
        Tangential over normal stiffness by Mindlin's theory, beside that of the cube. []
    caveats : tuple of str
        Reasons for caution about the numbers, one line each.
    """

    normal_load: float
    separation: float
    real_contact_area: float
    contact_count: float
    normal_stiffness: float
    tangential_stiffness: float
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
    actuator_power : float or None
        Power a linear amplifier supplies, D 1.9, where drive and capacitance are known. [W]
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
    actuator_power: float | None
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
    caveats: tuple[str, ...]


def contact_point(rig: Rig) -> ContactPoint:
    """Return the state of the contact under the rig's load, without vibration.

    Raises
    ------
    OutsideRange
        If the surfaces would be pressed through each other, so that no separation is left.
    """
    gap = rest_separation(rig)
    return ContactPoint(
        normal_load=rig.normal_load,
        separation=gap,
        real_contact_area=float(real_contact_area(rig.contact, separation=gap)),
        contact_count=float(contact_count(rig.contact, separation=gap)),
        normal_stiffness=float(normal_stiffness(rig.contact, separation=gap)),
        tangential_stiffness=float(cube_tangential_stiffness(rig.contact, separation=gap)),
        mindlin_ratio=rig.contact.pair.mindlin_ratio,
        caveats=contact_caveats(rig.contact, separation=gap),
    )


def friction_point(rig: Rig, *, model: str | None = None) -> FrictionPoint:
    """Return the friction of the rig under its stated vibration, taken for a sine.

    Parameters
    ----------
    rig : Rig
    model : str, optional
        Name of a friction model instead of the rig's own; it takes over those of the rig's parameters that it has.

    Returns
    -------
    FrictionPoint

    Raises
    ------
    InvalidInput
        If the rig has no frequency, or no sliding speed, and the model needs it.
    OutsideRange
        If the surfaces would be pressed through each other, so that no separation is left.
    UnknownName
        If there is no such model.
    """
    gap = rest_separation(rig)
    chosen = rig if model is None else replace(rig, friction_model=_model_of(rig, model))
    return friction_under(
        chosen,
        ratio=stated_friction_ratios(chosen, sliding_speed=rig.sliding_speed),
        vibration_amplitude=rig.vibration_amplitude,
        actuator_power=_actuator_power(rig),
        caveats=contact_caveats(rig.contact, separation=gap),
    )


def friction_under(
    rig: Rig, *, ratio: CheckedRatio, vibration_amplitude: float, actuator_power: float | None, caveats: tuple[str, ...]
) -> FrictionPoint:
    """Return the friction of a rig at a friction ratio.

    Parameters
    ----------
    rig : Rig
    ratio : CheckedRatio, shape ()
        Friction with vibration over friction without.
    vibration_amplitude : float
        Vibration normal to the contact, zero to peak. [m]
    actuator_power : float or None
        Power drawn by the actuator, where it is known. [W]
    caveats : tuple of str
        Reasons for caution about the numbers.

    Returns
    -------
    FrictionPoint
    """
    intrinsic, valid = rig.friction_coefficient * rig.normal_load, float(ratio.friction_ratio)
    return FrictionPoint(
        friction_force=valid * intrinsic,
        friction_coefficient=valid * rig.friction_coefficient,
        intrinsic_friction_force=intrinsic,
        friction_ratio=valid,
        raw_friction_ratio=float(ratio.raw_friction_ratio),
        friction_reduction=1 - valid,
        status=OUTSIDE_MODEL_RANGE if ratio.reason else COMPUTED,
        reason=str(ratio.reason) or None,
        friction_model=rig.friction_model.name,
        citation=rig.friction_model.citation,
        vibration_amplitude=vibration_amplitude,
        actuator_power=actuator_power,
        caveats=caveats,
    )


def _model_of(rig: Rig, name: str) -> FrictionModel:
    """Return the friction model of a name, with those parameters of the rig's model that it has too."""
    model = FRICTION_MODELS.named(name)
    shared = {each.name for each in model.parameters()} & {each.name for each in rig.friction_model.parameters()}
    return model(**{key: getattr(rig.friction_model, key) for key in shared})


def wear_point(rig: Rig, *, model: str = DEFAULT_WEAR_MODEL) -> WearPoint:
    """Return the wear of the rig with and without its stated vibration, taken for a sine about the gap at rest.

    Parameters
    ----------
    rig : Rig
    model : str
        Name of the wear model.

    Returns
    -------
    WearPoint

    Raises
    ------
    OutsideRange
        If the surfaces would be pressed through each other, so that no separation is left.
    UnknownName
        If there is no such model.

    References
    ----------
    .. [1] D 3.26 to 3.29 as they were evaluated, for the default model.
    """
    gap = rest_separation(rig)
    caveats = contact_caveats(rig.contact, separation=gap)
    if rig.vibration_amplitude >= gap:
        caveats = (
            *caveats,
            f"vibration amplitude {rig.vibration_amplitude:.3g} m reaches the separation at rest, {gap:.3g} m: the "
            "surfaces must ride higher under vibration than this model lets them; take a smaller amplitude",
        )
    ratio = _wear_ratio(rig, model)
    return wear_under(rig, ratio=ratio, model=model, vibration_amplitude=rig.vibration_amplitude, caveats=caveats)


def wear_under(
    rig: Rig,
    *,
    ratio: float,
    model: str,
    vibration_amplitude: float,
    caveats: tuple[str, ...],
    reason: str | None = None,
) -> WearPoint:
    """Return the wear of a rig at a wear ratio.

    Parameters
    ----------
    rig : Rig
    ratio : float
        Wear rate with vibration over that without, dimensionless.
    model : str
        Name of the wear model.
    vibration_amplitude : float
        Vibration normal to the contact, zero to peak. [m]
    caveats : tuple of str
        Reasons for caution about the numbers.
    reason : str or None
        Why the ratio is outside the range of the model; None inside it.

    Returns
    -------
    WearPoint
    """
    still = float(cube_wear_rate(rig.contact, normal_load=rig.normal_load))
    valid = float("nan") if reason else ratio
    return WearPoint(
        wear_rate=valid * still,
        intrinsic_wear_rate=still,
        wear_rate_ratio=valid,
        raw_wear_rate_ratio=ratio,
        wear_reduction=1 - valid,
        status=OUTSIDE_MODEL_RANGE if reason else COMPUTED,
        reason=reason,
        wear_model=model,
        vibration_amplitude=vibration_amplitude,
        caveats=caveats,
    )


def _wear_ratio(rig: Rig, model: str) -> float:
    load, amplitude = rig.normal_load, rig.vibration_amplitude
    if model == DEFAULT_WEAR_MODEL:  # by quadrature of the sine itself
        still = cube_wear_rate(rig.contact, normal_load=load)
        return float(vibrating_cube_wear_rate(rig.contact, normal_load=load, vibration_amplitude=amplitude) / still)
    frequency = 1.0 if rig.drive is None else rig.drive.frequency  # without effect on wear models
    sine = sinusoidal_motion(rig.contact, normal_load=load, vibration_amplitude=amplitude, frequency=frequency)
    return float(WEAR_MODELS.named(model)(rig.contact, sine))


def _actuator_power(rig: Rig) -> float | None:
    if rig.drive is None or rig.drive.voltage_peak_to_peak is None or rig.capacitance is None:
        return None
    return float(amplifier_power(rig.drive, capacitance=rig.capacitance))
