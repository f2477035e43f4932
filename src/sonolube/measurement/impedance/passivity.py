"""Passivity of a measured spectrum: one turned by 180 degrees is recognised and turned back."""

from dataclasses import replace

import numpy as np

from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum

_NEARLY_ALL = 0.95  # of the conductance summed over the points


def passive_spectrum(spectrum: ImpedanceSpectrum) -> tuple[ImpedanceSpectrum, tuple[str, ...]]:
    r"""Spectrum with a sign that a passive part can have, and a caveat where it was turned by 180 degrees.

    Parameters
    ----------
    spectrum : ImpedanceSpectrum
        As read.

    Returns
    -------
    spectrum : ImpedanceSpectrum
        With the opposite sign where nearly all conductance of the given one is negative, else the given one.
    caveats : tuple of str
        One line where it was turned.

    Notes
    -----
    A passive part takes power: :math:`\operatorname{Re} Y \ge 0` at every frequency. Where current or voltage is wired
    or defined in the opposite sense, the whole spectrum has the opposite sign. Of the conductance

    .. math:: \frac{\sum_i \max(-\operatorname{Re} Y_i, 0)}{\sum_i |\operatorname{Re} Y_i|} \ge 0.95

    is then negative; the sum has little weight where the conductance is so small that noise decides its sign.
    """
    if not spectrum.has_phase:
        return spectrum, ()
    conductance = spectrum.admittance.real
    total, negative = float(np.abs(conductance).sum()), float(np.maximum(-conductance, 0).sum())
    if not (total > 0 and negative >= _NEARLY_ALL * total):
        return spectrum, ()
    share = float(np.mean(conductance < 0))
    caveat = (
        f"the file holds a spectrum turned by 180 degrees: the conductance is negative at {share:.0%} of its points,"
        " which no passive part has; current or voltage has the opposite sign, and the spectrum was turned back"
    )
    return replace(spectrum, impedance=-spectrum.impedance), (caveat,)
