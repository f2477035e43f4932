"""Decay length of worn contacts in published friction tests, and the caveat against one by roughness alone."""

from dataclasses import dataclass, replace
from math import exp, isfinite
from typing import Final

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.models.contact import ExponentialHeights, contact_caveats, decay_length
from sonolube.rig.friction_and_wear import friction_ratios, prescribed_sine
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig

CENTRAL_SHARE: Final = 0.95
"""Share of published contacts whose range of decay lengths the caveat gives. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class DecayLengthPopulation:
    """Lognormal distribution of the decay length over worn contacts.

    Parameters
    ----------
    median : float
        Decay length that half of the contacts exceed, in m.
    log_spread : float
        Standard deviation of its logarithm, a pure number.

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.
    """

    median: float
    log_spread: float

    def __post_init__(self) -> None:
        require_positive(median=self.median, log_spread=self.log_spread)

    @property
    def factor(self) -> float:
        """Geometric standard deviation: 68 % lie between the median over it and the median times it. []"""
        return exp(self.log_spread)

    def central_range(self, *, share: float = CENTRAL_SHARE) -> tuple[float, float]:
        """Central range that holds a share of the contacts, in m."""
        from statistics import NormalDist  # scipy.special takes a tenth of a second to load

        if not 0 < share < 1:
            raise InvalidInput(f"share must lie between 0 and 1, got {share:g}")
        width = exp(NormalDist().inv_cdf((1 + share) / 2) * self.log_spread)
        return self.median / width, self.median * width


PUBLISHED_DECAY_LENGTH: Final = DecayLengthPopulation(median=1.6e-6, log_spread=0.6)
"""Decay length of the worn contacts in the published friction tests.

Learned with the friction models from the friction of those tests, not from their roughness: amplitude enters the models
through its ratio to the decay length, and neither printed roughness nor load, hardness or size of the scar orders the
lengths that the tests ask for."""


def decay_length_caveat(rig: Rig | ResolvedRig, *, vibration_amplitude: float | None = None) -> str | None:
    """Caveat against a decay length by roughness that worn contacts of published tests do not have.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    vibration_amplitude : float, optional
        Zero to peak, at which the friction of both decay lengths is compared; the stated one where absent. [m]

    Returns
    -------
    str or None
        With the friction ratio of a sine of that amplitude by the rig's own friction model, for its own decay length
        and for the median of `PUBLISHED_DECAY_LENGTH`, where it has an amplitude; None where the rig states its decay
        length, its heights are not exponential, or R_q/lambda lies within the central 95 % of that population.
    """
    resolved = resolved_rig(rig)
    contact, (low, high) = resolved.rig.contact, PUBLISHED_DECAY_LENGTH.central_range()
    heights = contact.heights
    if contact.decay_length is not None or not isinstance(heights, ExponentialHeights):
        return None
    own = float(decay_length(contact))
    if low <= own <= high:
        return None
    return (
        f"decay length by roughness R_q/{heights.decay:g} = {_micrometres(own)} um; worn contacts of published tests"
        f" have {_micrometres(low)} to {_micrometres(high)} um ({100 * CENTRAL_SHARE:.0f} %); "
        f"{_ratios_text(resolved, vibration_amplitude)}give contact.decay_length or contact.normal_stiffness"
    )


def resting_caveats(resolved: ResolvedRig, *, vibration_amplitude: float | None = None) -> tuple[str, ...]:
    """Caveats of the contact of a rig under its load, that of its decay length included."""
    caveat = decay_length_caveat(resolved, vibration_amplitude=vibration_amplitude)
    own = contact_caveats(resolved.rig.contact, separation=resolved.separation)
    return (*own, *(() if caveat is None else (caveat,)))


def _ratios_text(resolved: ResolvedRig, amplitude: float | None) -> str:
    """Friction ratios by the decay length of the roughness and by that of published tests, in words."""
    if amplitude is None:
        amplitude = _stated_amplitude(resolved)
    if amplitude is None:
        return ""
    rig = resolved.rig
    worn = replace(rig, contact=replace(rig.contact, decay_length=PUBLISHED_DECAY_LENGTH.median))
    first, second = (_friction_ratio(one, amplitude) for one in (rig, worn))
    if first is None and second is None:
        return ""
    texts = ["none by the model" if ratio is None else f"{ratio:.2f}" for ratio in (first, second)]
    return f"friction ratio {texts[0]} with the first, {texts[1]} with their median; "


def _stated_amplitude(resolved: ResolvedRig) -> float | None:
    """Amplitude that a rig states or measured, not one that has to be computed. [m]"""
    try:
        used = resolved.vibration
    except SonolubeError:
        return None
    if used.sine_amplitude is None and used.source == "measured":
        return resolved.rig.vibration_amplitude
    return used.sine_amplitude


def _friction_ratio(rig: Rig, amplitude: float) -> float | None:
    """Friction ratio of a rig under a sine; None outside the range of its friction model."""
    try:
        motion = prescribed_sine(rig, vibration_amplitude=amplitude)
        ratio = float(friction_ratios(rig, motion, sliding_speed=rig.sliding_speed).friction_ratio)
    except SonolubeError:
        return None
    return ratio if isfinite(ratio) else None


def _micrometres(length: float) -> str:
    return f"{1e6 * length:.2g}"
