"""Contact stiffness from measured spectra: fits, choice of the resonance, and the estimate."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.contact_stiffness.resonance_fit import Resonance, ResonanceFit, fit_resonances
from sonolube.measurement.contact_stiffness.resonance_spectrum import ResonanceSpectrum
from sonolube.measurement.contact_stiffness.stiffness_estimate import ContactStiffness, contact_stiffness, single_mode
from sonolube.models.dynamics import Structure

_WITHIN = 2.0  # factor about a stated frequency within which a spectrum is fitted


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MeasuredContactStiffness:
    """Contact stiffness with the fits that it rests on.

    Parameters
    ----------
    stiffness : ContactStiffness
    free : tuple of ResonanceFit
        One or two.
    pressed : ResonanceFit
    large : ResonanceFit or None
        At the large vibration.
    chosen : tuple of Resonance
        The resonance in each spectrum, in the order free, pressed, free again, large.
    caveats : tuple of str
        Of fits and estimate.
    """

    stiffness: ContactStiffness
    free: tuple[ResonanceFit, ...]
    pressed: ResonanceFit
    large: ResonanceFit | None
    chosen: tuple[Resonance, ...]
    caveats: tuple[str, ...]


def measured_contact_stiffness(
    free: Sequence[ResonanceSpectrum],
    pressed: ResonanceSpectrum,
    *,
    normal_load: float,
    structure: Structure | None = None,
    modal_mass: float | None = None,
    modal_mass_deviation: float = 0.1,
    mode_near: float | None = None,
    pressed_near: float | None = None,
    large: ResonanceSpectrum | None = None,
    vibration_amplitude: float | None = None,
    log_amplitude_deviation: float = 0.05,
) -> MeasuredContactStiffness:
    """Normal stiffness and decay length of a contact from spectra measured free, pressed and free again.

    Parameters
    ----------
    free : sequence of ResonanceSpectrum
        Lifted: before, and if two also after the pressed one.
    pressed : ResonanceSpectrum
        Under the load.
    normal_load : float
        Force pressing the bodies together. [N]
    structure : Structure or None
        With its contact free.
    modal_mass : float or None
        Of the mode at the contact, instead of a structure. [kg]
    modal_mass_deviation : float
        Standard deviation of the logarithm of the modal mass.
    mode_near : float or None
        Frequency near which the free resonance is taken, in Hz; zero for a rigid-body mode; the strongest where None.
    pressed_near : float or None
        Frequency near which the pressed one is taken, in Hz; the nearest above the free one where None.
    large : ResonanceSpectrum or None
        Under the load, at a large vibration of constant amplitude.
    vibration_amplitude : float or None
        That amplitude at the contact, zero to peak. [m]
    log_amplitude_deviation : float
        Standard deviation of its logarithm.

    Returns
    -------
    MeasuredContactStiffness

    Raises
    ------
    InvalidInput
        If a spectrum shows no resonance, neither structure nor modal mass is given, or a frequency is out of range.

    See Also
    --------
    contact_stiffness : the estimate from resonances that are known.
    """
    if not 1 <= len(free) <= 2:
        raise InvalidInput(f"free must hold one or two spectra, got {len(free)}")
    if structure is None and modal_mass is None:
        raise InvalidInput(
            "modal_mass is missing and there is no structure; give the modal mass at the contact, or a rig with the"
            " tables stack and structure"
        )
    floats = mode_near == 0
    if floats and (structure is None or modal_mass is not None):
        raise InvalidInput("mode_near 0 Hz is a rigid-body mode of a structure; give no modal_mass, and a structure")
    about = pressed_near if floats else mode_near
    free_fits = tuple(() if floats else (_fit(one, mode_near) for one in free))
    found = [fit.strongest() if mode_near is None else fit.nearest(mode_near) for fit in free_fits[:1]]
    found += [fit.nearest(found[0].frequency) for fit in free_fits[1:]]
    pressed_fit = _fit(pressed, about)
    at_load = _pressed(pressed_fit, found, pressed_near)
    large_fit = None if large is None else _fit(large, about)
    at_large = None if large_fit is None else _between(large_fit, found, at_load)
    if modal_mass is not None:
        mean = float(np.mean([one.frequency for one in found]))
        structure = single_mode(modal_mass=modal_mass, frequency=mean)
    assert structure is not None
    estimate = contact_stiffness(
        structure,
        free=found,
        pressed=at_load,
        normal_load=normal_load,
        modal_mass_deviation=modal_mass_deviation,
        large=at_large,
        vibration_amplitude=vibration_amplitude,
        log_amplitude_deviation=log_amplitude_deviation,
    )
    own = [
        f"{fit.spectrum.file_name or fit.spectrum.quantity}: {caveat}"
        for fit in (*free_fits, pressed_fit, large_fit)
        if fit is not None
        for caveat in (*fit.spectrum.caveats, *fit.caveats)
    ]
    return MeasuredContactStiffness(
        stiffness=estimate,
        free=free_fits,
        pressed=pressed_fit,
        large=large_fit,
        chosen=(*found[:1], at_load, *found[1:], *([] if at_large is None else [at_large])),
        caveats=tuple(dict.fromkeys((*estimate.caveats, *own))),
    )


def _fit(spectrum: ResonanceSpectrum, near: float | None) -> ResonanceFit:
    """Resonances of a spectrum, within a factor of two of a stated frequency."""
    return fit_resonances(spectrum if not near else spectrum.between(near / _WITHIN, near * _WITHIN))


def _pressed(fit: ResonanceFit, free: Sequence[Resonance], near: float | None) -> Resonance:
    """Pressed resonance: near a stated frequency, else the nearest one not below the free one, else the lowest."""
    if near is not None:
        return fit.nearest(near)
    if not free:
        return fit.resonances[0]
    lowest = min(one.frequency for one in free)
    spread = max(one.frequency for one in free) - lowest
    room = spread + 4 * (free[0].frequency_uncertainty + max(one.frequency_uncertainty for one in fit.resonances))
    above = [one for one in fit.resonances if one.frequency > lowest - room]
    return above[0] if above else fit.nearest(lowest)


def _between(fit: ResonanceFit, free: Sequence[Resonance], pressed: Resonance) -> Resonance:
    """Resonance at the large vibration: the strongest between the free and the pressed one, else the nearest."""
    lowest = min((one.frequency for one in free), default=0.0)
    inside = [one for one in fit.resonances if lowest <= one.frequency <= pressed.frequency]
    return max(inside, key=lambda one: one.relative_height) if inside else fit.nearest(pressed.frequency)
