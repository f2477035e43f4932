"""Laws of elastic-plastic asperities by name: force and contact area of one asperity relative to Hertz's sphere.

Every law gives two ratios as functions of the interference w over the critical interference w_c, at which yielding
begins: the force over that of an elastic sphere of the same radius (`force_ratio`), and the contact area over that of
the sphere (`area_ratio`). `asperity_force` and `asperity_area` evaluate force and area with them. A new law takes one
file `contact/asperity_laws/NAME.py` with its class, and one line of `ASPERITY_LAWS`; nothing else names a law.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import OutsideRange
from sonolube.models.contact.elastic_bodies import ContactPair
from sonolube.variants import VariantTable

Piece = float | Callable[[Floats], Floats]


class AsperityLaw(Protocol):
    """Force and contact area of an asperity over those of Hertz's elastic sphere, as functions of the interference.

    Attributes
    ----------
    name : str
        Name in `ASPERITY_LAWS`, and value of `asperity_law` in rig files.
    citation : str
        Source of the law.
    breakpoints : tuple of float
        Interferences over the critical one at which the law passes from one expression to the next; the integrals over
        the heights place panel ends there.
    """

    name: ClassVar[str]
    citation: ClassVar[str]
    breakpoints: ClassVar[tuple[float, ...]]

    def yield_pressure(self, pair: ContactPair) -> float:
        """Peak contact pressure at the onset of yielding. [Pa]

        Parameters
        ----------
        pair : ContactPair

        Returns
        -------
        float
        """

    def force_ratio(self, pair: ContactPair, interference_ratio: Floats) -> Floats:
        """Force over that of an elastic asperity at the same interference. []

        Parameters
        ----------
        pair : ContactPair
        interference_ratio : ndarray, any shape
            Interference over the critical one. []

        Returns
        -------
        ndarray, shape of `interference_ratio`
        """

    def area_ratio(self, pair: ContactPair, interference_ratio: Floats) -> Floats:
        """Contact area over that of an elastic asperity at the same interference. []

        Parameters
        ----------
        pair : ContactPair
        interference_ratio : ndarray, any shape
            Interference over the critical one. []

        Returns
        -------
        ndarray, shape of `interference_ratio`
        """


@dataclass(frozen=True, slots=True)
class ElasticAsperity:
    """Hertz's elastic sphere without yielding; with Gaussian heights, the contact of Greenwood and Williamson.

    Notes
    -----
    Both ratios are 1, and the pressure at the onset of yielding is infinite.

    References
    ----------
    .. [1] J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966). doi:10.1098/rspa.1966.0242
    """

    name: ClassVar[str] = "elastic"
    citation: ClassVar[str] = "J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966)"
    breakpoints: ClassVar[tuple[float, ...]] = ()

    def yield_pressure(self, pair: ContactPair) -> float:
        """Peak contact pressure at the onset of yielding: infinite. [Pa]"""
        return math.inf

    def force_ratio(self, pair: ContactPair, interference_ratio: Floats) -> Floats:
        """Force over that of an elastic asperity: one. []"""
        return np.ones_like(interference_ratio)

    def area_ratio(self, pair: ContactPair, interference_ratio: Floats) -> Floats:
        """Contact area over that of an elastic asperity: one. []"""
        return np.ones_like(interference_ratio)


@dataclass(frozen=True, slots=True)
class _ConstantVolumeAsperity:
    """Constant pressure and conserved volume of an asperity beyond its critical interference."""

    breakpoints: ClassVar[tuple[float, ...]] = (1.0,)

    def force_ratio(self, pair: ContactPair, interference_ratio: Floats) -> Floats:
        """Force over that of an elastic asperity. []"""
        return _piecewise(interference_ratio, self.breakpoints, lambda r: 1.5 * (2 * r - 1) / r**1.5)

    def area_ratio(self, pair: ContactPair, interference_ratio: Floats) -> Floats:
        """Contact area over that of an elastic asperity. []"""
        return _piecewise(interference_ratio, self.breakpoints, lambda r: 2 - 1 / r)


@dataclass(frozen=True, slots=True)
class Dong2015Asperity(_ConstantVolumeAsperity):
    r"""Law of Chang, Etsion and Bogy as Dong (2015) prints it, with the factor 1 - nu^2 counted twice.

    Notes
    -----
    .. math::

        w_c = \left( \frac{\pi C_\nu (1 - \nu^2)\, Y_0}{2 E^*} \right)^2 R_s, \qquad C_\nu = 1.234 + 1.256\,\nu

    Otherwise as `ChangEtsionBogy`, including the jump of the force. Brizmer, Kligerman and Etsion [2]_ print the factor
    1 - nu^2 over the Young's modulus of the sphere, not over E*, of which it is part already; counted again it weakens
    the softer body by 11 % at nu = 0.33. It is kept because the published wear rates follow from it to four digits.

    References
    ----------
    .. [1] D 3.1, 3.4, 3.5, 3.7, 3.8
    .. [2] V. Brizmer, Y. Kligerman and I. Etsion, Int. J. Solids Struct. 43, 5736 (2006).
       doi:10.1016/j.ijsolstr.2005.07.034
    """

    name: ClassVar[str] = "dong_2015"
    citation: ClassVar[str] = "D 3.1 to 3.8 as printed, after Chang, Etsion and Bogy"

    def yield_pressure(self, pair: ContactPair) -> float:
        """Peak contact pressure at the onset of yielding, C_nu (1 - nu^2) Y_0. [Pa]"""
        return _hardness_coefficient(pair) * (1 - pair.poisson_ratio**2) * pair.yield_strength


@dataclass(frozen=True, slots=True)
class ChangEtsionBogy(_ConstantVolumeAsperity):
    r"""Law of Chang, Etsion and Bogy beyond yielding, whose onset is that of Brizmer, Kligerman and Etsion.

    Notes
    -----
    .. math::

        p_Y = C_\nu Y_0, \quad C_\nu = 1.234 + 1.256\,\nu, \qquad
        a = \pi R_s (2 w - w_c), \quad f = p_Y\, a \quad \text{for } w \ge w_c

    A constant pressure and conserved asperity volume beyond the onset [1]_. The critical interference
    :math:`w_c = (\pi C_\nu Y_0 / 2 E^*)^2 R_s` is not that of 1987, which `ChangEtsionBogy1987` has, but follows from
    von Mises' criterion for any Poisson's ratio [2]_, as D 3.1 takes it; both agree at nu = 0.355.

    The area is continuous at the onset of yielding. The mean pressure jumps there from 2/3 of C_nu Y_0 to C_nu Y_0, and
    with it the force by a half.

    References
    ----------
    .. [1] W. R. Chang, I. Etsion and D. B. Bogy, J. Tribol. 109, 257 (1987). doi:10.1115/1.3261348
    .. [2] V. Brizmer, Y. Kligerman and I. Etsion, Int. J. Solids Struct. 43, 5736 (2006).
       doi:10.1016/j.ijsolstr.2005.07.034
    """

    name: ClassVar[str] = "chang_etsion_bogy"
    citation: ClassVar[str] = (
        "W. R. Chang, I. Etsion and D. B. Bogy, J. Tribol. 109, 257 (1987), with the onset of yielding of V. Brizmer,"
        " Y. Kligerman and I. Etsion, Int. J. Solids Struct. 43, 5736 (2006)"
    )

    def yield_pressure(self, pair: ContactPair) -> float:
        """Peak contact pressure at the onset of yielding, C_nu Y_0. [Pa]"""
        return _hardness_coefficient(pair) * pair.yield_strength


@dataclass(frozen=True, slots=True)
class ChangEtsionBogy1987(_ConstantVolumeAsperity):
    r"""Law of Chang, Etsion and Bogy with its own onset of yielding, at six tenths of the hardness.

    Notes
    -----
    .. math:: w_c = \left( \frac{\pi K H}{2 E^*} \right)^2 R_s, \qquad K = 0.6, \quad H = 2.8\, Y_0

    for any Poisson's ratio; otherwise as `ChangEtsionBogy`. Later publications of the authors take K = 0.454 + 0.41 nu,
    as `KogutEtsion` does, which is 0.6 at nu = 0.356.

    References
    ----------
    .. [1] W. R. Chang, I. Etsion and D. B. Bogy, J. Tribol. 109, 257 (1987). doi:10.1115/1.3261348
    """

    name: ClassVar[str] = "chang_etsion_bogy_1987"
    citation: ClassVar[str] = "W. R. Chang, I. Etsion and D. B. Bogy, J. Tribol. 109, 257 (1987), K = 0.6"

    def yield_pressure(self, pair: ContactPair) -> float:
        """Peak contact pressure at the onset of yielding, 0.6 H with the hardness H = 2.8 Y_0. [Pa]"""
        return 0.6 * 2.8 * pair.yield_strength


def _hardness_coefficient(pair: ContactPair) -> float:
    """C_nu, the peak pressure at the onset of yielding over the yield strength. []"""
    return 1.234 + 1.256 * pair.poisson_ratio  # D 3.1


def _piecewise(r: Floats, breakpoints: tuple[float, ...], *yielded: Piece) -> Floats:
    """1 below the onset of yielding and one expression from each breakpoint on."""
    return np.piecewise(r, [r >= 0, *(r >= each for each in breakpoints)], [1.0, *yielded])


@dataclass(frozen=True, slots=True)
class KogutEtsion:
    r"""Law of Kogut and Etsion: power laws fitted to finite elements, fully plastic from 110 critical interferences on.

    Notes
    -----
    With r = w/w_c and the force f_c and area a_c of Hertz at w_c,

    .. math::

        p_Y &= (0.454 + 0.41\,\nu)\, 2.8\, Y_0 \\
        f/f_c &= 1.03\, r^{1.425}, \quad a/a_c = 0.93\, r^{1.136} \quad (1 \le r < 6) \\
        f/f_c &= 1.40\, r^{1.263}, \quad a/a_c = 0.94\, r^{1.146} \quad (6 \le r < 110) \\
        a &= 2 \pi R_s w, \quad f = 2.8\, Y_0\, a \quad (110 \le r)

    The published fits are discontinuous. At r = 1, 6 and 110 the force jumps by +3.0, +1.7 and, for nu = 0.3, +7.9 %,
    the area by -7.0, +2.9 and +7.1 %. Beyond 110 the hardness is 2.8 Y_0 for contacts of any size.

    References
    ----------
    .. [1] L. Kogut and I. Etsion, J. Appl. Mech. 69, 657 (2002). doi:10.1115/1.1490373
    """

    name: ClassVar[str] = "kogut_etsion"
    citation: ClassVar[str] = "L. Kogut and I. Etsion, J. Appl. Mech. 69, 657 (2002)"
    breakpoints: ClassVar[tuple[float, ...]] = (1.0, 6.0, 110.0)

    def yield_pressure(self, pair: ContactPair) -> float:
        """Peak contact pressure at the onset of yielding, K H with the hardness H = 2.8 Y_0. [Pa]"""
        return self._pressure_coefficient(pair) * 2.8 * pair.yield_strength

    def force_ratio(self, pair: ContactPair, interference_ratio: Floats) -> Floats:
        """Force over that of an elastic asperity. []"""
        plastic = 3 / self._pressure_coefficient(pair)  # 2 pi R w H over the force at the onset, 2/3 K H pi R w_c
        return _piecewise(
            interference_ratio,
            self.breakpoints,
            lambda r: 1.03 * r ** (1.425 - 1.5),
            lambda r: 1.40 * r ** (1.263 - 1.5),
            lambda r: plastic * r ** (1 - 1.5),
        )

    def area_ratio(self, pair: ContactPair, interference_ratio: Floats) -> Floats:
        """Contact area over that of an elastic asperity. []"""
        pieces = (lambda r: 0.93 * r**0.136, lambda r: 0.94 * r**0.146, 2.0)
        return _piecewise(interference_ratio, self.breakpoints, *pieces)

    def _pressure_coefficient(self, pair: ContactPair) -> float:
        """K, the peak pressure at the onset of yielding over the hardness. []"""
        return 0.454 + 0.41 * pair.poisson_ratio


@dataclass(frozen=True, slots=True)
class JacksonGreen:
    r"""Law of Jackson and Green: fit to finite elements with a hardness that falls as the contact grows.

    Notes
    -----
    With r = w/w_c >= 1.9, the contact radius b and the force f_c of Hertz at w_c,

    .. math::

        p_Y &= C Y_0, \qquad C = 1.295\, e^{0.736\,\nu} \\
        \frac{a}{\pi R_s w} &= \left( \frac{r}{1.9} \right)^B, \qquad B = 0.14\, e^{23\, Y_0/E^*} \\
        \frac{H}{Y_0} &= 2.84 \left[ 1 - \exp\left( -0.82 \left( \frac{b}{R_s} \right)^{-0.7} \right) \right] \\
        \frac{f}{f_c} &= r^{3/2} e^{-r^{5/12}/4} + \frac{4 H}{C Y_0}\, r \left[ 1 - e^{-r^{5/9}/25} \right]

    Yielding begins below the surface at r = 1 and changes force and area from r = 1.9 on. There the area is continuous;
    the force jumps by +2.6 % at nu = 0.2, +0.5 % at 0.3 and -2.5 % at 0.45 for any yield strength. The area exponent
    was fitted to steels and grows exponentially with Y_0/E*; values above 0.05 are refused.

    References
    ----------
    .. [1] R. L. Jackson and I. Green, J. Tribol. 127, 343 (2005). doi:10.1115/1.1866166
    """

    name: ClassVar[str] = "jackson_green"
    citation: ClassVar[str] = "R. L. Jackson and I. Green, J. Tribol. 127, 343 (2005)"
    breakpoints: ClassVar[tuple[float, ...]] = (1.0, 1.9)

    def yield_pressure(self, pair: ContactPair) -> float:
        """Peak contact pressure at the onset of yielding, C Y_0. [Pa]"""
        return self._pressure_coefficient(pair) * pair.yield_strength

    def force_ratio(self, pair: ContactPair, interference_ratio: Floats) -> Floats:
        """Force over that of an elastic asperity. []"""
        C = self._pressure_coefficient(pair)
        yield_strain = pair.yield_strength / pair.effective_modulus

        def yielded(r: Floats) -> Floats:
            # contact radius over summit radius, and hardness over Y_0
            radius: Floats = math.pi * C * yield_strain / 2 * np.sqrt(r * self._area_growth(pair, r))
            hardness: Floats = 2.84 * (1 - np.exp(-0.82 * radius**-0.7))
            plastic: Floats = 4 * hardness / C * (1 - np.exp(-(r ** (5 / 9)) / 25)) / np.sqrt(r)
            return np.exp(-0.25 * r ** (5 / 12)) + plastic

        return _piecewise(interference_ratio, (1.9,), yielded)

    def area_ratio(self, pair: ContactPair, interference_ratio: Floats) -> Floats:
        """Contact area over that of an elastic asperity. []"""
        return _piecewise(interference_ratio, (1.9,), lambda r: self._area_growth(pair, r))

    def _area_growth(self, pair: ContactPair, r: Floats) -> Floats:
        """Contact area over that of Hertz beyond 1.9 critical interferences. []"""
        yield_strain = pair.yield_strength / pair.effective_modulus
        if yield_strain > 0.05:
            raise OutsideRange(
                f"the law of Jackson and Green holds for yield strengths up to 0.05 E*, got {yield_strain:.3g} E*: "
                "use the elastic law"
            )
        exponent = 0.14 * math.exp(23 * yield_strain)
        growth: Floats = (r / 1.9) ** exponent
        return growth

    def _pressure_coefficient(self, pair: ContactPair) -> float:
        """C, the peak pressure at the onset of yielding over the yield strength. []"""
        return 1.295 * math.exp(0.736 * pair.poisson_ratio)


ASPERITY_LAWS: VariantTable[AsperityLaw] = VariantTable(
    "asperity law",
    {
        "elastic": "sonolube.models.contact.asperity:ElasticAsperity",
        "dong_2015": "sonolube.models.contact.asperity:Dong2015Asperity",
        "chang_etsion_bogy": "sonolube.models.contact.asperity:ChangEtsionBogy",
        "chang_etsion_bogy_1987": "sonolube.models.contact.asperity:ChangEtsionBogy1987",
        "kogut_etsion": "sonolube.models.contact.asperity:KogutEtsion",
        "jackson_green": "sonolube.models.contact.asperity:JacksonGreen",
    },
    made=lambda law: law(),
)
"""Asperity laws by name; a new law takes its file and one line here."""
