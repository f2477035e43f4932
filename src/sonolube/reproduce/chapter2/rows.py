"""Chapter 2, the experiments: what their printed numbers say of each other, and what models say of them."""

from collections.abc import Iterator
from functools import partial
from itertools import chain
from math import sqrt
from typing import Literal

import numpy as np

from sonolube.actuator import free_bar_frequency
from sonolube.figure import ReportFigure
from sonolube.materials import material
from sonolube.published.values import Published, over_rounding, stated
from sonolube.reproduce.chapter2 import (
    figures as chapter2_figures,
    flextensional as chapter2_flextensional,
    horn as chapter2_horn,
    horn_figures as chapter2_horn_figures,
    motor as chapter2_motor,
    pairs as chapter2_pairs,
    tribometer as chapter2_tribometer,
    welder as chapter2_welder,
)
from sonolube.reproduce.row import Row, compare
from sonolube.validation.contacts import STEEL_ON_STEEL_NOTE, Bodies, poisson_friction_ratio
from sonolube.validation.inputs import friction_drop, in_table, named, said


def rows() -> tuple[Row, ...]:
    """Return the rows of chapter 2."""
    return tuple(
        chain(
            _poisson_modes(),
            chapter2_horn.rows(),
            _poisson_reductions(),
            chapter2_flextensional.rows(),
            chapter2_tribometer.rows(),
            chapter2_welder.rows(),
            chapter2_motor.rows(),
            chapter2_pairs.rows(),
        )
    )


def figures() -> tuple[ReportFigure, ...]:
    """Return the figures of chapter 2."""
    return (*chapter2_figures.figures(), *chapter2_horn_figures.figures())


def _poisson_modes() -> Iterator[Row]:
    for horn, alloy in (("aluminium", "aluminium_2024"), ("steel", "stainless_steel_316")):
        density = material(alloy).value("density")
        yield compare(
            stated(f"2.1.3-first-mode-{horn}"),
            over_rounding(
                partial(_half_wave, density=density),
                in_table("3.1", f"youngs_modulus_{horn}"),
                said("2.1.2-waveguide-length"),
            ),
            f"Half a wave in a uniform bar with E of Table 3.1 and {density:g} kg/m3: no tapers, no rounded edges.",
        )


def _half_wave(youngs_modulus: float, length: float, *, density: float) -> float:
    return float(free_bar_frequency(length=length, wave_speed=sqrt(youngs_modulus / density)))


def _poisson_reductions() -> Iterator[Row]:
    aluminium_horn = stated("2.1.5-reduction-aluminium-horn")
    yield compare(
        aluminium_horn,
        over_rounding(friction_drop, said("2.1.5-coefficient-off"), said("2.1.5-coefficient-on")),
        "D 2.1 from both coefficients; D calls all three numbers approximate.",
    )
    load = np.asarray(said("2.1.2-normal-load").value)
    tests: tuple[tuple[Published, Bodies, Literal["aluminium", "steel"], str], ...] = (
        (named(aluminium_horn, "cube"), "aluminium_steel", "aluminium", ""),
        (stated("2.1.5-reduction-steel-on-aluminium"), "aluminium_steel", "steel", ""),
        (stated("2.1.5-reduction-steel-on-steel"), "steel_steel", "steel", f" Assumed: {STEEL_ON_STEEL_NOTE}."),
    )
    for published, bodies, horn, remark in tests:
        own, later = (
            1 - float(poisson_friction_ratio(bodies=bodies, horn=horn, normal_load=load, axial_amplitude=number.value))
            for number in (said("2.1.2-welder-amplitude"), said("4.3.5-waveguide-amplitude"))
        )
        yield compare(
            published,
            own,
            f"Cube, D 3.15, {load:g} N, amplitude of D 2.1.2; with that of D 4.3.5 {100 * later:.1f} %.{remark}",
        )
