"""Which kind of wear a pair of materials runs into, and what vibration did to pairs like it: a rule, not a law."""

from dataclasses import dataclass
from enum import StrEnum

from sonolube.checks import require_positive

_PLOUGHED_BELOW = 2e9
"""Hardness below which the softer body is ploughed away, in Pa.

Aluminium 2024 with 1.34 GPa was, stainless steel with 2.13 GPa was not (D Tables 2.14 and 2.15)."""

_PLOUGHING_RATIO = 1.5
"""Hardness of a body that ploughs over that of the other. 1.58 to 1.91 (steel on aluminium) did."""

_EVIDENCE = "D 2.5: six pairs, one test each, of which one wore mainly by abrasion and two have titanium."


class CrystalStructure(StrEnum):
    """How the atoms of a body are stacked."""

    FACE_CENTRED_CUBIC = "face-centred cubic"
    BODY_CENTRED_CUBIC = "body-centred cubic"
    HEXAGONAL = "hexagonal close-packed"
    NOT_A_METAL = "not a metal"


class WearKind(StrEnum):
    """What wears a contact in the main; the other kind is there too."""

    ABRASIVE = "abrasive"
    ADHESIVE = "adhesive"


class VibrationEffect(StrEnum):
    """What vibration did to the wear of pairs like the one asked for."""

    LESS_WEAR = "less wear"
    MORE_WEAR = "more wear"


@dataclass(frozen=True, kw_only=True, slots=True)
class WearingBody:
    """One body of a pair, as the rule sees it.

    Parameters
    ----------
    name : str
        Its name in reasons.
    hardness : float
        Indentation hardness. [Pa]
    structure : CrystalStructure
        How its atoms are stacked.

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
class WearAssessment:
    """What the rule says of a pair, and why.

    Parameters
    ----------
    kind : WearKind
        The kind of wear to expect in the main.
    effect : VibrationEffect
        What vibration did to pairs like it.
    reasons : tuple of str
        Why, each in one line.
    evidence : tuple of str
        What the reasons rest on, and what they do not cover.
    """

    kind: WearKind
    effect: VibrationEffect
    reasons: tuple[str, ...]
    evidence: tuple[str, ...]


def assess_wear(first: WearingBody, second: WearingBody) -> WearAssessment:
    """Return the kind of wear to expect between two bodies, and what vibration did to pairs like them.

    Parameters
    ----------
    first, second : WearingBody
        The bodies, in either order.

    Returns
    -------
    WearAssessment

    Notes
    -----
    A rule drawn from six pairs, which it sorts as D Table 2.14 does: no law, and no number follows from it. Hardness
    alone does not sort them: alumina on M50 steel has the ratio of steel on aluminium, and adheres. Titanium is the one
    hexagonal metal among them, so that its structure, its ductility and its chemistry cannot be told apart.

    References
    ----------
    .. [1] D 2.5.6, Tables 2.14 and 2.15.
    """
    softer, harder = sorted((first, second), key=lambda body: body.hardness)
    kind, why_kind = _kind(softer, harder)
    effect, why_effect = _effect(first, second)
    return WearAssessment(
        kind=kind, effect=effect, reasons=(why_kind, why_effect), evidence=(_EVIDENCE, *_outside(first, second))
    )


def _kind(softer: WearingBody, harder: WearingBody) -> tuple[WearKind, str]:
    ratio = harder.hardness / softer.hardness
    compared = f"{harder.name} is {ratio:.2f} times as hard as {softer.name}"
    if softer.hardness >= _PLOUGHED_BELOW:
        return WearKind.ADHESIVE, f"{compared}, which is too hard to be ploughed: material is exchanged instead"
    if ratio < _PLOUGHING_RATIO:
        return WearKind.ADHESIVE, f"{compared}: too little to plough it, so that material is exchanged"
    return WearKind.ABRASIVE, f"{compared}, which is soft enough to be ploughed away"


def _effect(first: WearingBody, second: WearingBody) -> tuple[VibrationEffect, str]:
    hexagonal = [body.name for body in (first, second) if body.structure is CrystalStructure.HEXAGONAL]
    if hexagonal:
        return (
            VibrationEffect.MORE_WEAR,
            f"{hexagonal[0]} is hexagonal close-packed: hard and ductile at once, titanium stretched rather than "
            "broke, and vibration did not part it from the other body",
        )
    return (
        VibrationEffect.LESS_WEAR,
        "neither body is hexagonal close-packed: in all such pairs contact that was broken by vibration wore less",
    )


def _outside(first: WearingBody, second: WearingBody) -> tuple[str, ...]:
    if first.structure is second.structure is CrystalStructure.NOT_A_METAL:
        return ("No pair without a metal was tested: the rule says nothing of such pairs.",)
    return ()
