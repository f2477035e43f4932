"""Collar of D 4.5 by finite elements: modes, responses to voltage, and friction of a rod pulled through it."""

from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Final

import numpy as np

from dong2015.hardware.collar import ASSUMED_RANGES, FINAL_COLLAR, Collar
from dong2015.hardware.collar_analysis import (
    ELEMENT_SIZE,
    BoreMotion,
    Parity,
    collar_model,
    collar_modes,
    reduced_collar_model,
)
from dong2015.hardware.collar_tuning import main_resonance
from sonolube.checks import Floats
from sonolube.facts.materials import material
from sonolube.facts.published import si_value
from sonolube.models.contact import decay_length
from sonolube.models.dynamics import ExponentialGap, steady_state
from sonolube.models.fem import ReducedModel, contact_structure, natural_modes, with_free_body
from sonolube.models.friction import AsperityStickSlip
from sonolube.rig import gap_motion
from sonolube.validation.contacts import steel_on_steel_contact

ROD_LENGTH: Final = 0.3
"""Length of the rod, not printed: that of examples/rigs/collar.toml. [m]"""

LOAD_AT_ENDS: Final = 2.0
"""Load at the ends over that in the middle of the rod, not printed: "higher" in D 4.5.4. []"""

PULL_SPEED: Final = 0.05
"""Speed of the rod, only drawn. [m/s]"""

_NOMINAL_AREA: Final = 10e-6  # m2, not printed: 10 mm along the rod by 1 mm
_MODES: Final = 10
_POSITIONS: Final = 9  # along the rod, at which the vibration is computed
_THIN: Final = 1e-6  # m, of the middle plane
_GRAVITY: Final = 9.81  # m/s2


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PulledRod:
    """Friction of a rod pulled through the collar from one end to the other.

    Parameters
    ----------
    relative_position : ndarray, shape (n,)
        Position of the ring on the rod over its length, from 0 to 1.
    normal_load : ndarray, shape (n,)
        Load on the ring. [N]
    vibration_amplitude : ndarray, shape (n,)
        Amplitude of the gap. [m]
    friction_ratio : ndarray, shape (s, n)
        Friction with vibration over friction without, at each speed. []
    sliding_speed : ndarray, shape (s,)
        Speed of the rod. [m/s]
    """

    relative_position: Floats
    normal_load: Floats
    vibration_amplitude: Floats
    friction_ratio: Floats
    sliding_speed: Floats

    @property
    def work_reduction(self) -> Floats:
        """Reduction of the work of friction at each speed, friction in proportion to the load. []"""
        work = np.trapezoid(self.friction_ratio * self.normal_load, self.relative_position, axis=-1)
        return np.asarray(1 - work / np.trapezoid(self.normal_load, self.relative_position))

    @property
    def ratio_at_pull_speed(self) -> Floats:
        """Friction ratio along the rod at the assumed speed, by linear interpolation. []"""
        return np.array([np.interp(PULL_SPEED, self.sliding_speed, ratio) for ratio in self.friction_ratio.T])


@cache
def response_model(collar: Collar, *, clamped: bool = False, open_top: bool = False) -> ReducedModel:
    """Reduced model of a collar under voltage."""
    return reduced_collar_model(collar, clamped=clamped, open_top=open_top)


@cache
def mode_frequency(collar: Collar, kind: BoreMotion) -> float:
    """Frequency of the mode of a kind with the largest motion of the inner ring. [Hz]"""
    return collar_modes(collar, count=_MODES, parity=_parity(kind)).dominant_frequency(kind)


@cache
def mode_frequency_range(collar: Collar, kind: BoreMotion, *, assumed: tuple[str, ...]) -> tuple[float, float]:
    """Frequencies of a mode at two corners of the ranges of assumed dimensions. [Hz]

    Lower and higher one: of a thick and narrow inner ring with thin bolts and pillars, and of a thin and wide one with
    thick ones. By a coarse mesh, in proportion to what it gives for the collar itself.
    """
    over_coarse = mode_frequency(collar, kind) / coarse_frequency(collar, kind)
    corners: list[dict[str, Any]] = [
        {name: ASSUMED_RANGES[name][stiff ^ (name == "ring_thickness")] for name in assumed} for stiff in (0, 1)
    ]
    low, high = sorted(over_coarse * coarse_frequency(replace(collar, **corner), kind) for corner in corners)
    return low, high


def mode_near(collar: Collar, *, frequency: float, open_top: bool) -> tuple[float, Floats, Floats]:
    """Mode that a voltage drives nearest to a frequency: its own in Hz, places and displacements in the middle plane.

    Both of shape (n, 2), by a coarse mesh, which is fine enough to be drawn.
    """
    model = collar_model(collar, open_top=open_top, element_size=2 * ELEMENT_SIZE, order=2)
    found = natural_modes(model, count=_MODES)
    number = int(np.argmin(np.abs(found.elastic_frequency - frequency)))
    middle = np.abs(model.mesh.nodes[:, 2]) < _THIN
    places, moved = model.mesh.nodes[middle, :2], found.shapes[found.rigid_body_count + number][middle, :2]
    mirror = np.array([-1.0, 1.0])
    return (
        float(found.elastic_frequency[number]),
        np.concatenate([places, places * mirror]),
        np.concatenate([moved, moved * mirror]),
    )


def coarse_frequency(collar: Collar, kind: BoreMotion) -> float:
    """Frequency of a mode by a mesh of half the fineness and of quadratic elements. [Hz]"""
    found = collar_modes(collar, count=_MODES, parity=_parity(kind), element_size=2 * ELEMENT_SIZE, order=2)
    return found.dominant_frequency(kind)


def _parity(kind: BoreMotion) -> Parity:
    """Symmetry of the modes with a motion of the bore."""
    return Parity(odd_across=kind in (BoreMotion.TORSIONAL, BoreMotion.DIAGONAL_OVAL, BoreMotion.TRANSLATION_ALONG_X))


@cache
def pulled_rod() -> PulledRod:
    """Pulled rod of D 4.5.4 at the printed voltage and the main resonance of the free collar."""
    radius = si_value("4.5.4-rod-diameter") / 2
    rod_mass = material("stainless_steel_304").value("density") * np.pi * radius**2 * ROD_LENGTH
    position = np.linspace(0.0, 1.0, _POSITIONS)
    load = rod_mass * _GRAVITY * (1 + (LOAD_AT_ENDS - 1) * np.abs(2 * position - 1))
    contact = steel_on_steel_contact(nominal_area=_NOMINAL_AREA)
    model = response_model(FINAL_COLLAR)
    states = steady_state(
        with_free_body(contact_structure(model, contact="saddle", outwards=-1.0), body_mass=rod_mass),
        ExponentialGap(decay_length=float(decay_length(contact))),
        normal_load=load,
        frequency=main_resonance(model).series_frequency,
        voltage_amplitude=si_value("4.5.4-voltage") / 2,
    )
    speed = np.linspace(0.01, 0.25, 49)
    ratios = [AsperityStickSlip().ratio(contact, gap_motion(states, k), sliding_speed=speed) for k in range(_POSITIONS)]
    return PulledRod(
        relative_position=position,
        normal_load=load,
        vibration_amplitude=states.vibration_amplitude,
        friction_ratio=np.array(ratios).T,
        sliding_speed=speed,
    )
