"""The collar of D 4.5 computed once for rows and figures: its modes, its responses, a rod pulled through it."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from sonolube.checks import Floats
from sonolube.contact import decay_length
from sonolube.dong2015.bore import BoreMotion
from sonolube.dong2015.collar import Collar
from sonolube.dong2015.collar_analysis import Parity, collar_modes, reduced_collar_model
from sonolube.dong2015.collar_designs import FINAL_COLLAR
from sonolube.dong2015.collar_tuning import main_resonance
from sonolube.dynamics import ExponentialGap, steady_state
from sonolube.fem import ReducedModel, contact_structure, with_free_body
from sonolube.friction import AsperityStickSlip
from sonolube.materials import material
from sonolube.published import statement
from sonolube.rig.vibration import gap_motion
from sonolube.validation.contacts import steel_on_steel_contact

ROD_LENGTH = 0.3  # m, not printed: that of examples/rigs/collar.toml
NOMINAL_AREA = 10e-6  # m2, not printed: 10 mm along the rod by 1 mm
LOAD_AT_ENDS = 2.0  # over the load in the middle, not printed: "higher" says D 4.5.4
PULL_SPEED = 0.05  # m/s, only drawn
_MODES = 10
_PLACES = 9  # along the rod at which the vibration is computed
_GRAVITY = 9.81


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Pull:
    """A rod pulled through the collar from one end to the other.

    Parameters
    ----------
    place : ndarray, shape (n,)
        Part of the rod in the ring, from 0 at one end to 1 at the other.
    normal_load : ndarray, shape (n,)
        Load on the ring. [N]
    vibration_amplitude : ndarray, shape (n,)
        Amplitude of the gap. [m]
    friction_ratio : ndarray, shape (s, n)
        Friction with vibration over friction without, at each speed. []
    sliding_speed : ndarray, shape (s,)
        Speed of the rod. [m/s]
    """

    place: Floats
    normal_load: Floats
    vibration_amplitude: Floats
    friction_ratio: Floats
    sliding_speed: Floats

    @property
    def work_reduction(self) -> Floats:
        """Share of the work of friction that vibration saves at each speed, friction in proportion to the load."""
        work = np.trapezoid(self.friction_ratio * self.normal_load, self.place, axis=-1)
        return np.asarray(1 - work / np.trapezoid(self.normal_load, self.place))


@cache
def response_model(collar: Collar, *, clamped: bool = False, open_top: bool = False) -> ReducedModel:
    """Return a collar under voltage."""
    return reduced_collar_model(collar, clamped=clamped, open_top=open_top)


@cache
def mode_frequency(collar: Collar, kind: BoreMotion) -> float:
    """Return the frequency of the mode of a kind in which the inner ring moves most. [Hz]"""
    odd = kind in (BoreMotion.TORSIONAL, BoreMotion.DIAGONAL_OVAL, BoreMotion.TRANSLATION_ALONG_X)
    return collar_modes(collar, count=_MODES, parity=Parity(odd_across=odd)).dominant_frequency(kind)


@cache
def pull() -> Pull:
    """Return the pull of D 4.5.4 at the voltage printed, the drive at the main resonance of the free collar."""
    radius = statement("4.5.4-rod-diameter").number.value / 2
    rod_mass = material("stainless_steel_304").value("density") * np.pi * radius**2 * ROD_LENGTH
    place = np.linspace(0.0, 1.0, _PLACES)
    load = rod_mass * _GRAVITY * (1 + (LOAD_AT_ENDS - 1) * np.abs(2 * place - 1))
    contact = steel_on_steel_contact(nominal_area=NOMINAL_AREA)
    model = response_model(FINAL_COLLAR)
    states = steady_state(
        with_free_body(contact_structure(model, contact="saddle", outwards=-1.0), body_mass=rod_mass),
        ExponentialGap(decay_length=float(decay_length(contact))),
        normal_load=load,
        frequency=main_resonance(model).series_frequency,
        voltage_amplitude=statement("4.5.4-voltage").number.value / 2,
    )
    speed = np.linspace(0.01, 0.25, 49)
    ratios = [AsperityStickSlip().ratio(contact, gap_motion(states, k), sliding_speed=speed) for k in range(_PLACES)]
    return Pull(
        place=place,
        normal_load=load,
        vibration_amplitude=states.vibration_amplitude,
        friction_ratio=np.array(ratios).T,
        sliding_speed=speed,
    )
