"""Shapes of ultrasonic horns as bodies with one adjustable length, sized by the wavelength where no size is given."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from scipy.optimize import brentq

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.actuator import ThinHorn, thin_conical_horn, thin_exponential_horn, thin_stepped_horn
from sonolube.models.fem import PARTS, Geometry, adjust_length
from sonolube.models.fem.parts.length_adjustment import extent_along

_SMALLEST_END = 0.1  # of the radius, of a working end that is chosen by the gain
_RADIUS_RATIO = 0.08  # default radius over the wavelength; plane sections need it well below a quarter
_POISSON_HORN = {"width": 60.96e-3, "thickness": 25.4e-3}  # D 2.1.3
_NOT_SIZES = ("slots",)

SizeRule = Callable[[float, Mapping[str, float]], dict[str, float]]
"""Default sizes from the wavelength and the sizes that are given, all in m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TunableBody:
    """Body with one length to be tuned.

    Parameters
    ----------
    name : str
    geometry_at : callable
        From the length in m to the geometry.
    length : float
        Initial length. [m]
    axis : str
        Axis of vibration; the outward normal of the working face points along it, that of the driven face against it.
    sizes : mapping of str to float
        All other sizes, in SI.
    tuned_size : str
        Name of the length that is tuned.
    thin : ThinHorn or None
        Thin-bar solution, where there is one for the shape.
    """

    name: str
    geometry_at: Callable[[float], Geometry]
    length: float
    axis: str
    sizes: Mapping[str, float]
    tuned_size: str = "length"
    thin: ThinHorn | None = None


def horn_body(
    shape: str,
    *,
    frequency: float,
    wave_speed: float,
    sizes: Mapping[str, float],
    tune: str = "length",
    gain: float | None = None,
) -> TunableBody:
    """Horn of a named shape, with default sizes by the wavelength.

    Its initial length, where it is not given, is that of the thin bar.

    See Also
    --------
    body_from_geometry
    """
    if shape not in SHAPES:
        raise UnknownName.among(SHAPES, kind="horn", name=shape)
    axis, size_rule = SHAPES[shape]
    known = [name for name in inspect.signature(PARTS[shape]).parameters if name not in _NOT_SIZES]
    for name in (*sizes, tune):
        if name not in known:
            raise UnknownName.among(known, kind=f"size of a {shape}", name=name)
    wavelength = float(require_positive(wave_speed=wave_speed) / require_positive(frequency=frequency))
    if gain is not None:
        radius = _end_radius(shape, gain, wavelength, sizes, known, frequency=frequency, wave_speed=wave_speed)
        sizes = {**sizes, "end_radius": radius}
    given = size_rule(wavelength, sizes) | dict(sizes)
    thin = _thin_horn(shape, given, frequency=frequency, wave_speed=wave_speed)
    initial = sizes.get(tune, given.get(tune, thin.length))
    fixed = {name: value for name, value in ({"length": thin.length} | given).items() if name != tune}
    return TunableBody(
        name=shape,
        geometry_at=lambda length: PARTS[shape](**{tune: length}, **fixed),
        length=float(initial),
        axis=axis,
        sizes=fixed,
        tuned_size=tune,
        thin=thin if tune == "length" else None,
    )


def body_from_geometry(geometry: Geometry, *, axis: str) -> TunableBody:
    """Horn of any geometry, whose length is adjusted by cutting off or extending its far end.

    See Also
    --------
    horn_body
    """
    low, high = extent_along(geometry, axis=axis)
    return TunableBody(
        name=geometry.regions[0],
        geometry_at=lambda length: adjust_length(geometry, axis=axis, length=length),
        length=high - low,
        axis=axis,
        sizes={},
    )


def _end_radius(
    shape: str,
    gain: float,
    wavelength: float,
    sizes: Mapping[str, float],
    known: Sequence[str],
    *,
    frequency: float,
    wave_speed: float,
) -> float:
    """Radius of the working end with which the thin bar has a displacement gain."""
    if "end_radius" in sizes or "end_radius" not in known:
        reason = "is chosen by end_radius; give one of them" if "end_radius" in sizes else f"{shape} has only gain 1"
        raise InvalidInput(f"gain {gain:g}: {reason}")
    rule = SHAPES[shape][1]
    radius = (rule(wavelength, sizes) | dict(sizes))["radius"]

    def excess(share: float) -> float:
        own = {**sizes, "end_radius": share * radius}
        return (
            _thin_horn(shape, rule(wavelength, own) | own, frequency=frequency, wave_speed=wave_speed).displacement_gain
            - gain
        )

    most = gain + excess(_SMALLEST_END)
    if not 1.0 <= gain <= most:
        raise InvalidInput(
            f"gain {gain:g}: a {shape} has 1 to {most:.3g} for ends of {_SMALLEST_END:.0%} of its radius"
        )
    return radius * float(brentq(excess, _SMALLEST_END, 1.0)) if gain > 1.0 else radius


def _thin_horn(shape: str, sizes: Mapping[str, float], *, frequency: float, wave_speed: float) -> ThinHorn:
    """Half-wave horn of a shape by the theory of thin bars."""
    wave = {"frequency": frequency, "wave_speed": wave_speed}
    if shape in {"block", "cylinder"}:
        return thin_exponential_horn(radius=1.0, end_radius=1.0, **wave)
    radii = {"radius": sizes["radius"], "end_radius": sizes["end_radius"]}
    if shape in {"stepped_horn", "booster"}:
        return thin_stepped_horn(**radii, end_length=sizes["end_length"], **wave)
    return (thin_conical_horn if shape == "conical_horn" else thin_exponential_horn)(**radii, **wave)


def _round_sizes(wavelength: float, sizes: Mapping[str, float], end_ratio: float = 0.5) -> dict[str, float]:
    """Default radii of a round horn."""
    radius = sizes.get("radius", _RADIUS_RATIO * wavelength)
    return {"radius": radius, "end_radius": end_ratio * radius}


def _stepped_sizes(wavelength: float, sizes: Mapping[str, float]) -> dict[str, float]:
    """Default sizes of a stepped horn: a step at a quarter of the wavelength, with a fillet of half its height."""
    radii = _round_sizes(wavelength, sizes)
    step = radii["radius"] - sizes.get("end_radius", radii["end_radius"])
    return radii | {"end_length": wavelength / 4, "edge_radius": max(step, 0.0) / 2}


def _booster_sizes(wavelength: float, sizes: Mapping[str, float]) -> dict[str, float]:
    """Default sizes of a booster with a clamping flange."""
    radii = _round_sizes(wavelength, sizes, end_ratio=0.8)
    flange = {"flange_radius": 1.3 * radii["radius"], "flange_thickness": 0.02 * wavelength}
    return radii | flange | {"end_length": wavelength / 4}


SHAPES: Mapping[str, tuple[str, SizeRule]] = {
    "block": ("x", lambda _wavelength, _sizes: dict(_POISSON_HORN)),
    "booster": ("z", _booster_sizes),
    "conical_horn": ("z", _round_sizes),
    "cylinder": ("z", lambda wavelength, _sizes: {"radius": _RADIUS_RATIO * wavelength}),
    "exponential_horn": ("z", _round_sizes),
    "stepped_horn": ("z", _stepped_sizes),
}
"""Horn shapes by their name in `PARTS`: the axis of vibration, and the rule for its default sizes."""
