"""Roughness of the contacts of the published tests: what is printed, and how far the input of a test is known.

Two surfaces touch and D prints the roughness of one at most; its Table 3.2 has 6 um, which section 3.1.4 takes from
comparison standards. What is printed of the surfaces of a test:

=====  ===================================================================================  ===============
set    printed                                                                              in the records
=====  ===================================================================================  ===============
A      R_q = 0.58 um unworn; 19 to 23 um across grooves, their shape included (Table 2.4)   6 um
B      1.69 um unworn, no kind named; no volume lost (4.1.3)                                2.12 um
C      0.45 um unworn, 1.8 um worn under vibration, no kind named (2.5.2)                   6 um
D      nothing                                                                              6 um
E, F   "a mirror-like surface finish" (2.5.4)                                               6 um
G      R_q = 0.857 um unworn, worn 2.54 um at the round and 0.87 um at the flat tip (2.10)  6 um
H      nothing                                                                              6 um
=====  ===================================================================================  ===============

Where no kind is named the number is read as R_a: the 0.45 um of section 2.5.2 is R_a in Table 2.4. Only the plates of
set B are known to have kept the printed roughness during the test. Records of C and G keep the input of Table 3.2: the
groove of C grew rougher during the test, by an unknown course; with 0.87 um the vibration of G, 11.5 um, would
close the gap, where models of rough contact have no meaning. Their spread is the distance to the printed value,
and `published_tests.with_printed_roughness` puts that in its place: it fits worse.
"""

from functools import cache
from math import hypot, log
from typing import Final

from sonolube.facts.published import si_value
from sonolube.validation.contacts import RMS_OVER_ARITHMETIC_MEAN, uncoated_plate_contact, wear_contact

_GUESSED: Final = log(2)  # to the next grade of a comparison standard, which doubles; D 3.1.4
_COUNTERFACE: Final = log(2) / 4  # half the way from one rough surface to two alike, a factor of sqrt(2) in R_q


def roughness_spread(label: str) -> float:
    r"""Standard deviation of ln R_q that the provenance of a test's roughness justifies. []

    0.21 for set B; 0.69, a factor of two, where R_q is that of comparison standards; where a roughness is printed that
    the record does not have, the distance to it: 0.98 for C, 0.86 and 1.93 for the tips of G.

    For set B the deviation adds in quadrature half of the step from R_q to R_a, ln(pi/2)/4 = 0.11, and half of the step
    from a smooth pin to one as rough as the plate, ln(2)/4 = 0.17:

    .. math:: \sigma_{\ln R_q} = \sqrt{0.11^2 + 0.17^2} = 0.21 .
    """
    printed = _printed_rms_heights().get(label)
    if printed is None:
        return _GUESSED
    if label[0] == "B":
        return hypot(log(RMS_OVER_ARITHMETIC_MEAN) / 2, _COUNTERFACE)
    return log(wear_contact().roughness.rms_height / printed)


def printed_rms_height(label: str) -> float | None:
    """R_q as printed for the worn surface of a test, of sets B, C and G; None where none is printed. [m]"""
    return _printed_rms_heights().get(label)


@cache
def _printed_rms_heights() -> dict[str, float]:
    """R_q as printed for the worn surface of a test, by label. [m]"""
    plates = dict.fromkeys([f"B-{level}" for level in range(1, 6)], uncoated_plate_contact().roughness.rms_height)
    return plates | {
        "C-1": RMS_OVER_ARITHMETIC_MEAN * si_value("2.5.2-roughness-on"),
        "G-1": si_value("table-2.10-rms_height-2"),
        "G-2": si_value("table-2.10-rms_height-3"),
    }
