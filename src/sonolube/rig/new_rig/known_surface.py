"""Surfaces of which a finish is stated or a scan exists, and the roughness of two of them in contact."""

from dataclasses import dataclass
from math import exp, hypot, log
from pathlib import Path
from typing import Final

from sonolube.measurement.surface_files.reader import read_height_map
from sonolube.models import surfaces
from sonolube.rig.file.stated_surface import height_of_finish

_SCAN_DEVIATION: Final = 0.1
_SCANNED_SUMMITS_DEVIATION: Final = 0.4


@dataclass(frozen=True, kw_only=True, slots=True)
class KnownSurface:
    """Roughness of one surface, or of two in contact, with how well it is known.

    Parameters
    ----------
    roughness : Roughness
        Height, summit radius and summit density: medians.
    height_deviation, radius_deviation, density_deviation : float
        Standard deviations of the logarithms of height, radius and density of the summits.
    height_reason, summit_reason : str
        Where they come from.
    """

    roughness: surfaces.Roughness
    height_deviation: float
    radius_deviation: float
    density_deviation: float
    height_reason: str
    summit_reason: str


def finished_surface(finish: str) -> KnownSurface:
    """Surface by its process, its ISO grade or both, or by Ra, Rz or Rq."""
    height = height_of_finish(finish)
    summits = surfaces.typical_summits(rms_height=height.rms_height)
    return KnownSurface(
        roughness=surfaces.Roughness(
            rms_height=height.rms_height, summit_radius=summits.summit_radius, summit_density=summits.summit_density
        ),
        height_deviation=log(height.factor),
        radius_deviation=log(summits.radius_factor) / 2,
        density_deviation=log(summits.density_factor) / 2,
        height_reason=height.reason,
        summit_reason=f"typical of the height; {summits.reason}",
    )


def scanned_surface(path: str | Path) -> KnownSurface:
    """Surface by a scan: rms height of the levelled map, and its summits.

    The height is taken as known within 10 %, the spread between places; the summits, which depend on the distance of
    the pixels, within a factor of 1.5.
    """
    levelled = surfaces.remove_form(read_height_map(Path(path)), degree=1)
    summits = surfaces.contact_roughness(levelled)
    name = Path(path).name
    return KnownSurface(
        roughness=surfaces.Roughness(
            rms_height=surfaces.height_parameters(levelled).rms_height,
            summit_radius=summits.summit_radius,
            summit_density=summits.summit_density,
        ),
        height_deviation=_SCAN_DEVIATION,
        radius_deviation=_SCANNED_SUMMITS_DEVIATION,
        density_deviation=_SCANNED_SUMMITS_DEVIATION,
        height_reason=f"Sq of {name}, levelled; 10 % between places assumed",
        summit_reason=f"summits of {name}; they depend on the distance of its pixels",
    )


def surfaces_in_contact(pin: KnownSurface, disc: KnownSurface) -> KnownSurface:
    r"""Combined roughness of two surfaces.

    Heights add as variances, summits as by `combined_roughness`:

    .. math:: R_q = \sqrt{R_{q,1}^2 + R_{q,2}^2}

    Each surface is taken as uncertain on its own in its height; the summits of both share the relation they come from.
    """
    heights = [each.roughness.rms_height for each in (pin, disc)]
    height = hypot(*heights)
    shares = [(each / height) ** 2 for each in heights]
    summits = surfaces.combined_roughness(pin.roughness, disc.roughness)
    return KnownSurface(
        roughness=surfaces.Roughness(
            rms_height=height, summit_radius=summits.summit_radius, summit_density=summits.summit_density
        ),
        height_deviation=hypot(shares[0] * pin.height_deviation, shares[1] * disc.height_deviation),
        radius_deviation=max(pin.radius_deviation, disc.radius_deviation),
        density_deviation=max(pin.density_deviation, disc.density_deviation),
        height_reason=_of_both(pin.height_reason, disc.height_reason),
        summit_reason=_of_both(pin.summit_reason, disc.summit_reason),
    )


def lognormal_text(deviation: float) -> str:
    """Lognormal distribution as a rig file writes it, by the standard deviation of the logarithm."""
    return f"lognormal factor {exp(deviation):.4g}"


def _of_both(pin: str, disc: str) -> str:
    return f"both: {pin}" if pin == disc else f"pin: {pin}; disc: {disc}"
