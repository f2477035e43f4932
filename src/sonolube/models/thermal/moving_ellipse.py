r"""Dimensionless surface rise under a uniform moving elliptic source, by quadrature.

Rises are in units of :math:`\bar q b/k`; lengths along the sliding in units of the half length b, across it in units of
the half width, which is `aspect` times b.
"""

from functools import cache

import numpy as np

from sonolube.checks import Floats

__all__: list[str] = []  # used within this package only

_NODES = 10  # of Gauss and Legendre, in each panel
_HALVINGS = 22  # of the panels of the angle: resolve the width Pe^-1/2 of the wake to Peclet numbers of 1e12
_HALVINGS_OF_DISTANCE = 40  # resolve the width 1/Pe
_HALVINGS_AT_EDGE = 12  # towards a point where it has the root of a distance only
_PLACES = 41  # along the middle chord, between which the peak is sought
_NARROWINGS = 5  # of that interval


@cache
def _angles() -> tuple[Floats, Floats]:
    """Angles from 0 to pi and their weights: panels that narrow towards 0, pi/2 and pi."""
    towards = np.pi / 4 * 2.0 ** -np.arange(_HALVINGS)
    edges = np.concatenate(
        ([0.0, np.pi / 2, np.pi], towards, np.pi / 2 - towards, np.pi / 2 + towards, np.pi - towards)
    )
    return _panels(np.unique(edges))


@cache
def _distances() -> tuple[Floats, Floats]:
    """Distances from 0 to 2 and their weights: panels that narrow towards both ends."""
    edges = (0.0, 2.0, *2.0 ** -np.arange(_HALVINGS_OF_DISTANCE), *(2 - 2.0 ** -np.arange(_HALVINGS_AT_EDGE)))
    return _panels(np.unique(edges))


def _panels(edges: Floats) -> tuple[Floats, Floats]:
    """Nodes and weights of Gauss and Legendre in all panels between neighbouring edges."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    half = np.diff(edges)[:, np.newaxis] / 2
    return (edges[:-1, np.newaxis] + half * (1 + nodes)).ravel(), (half * weights).ravel()


def mean_rise(*, peclet: float, aspect: float) -> float:
    r"""Mean rise over the ellipse.

    With the area :math:`A(\rho) = 2\arccos(\rho/2) - (\rho/2)\sqrt{4 - \rho^2}` in which two unit discs at the distance
    :math:`\rho` overlap, the aspect w and :math:`h = \sqrt{\cos^2\phi + w^2 \sin^2\phi}`, the mean of
    :math:`e^{-\mathrm{Pe}(R + \Delta x)}/2\pi R` over all pairs of points is

    .. math:: \frac{w}{\pi^2} \int_0^\pi \frac{d\phi}{h}
        \int_0^2 A(\rho)\, e^{-\mathrm{Pe}\,\rho\,(h + \cos\phi)}\, d\rho .
    """
    angle, angle_weight = _angles()
    distance, distance_weight = _distances()
    overlap = 2 * np.arccos(distance / 2) - distance / 2 * np.sqrt(4 - distance**2)
    cosine, across = np.cos(angle), (aspect * np.sin(angle)) ** 2
    reach = np.sqrt(cosine**2 + across)
    decay = np.where(cosine < 0, across / (reach + np.abs(cosine)), reach + cosine)  # h + cos, without cancellation
    inner = np.exp(-peclet * decay[:, np.newaxis] * distance) @ (distance_weight * overlap)
    return float(aspect / np.pi**2 * (angle_weight / reach) @ inner)


def peak_rise(*, peclet: float, aspect: float) -> float:
    """Highest rise, which lies on the middle chord at or behind the centre."""
    low, high = 0.0, np.pi / 2
    for _ in range(_NARROWINGS):
        angle = np.linspace(low, high, _PLACES)  # of the place -cos(angle), which crowds towards the trailing end
        rise = _rise_on_chord(-np.cos(angle), peclet=peclet, aspect=aspect)
        best = int(np.argmax(rise))
        low, high = angle[max(best - 1, 0)], angle[min(best + 1, _PLACES - 1)]
    return float(rise[best])


def _rise_on_chord(place: Floats, *, peclet: float, aspect: float) -> Floats:
    r"""Rise at places on the middle chord, from -1 at its trailing end to 1.

    In polar coordinates about the place, with the distance :math:`L(\phi)` to the edge in the direction of the angle
    :math:`\phi` from the sliding, the integral over the distance is elementary:

    .. math:: \frac1\pi \int_0^\pi L\, \frac{1 - e^{-u}}{u}\, d\phi, \qquad u = \mathrm{Pe}\,(1 - \cos\phi)\, L .
    """
    angle, weight = _angles()
    cosine, sine = np.cos(angle), np.sin(angle)
    x = place[:, np.newaxis]
    square = cosine**2 + (sine / aspect) ** 2
    root = np.sqrt((x * cosine) ** 2 + (1 - x**2) * square)
    ahead = x * cosine
    to_edge = np.where(ahead > 0, (1 - x**2) / (root + np.abs(ahead)), (root - ahead) / square)
    u = peclet * 2 * np.sin(angle / 2) ** 2 * to_edge
    steep = np.maximum(u, 1e-300)
    return np.asarray((to_edge * np.where(u > 1e-12, -np.expm1(-u) / steep, 1.0)) @ weight / np.pi)
