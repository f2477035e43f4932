"""Friction of a rig's contact dry, vibrated, lubricated and both, and the method with the least friction."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_positive
from sonolube.errors import MissingProperty, UnknownName
from sonolube.facts.materials import Material
from sonolube.models import friction
from sonolube.models.wear import CrystalStructure, WearMechanismAssessment, WearPairBody, assess_wear_mechanism
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig
from sonolube.rig.simulation import VibratedFriction, vibrated_friction

_SPAN = 10.0  # how far the map reaches to either side of the rig's point, as a factor
_RESOLUTION = 121

_FILM_TESTED = (
    "film and asperities share the load by theory alone: compared with no friction, since D 4.2 prints neither"
    " viscosity nor friction of its lubricant; asperities in it rub with the dry coefficient, which additives lower"
)
_FILM_VIBRATED = (
    "the film is that without vibration: that vibration pumps lubricant into the contact, squeezes it out or swages a"
    " solid one into the surface has no model here"
)
_FILM_PAD = (
    "a flat pad has the film of an endlessly wide one at its inclination, an upper bound;"
    " for a ball give its tip radius"
)


Lubricant = friction.BoundaryLubricant | friction.FilmLubricant
"""Lubricant with a film that is stated, or one by viscosity."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LubricationPoint:
    """Friction coefficients of a rig's contact by four methods of lubrication, and the best method.

    Parameters
    ----------
    sliding_speed : float
        Macroscopic relative speed. [m/s]
    nominal_pressure : float
        Load over nominal area. [Pa]
    friction_coefficient : float
        Coefficient of dry friction. []
    asperity_load_fraction : float
        Share of the load that asperities carry through the lubricant. []
    coefficients : LubricationCoefficients
        Coefficients of the four ways.
    best : str
        Method with the least friction.
    friction_model : str
        Name of the friction model.
    vibration_amplitude : float
        Vibration normal to the contact, zero to peak. [m]
    amplitude_source : {"measured", "computed", "waveguide", "per-volt"}
        Where the amplitude comes from.
    amplitude_origin : str
        The same in words, with the numbers behind it.
    film_coefficient : float
        Coefficient of friction of the film. []
    film_thickness : float or None
        Gap between the mean planes; None for a film that is stated. [m]
    film_ratio : float or None
        That gap over the combined rms height; None for a film that is stated. []
    caveats : tuple of str
        What speaks against trusting the numbers, each in one line.
    """

    sliding_speed: float
    nominal_pressure: float
    friction_coefficient: float
    asperity_load_fraction: float
    coefficients: friction.LubricationCoefficients
    best: str
    friction_model: str
    vibration_amplitude: float
    amplitude_source: str
    amplitude_origin: str
    film_coefficient: float
    film_thickness: float | None = None
    film_ratio: float | None = None
    caveats: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class LubricationMap:
    """Best method of lubrication over sliding speed and pressure about the operating point of a rig.

    Parameters
    ----------
    sliding_speed : ndarray, shape (n,)
        Speeds. [m/s]
    nominal_pressure : ndarray, shape (m,)
        Pressures. [Pa]
    best : ndarray of str, shape (m, n)
        Method with the least friction.
    """

    sliding_speed: Floats
    nominal_pressure: Floats
    best: NDArray[np.str_]


def lubrication_point(rig: Rig | ResolvedRig, *, lubricant: Lubricant, smallest_gain: float = 0.0) -> LubricationPoint:
    """Friction of a rig's contact by each method of lubrication at its load and speed, and the best method.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    lubricant : BoundaryLubricant or FilmLubricant
        With a share by the pressure alone, or by viscosity, speed, load and roughness.
    smallest_gain : float
        Fraction by which vibration must lower the friction of the lubricated contact to be worth its power.

    Returns
    -------
    LubricationPoint

    Raises
    ------
    InvalidInput
        If the rig does not slide or has no frequency, or the gain does not lie between 0 and 1.
    OutsideRange
        If the vibration is outside the range of the friction model at a speed, or drives the sliding.
    """
    resolved = resolved_rig(rig).require_separation()
    rig = resolved.rig
    pressure = rig.normal_load / rig.contact.nominal_area
    require_positive(sliding_speed=rig.sliding_speed)
    vibrated = vibrated_friction(resolved, sliding_speed=rig.sliding_speed)
    film = _film(rig, lubricant, sliding_speed=rig.sliding_speed, nominal_pressure=pressure)
    found = _coefficients(rig, film, vibrated)
    return LubricationPoint(
        sliding_speed=rig.sliding_speed,
        nominal_pressure=pressure,
        friction_coefficient=rig.friction_coefficient,
        asperity_load_fraction=float(film.asperity_load_fraction),
        coefficients=found,
        best=str(friction.best_lubrication_method(found, smallest_gain=smallest_gain)),
        friction_model=rig.friction_model.name,
        **vibrated.origin,
        film_coefficient=float(np.asarray(film.film_coefficient)),
        film_thickness=film.film_thickness,
        film_ratio=film.film_ratio,
        caveats=(*vibrated.caveats, *film.caveats),
    )


def lubrication_map(rig: Rig | ResolvedRig, *, lubricant: Lubricant, smallest_gain: float = 0.0) -> LubricationMap:
    """Best method of lubrication over a decade to either side of a rig's speed and pressure.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    lubricant : BoundaryLubricant
    smallest_gain : float
        Fraction by which vibration must lower the friction of the lubricated contact to be worth its power.

    Returns
    -------
    LubricationMap

    Raises
    ------
    InvalidInput
        If the rig does not slide or has no frequency, or the gain does not lie between 0 and 1.
    OutsideRange
        If the vibration is outside the range of the friction model at a speed, or drives the sliding.

    Notes
    -----
    What vibration leaves of friction is taken at the rig's own load throughout.
    """
    resolved = resolved_rig(rig)
    rig = resolved.rig
    require_positive(sliding_speed=rig.sliding_speed)
    factors = np.geomspace(1 / _SPAN, _SPAN, _RESOLUTION)
    speeds, pressures = rig.sliding_speed * factors, rig.normal_load / rig.contact.nominal_area * factors
    vibrated = vibrated_friction(resolved, sliding_speed=speeds)
    film = _film(rig, lubricant, sliding_speed=speeds, nominal_pressure=pressures[:, np.newaxis])
    found = _coefficients(rig, film, vibrated)
    return LubricationMap(
        sliding_speed=speeds,
        nominal_pressure=pressures,
        best=friction.best_lubrication_method(found, smallest_gain=smallest_gain),
    )


def wear_of_materials(first: Material, second: Material) -> WearMechanismAssessment:
    """Wear mechanism and the effect of vibration for two materials of the catalogue, by rule.

    Raises
    ------
    MissingProperty
        If no source for a hardness or a crystal structure is known.
    UnknownName
        If the rule does not know a crystal structure.
    """
    return assess_wear_mechanism(_wearing(first), _wearing(second))


def _wearing(body: Material) -> WearPairBody:
    if body.crystal_structure is None:
        raise MissingProperty(f"{body.name} has no crystal_structure: no source is known, and the rule needs it")
    name = body.crystal_structure.text.replace("close packed", "close-packed")
    if name not in list(CrystalStructure):
        raise UnknownName.among(list(CrystalStructure), kind="crystal structure", name=name)
    return WearPairBody(name=body.title, hardness=body.value("hardness"), structure=CrystalStructure(name))


@dataclass(frozen=True, kw_only=True, slots=True)
class _Film:
    """Share of the load on asperities and coefficient of the film; of one point also thickness and its ratio."""

    asperity_load_fraction: Floats
    film_coefficient: ArrayLike
    film_thickness: float | None = None
    film_ratio: float | None = None
    caveats: tuple[str, ...]


def _film(rig: Rig, lubricant: Lubricant, *, sliding_speed: ArrayLike, nominal_pressure: ArrayLike) -> _Film:
    if isinstance(lubricant, friction.BoundaryLubricant):
        return _Film(
            asperity_load_fraction=friction.asperity_load_fraction(lubricant, nominal_pressure=nominal_pressure),
            film_coefficient=lubricant.film_coefficient,
            caveats=("load sharing in proportion to the pressure: the simplest law that D Fig. 4.28 allows",),
        )
    load = np.asarray(nominal_pressure) * rig.contact.nominal_area
    mixed = friction.mixed_lubrication(lubricant, rig.contact, sliding_speed=sliding_speed, normal_load=load)
    single = mixed.film_ratio.size == 1
    return _Film(
        asperity_load_fraction=mixed.asperity_load_fraction,
        film_coefficient=mixed.film_coefficient,
        film_thickness=float(mixed.film_thickness) if single else None,
        film_ratio=float(mixed.film_ratio) if single else None,
        caveats=(_FILM_TESTED, _FILM_VIBRATED, *(() if lubricant.tip_radius is not None else (_FILM_PAD,))),
    )


def _coefficients(rig: Rig, film: _Film, vibrated: VibratedFriction) -> friction.LubricationCoefficients:
    return friction.shared_coefficients(
        friction_coefficient=rig.friction_coefficient,
        friction_ratio=vibrated.ratio.require_braking(),
        asperity_load_fraction=film.asperity_load_fraction,
        film_coefficient=film.film_coefficient,
    )
