"""Shapes of horns: bodies from the length that is tuned, with sizes chosen by the wavelength where none is given."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from sonolube.actuator import ThinHorn, thin_conical_horn, thin_exponential_horn, thin_stepped_horn
from sonolube.checks import require_positive
from sonolube.errors import UnknownName
from sonolube.fem import PARTS, Geometry, adjust_length
from sonolube.fem.parts.length_adjustment import extent_along

_WIDE = 0.08  # radius over wavelength where none is given: a quarter of it is too thick for plane sections
_POISSON_HORN = {"width": 60.96e-3, "thickness": 25.4e-3}  # D 2.1.3


@dataclass(frozen=True, kw_only=True, slots=True)
class Body:
    """A body whose length is to be tuned.

    Parameters
    ----------
    name : str
    at : callable
        From the length in m to the geometry.
    length : float
        Length to start from. [m]
    axis : str
        Along which it vibrates; the working face looks along it, the driven one against.
    sizes : mapping of str to float
        All other sizes, in SI.
    tuned : str
        What the length is called.
    thin : ThinHorn or None
        The thin bar, where theory has one.
    """

    name: str
    at: Callable[[float], Geometry]
    length: float
    axis: str
    sizes: Mapping[str, float]
    tuned: str = "length"
    thin: ThinHorn | None = None


def horn_body(
    shape: str, *, frequency: float, wave_speed: float, sizes: Mapping[str, float], tune: str = "length"
) -> Body:
    """Return a horn of a shape by name, sizes that were not given chosen by the wavelength.

    Parameters
    ----------
    shape : str
        A name of `SHAPES`.
    frequency : float
        Frequency at which it shall ring. [Hz]
    wave_speed : float
        Of its material. [m/s]
    sizes : mapping of str to float
        Those given, in SI; one of the tuned length is where the search starts.
    tune : str
        Which length is tuned.

    Returns
    -------
    Body

    Raises
    ------
    UnknownName
        If the shape or a size of it is unknown.
    """
    if shape not in SHAPES:
        raise UnknownName.among(SHAPES, kind="horn shape", name=shape)
    part, axis, chosen = SHAPES[shape]
    known = [name for name in inspect.signature(PARTS[part]).parameters if name not in _NOT_SIZES]
    for name in (*sizes, tune):
        if name not in known:
            raise UnknownName.among(known, kind=f"size of a {part}", name=name)
    wave = float(require_positive(wave_speed=wave_speed) / require_positive(frequency=frequency))
    given = chosen(wave, sizes) | dict(sizes)
    thin = _thin(shape, given, frequency=frequency, wave_speed=wave_speed)
    start = sizes.get(tune, given.get(tune, thin.length))
    rest = {name: value for name, value in ({"length": thin.length} | given).items() if name != tune}
    return Body(
        name=part,
        at=lambda length: PARTS[part](**{tune: length}, **rest),
        length=float(start),
        axis=axis,
        sizes=rest,
        tuned=tune,
        thin=thin if tune == "length" else None,
    )


def own_body(geometry: Geometry, *, axis: str) -> Body:
    """Return a horn of the user's own geometry, whose length is tuned by cutting or drawing out its far end.

    Parameters
    ----------
    geometry : Geometry
        One body.
    axis : str
        Along which it vibrates.

    Returns
    -------
    Body
    """
    low, high = extent_along(geometry, axis=axis)
    at = partial(_trimmed_to, geometry, axis)
    return Body(name=geometry.regions[0], at=at, length=high - low, axis=axis, sizes={})


def _trimmed_to(geometry: Geometry, axis: str, length: float) -> Geometry:
    return adjust_length(geometry, axis=axis, length=length)


def _thin(shape: str, sizes: Mapping[str, float], *, frequency: float, wave_speed: float) -> ThinHorn:
    sound = {"frequency": frequency, "wave_speed": wave_speed}
    if shape in {"block", "cylinder"}:
        return thin_exponential_horn(radius=1.0, end_radius=1.0, **sound)
    radii = {"radius": sizes["radius"], "end_radius": sizes["end_radius"]}
    if shape in {"stepped", "booster"}:
        return thin_stepped_horn(**radii, end_length=sizes["end_length"], **sound)
    return (thin_conical_horn if shape == "conical" else thin_exponential_horn)(**radii, **sound)


def _round(wave: float, sizes: Mapping[str, float], share: float = 0.5) -> dict[str, float]:
    radius = sizes.get("radius", _WIDE * wave)
    return {"radius": radius, "end_radius": share * radius}


def _stepped(wave: float, sizes: Mapping[str, float]) -> dict[str, float]:
    radii = _round(wave, sizes)
    step = radii["radius"] - sizes.get("end_radius", radii["end_radius"])
    return radii | {"end_length": wave / 4, "edge_radius": max(step, 0.0) / 2}


def _booster(wave: float, sizes: Mapping[str, float]) -> dict[str, float]:
    radii = _round(wave, sizes, share=0.8)
    flange = {"flange_radius": 1.3 * radii["radius"], "flange_thickness": 0.02 * wave}
    return radii | flange | {"end_length": wave / 4}


_NOT_SIZES = ("slots",)

Chosen = Callable[[float, Mapping[str, float]], dict[str, float]]

SHAPES: Mapping[str, tuple[str, str, Chosen]] = {
    "block": ("block", "x", lambda _wave, _sizes: dict(_POISSON_HORN)),
    "booster": ("booster", "z", _booster),
    "conical": ("conical_horn", "z", _round),
    "cylinder": ("cylinder", "z", lambda wave, _sizes: {"radius": _WIDE * wave}),
    "exponential": ("exponential_horn", "z", _round),
    "stepped": ("stepped_horn", "z", _stepped),
}
"""Shapes of horns by name: the part, its axis, and sizes chosen where none are given."""
