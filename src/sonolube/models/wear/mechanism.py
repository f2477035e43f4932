"""Wear mechanism of a material pair, and the effect of vibration on its wear, by an empirical rule from six pairs."""

from dataclasses import dataclass
from enum import StrEnum

from sonolube.checks import require_positive

_PLOUGHED_BELOW = 2e9
"""Hardness below which the softer body wears by ploughing, in Pa.

Between aluminium 2024 with 1.34 GPa, which did, and stainless steel with 2.13 GPa, which did not (D Tables 2.14 and
2.15)."""

_PLOUGHING_RATIO = 1.5
"""Smallest ratio of the hardnesses for ploughing; 1.58 to 1.91 (steel on aluminium) were observed."""

_EVIDENCE = "D 2.5: six pairs, one test each, of which one wore mainly by abrasion and two have titanium."


class CrystalStructure(StrEnum):
    """Crystal structure of a body."""

    FACE_CENTRED_CUBIC = "face-centred cubic"
    BODY_CENTRED_CUBIC = "body-centred cubic"
    HEXAGONAL = "hexagonal close-packed"
    NOT_A_METAL = "not a metal"


class WearMechanism(StrEnum):
    """Dominant wear mechanism of a contact; the other one occurs beside it."""

    ABRASIVE = "abrasive"
    ADHESIVE = "adhesive"


class VibrationEffect(StrEnum):
    """Effect of vibration on the wear of comparable pairs."""

    LESS_WEAR = "less wear"
    MORE_WEAR = "more wear"


@dataclass(frozen=True, kw_only=True, slots=True)
class WearPairBody:
    """Properties of one body of a wear pair that the rule uses.

    Parameters
    ----------
    name : str
        Name of the body in the reasons.
    hardness : float
        Indentation hardness. [Pa]
    structure : CrystalStructure
        Crystal structure.

    Raises
    ------
    InvalidInput
        If the hardness is not positive and finite.
    """

    name: str
    hardness: float
    structure: CrystalStructure

    def __post_init__(self) -> None:
        require_positive(hardness=self.hardness)


@dataclass(frozen=True, kw_only=True, slots=True)
class WearMechanismAssessment:
    """Wear mechanism and effect of vibration for a pair, with reasons and evidence.

    Parameters
    ----------
    mechanism : WearMechanism
        Dominant wear mechanism to expect.
    vibration_effect : VibrationEffect
        Effect of vibration on the wear of comparable pairs.
    reasons : tuple of str
        Reasons of both, each in one line.
    evidence : tuple of str
        Observations behind the reasons, and the limits of their range.
    """

    mechanism: WearMechanism
    vibration_effect: VibrationEffect
    reasons: tuple[str, ...]
    evidence: tuple[str, ...]


def assess_wear_mechanism(first: WearPairBody, second: WearPairBody) -> WearMechanismAssessment:
    """Wear mechanism of two bodies and the effect of vibration, by the rule of D 2.5.

    Parameters
    ----------
    first, second : WearPairBody
        The bodies, in either order.

    Returns
    -------
    WearMechanismAssessment

    Notes
    -----
    The rule classifies six pairs as D Table 2.14 does; it is not a law and gives no number. A softer body below 2 GPa
    is ploughed by a body at least 1.5 times as hard: abrasive wear. All other pairs wear by adhesion. The hardness
    ratio alone does not separate them: alumina on M50 steel has the ratio of steel on aluminium, and wears by adhesion.
    Wear increased under vibration for the pairs with titanium, the only hexagonal metal among them, so that the effects
    of structure, ductility and chemistry cannot be separated.

    References
    ----------
    .. [1] D 2.5.6, Tables 2.14 and 2.15.
    """
    softer, harder = sorted((first, second), key=lambda body: body.hardness)
    mechanism, mechanism_reason = _mechanism(softer, harder)
    effect, effect_reason = _vibration_effect(first, second)
    return WearMechanismAssessment(
        mechanism=mechanism,
        vibration_effect=effect,
        reasons=(mechanism_reason, effect_reason),
        evidence=(_EVIDENCE, *_untested(first, second)),
    )


def _mechanism(softer: WearPairBody, harder: WearPairBody) -> tuple[WearMechanism, str]:
    """Wear mechanism by the hardnesses, and the reason."""
    ratio = harder.hardness / softer.hardness
    compared = f"{harder.name} is {ratio:.2f} times as hard as {softer.name}"
    if softer.hardness >= _PLOUGHED_BELOW:
        return WearMechanism.ADHESIVE, f"{compared}, which is too hard to be ploughed: material is transferred instead"
    if ratio < _PLOUGHING_RATIO:
        return WearMechanism.ADHESIVE, f"{compared}: too little for ploughing, so that material is transferred"
    return WearMechanism.ABRASIVE, f"{compared}, which is soft enough to be ploughed"


def _vibration_effect(first: WearPairBody, second: WearPairBody) -> tuple[VibrationEffect, str]:
    """Effect of vibration by the crystal structures, and the reason."""
    hexagonal = [body.name for body in (first, second) if body.structure is CrystalStructure.HEXAGONAL]
    if hexagonal:
        return (
            VibrationEffect.MORE_WEAR,
            f"{hexagonal[0]} is hexagonal close-packed: titanium, hard and ductile, deformed instead of breaking, and "
            "vibration did not separate it from the other body",
        )
    return (
        VibrationEffect.LESS_WEAR,
        "neither body is hexagonal close-packed: all such pairs wore less when vibration interrupted the contact",
    )


def _untested(first: WearPairBody, second: WearPairBody) -> tuple[str, ...]:
    """Limit of the evidence that a pair exceeds, if any."""
    if first.structure is second.structure is CrystalStructure.NOT_A_METAL:
        return ("No pair without a metal was tested: the rule does not cover such pairs.",)
    return ()
