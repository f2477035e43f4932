"""Stacks and poled parts against one-dimensional theory."""

from functools import partial

import numpy as np
import pytest
from pytest import approx, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.errors import InvalidInput
from sonolube.facts.materials import piezo_ceramic
from sonolube.models.fem import (
    FixedSupport,
    block,
    coupled_resonances,
    generate_mesh,
    harmonic_response,
    poled_part,
    reduce_model,
    stack_transducer,
)

PIC255 = piezo_ceramic("pic255")

RADIUS, LENGTH, LAYERS = 1.5e-3, 20e-3, 40.0

stack_of_pic255 = partial(stack_transducer, ceramic="pic255", metal="stainless_steel_304")

SLIM = stack_of_pic255(outer_radius=RADIUS, length=LENGTH, stack_layers=LAYERS)

AREA = np.pi * RADIUS**2

CHARGE = LAYERS * PIC255.charge_constants[2, 2]  # stroke per volt

STIFFNESS = AREA / (PIC255.compliance_short_circuit[2, 2] * LENGTH)


def test_stroke_and_capacitance_of_a_slim_stack_are_those_of_its_layers() -> None:
    model = SLIM.model(generate_mesh(SLIM.geometry, element_size=2e-3))
    slow = harmonic_response(reduce_model(model, count=6, outputs=SLIM.outputs), frequency=[50.0])
    stroke = slow.displacement_per_volt[0, 0] - slow.displacement_per_volt[1, 0]
    capacitance = slow.admittance[0].imag / (2 * np.pi * 50.0)
    assert abs(stroke) == approx(CHARGE, rel=1e-3)
    assert capacitance == approx(LAYERS**2 * PIC255.permittivity_free[2] * AREA / LENGTH, rel=5e-3)


def test_a_slim_stack_held_at_its_back_has_the_admittance_of_a_short_circuited_bar() -> None:
    # Many thin layers keep the field fixed: a bar of stiffness 1/s33^E, Q/V = C_T - N^2 d33^2 (EA/L)(1 - tan x/x).
    held = (FixedSupport(face="ring1.-z", along="z"),)
    model = SLIM.model(generate_mesh(SLIM.geometry, element_size=1.5e-3), fixed=held)
    tip = {"tip": SLIM.outputs["tip"]}
    few = reduce_model(model, count=12, outputs=tip)
    speed = 1 / np.sqrt(PIC255.compliance_short_circuit[2, 2] * PIC255.material.value("density"))
    quarter = speed / (4 * LENGTH)
    series, _, coupling = coupled_resonances(few)
    driven = int(np.argmax(coupling))
    assert series[driven] == approx(quarter, rel=0.01)
    f = np.array([0.3, 0.6, 0.8]) * quarter
    x = 2 * np.pi * f * LENGTH / speed
    free = LAYERS**2 * PIC255.permittivity_free[2] * AREA / LENGTH
    expected = free - CHARGE**2 * STIFFNESS * (1 - np.tan(x) / x)
    charge = harmonic_response(few, frequency=f).admittance / (2j * np.pi * f)
    assert charge.real == approx(expected, rel=0.02)
    moved = np.abs(harmonic_response(few, frequency=f).displacement_per_volt[0])
    assert moved == approx(CHARGE * np.tan(x) / x, rel=0.02)


def test_a_rod_reduces_the_stroke_as_a_parallel_spring() -> None:
    # Stroke falls by k_stack/(k_stack + k_rod); end masses are stiff against both.
    bolted = partial(
        stack_of_pic255,
        outer_radius=6e-3,
        inner_radius=3e-3,
        length=40e-3,
        stack_layers=40.0,
        back_length=10e-3,
        front_length=10e-3,
    )
    strokes = []
    for rod in (0.0, 2e-3):
        made = bolted(rod_radius=rod)
        model = made.model(generate_mesh(made.geometry, element_size=5e-3))
        slow = harmonic_response(reduce_model(model, count=4, outputs=made.outputs), frequency=[50.0])
        strokes.append(abs(slow.displacement_per_volt[0, 0] - slow.displacement_per_volt[1, 0]))
    own = np.pi * (6e-3**2 - 3e-3**2) / PIC255.compliance_short_circuit[2, 2]
    beside = np.pi * 2e-3**2 * 200e9
    assert strokes[1] / strokes[0] == approx(own / (own + beside), rel=0.03)


def test_a_poled_bar_has_the_thickness_change_of_its_charge_constant() -> None:
    made = poled_part(
        block(length=0.02, width=0.004, thickness=0.002), ceramic="pzt4", along="z", driven="+z", grounded="-z"
    )
    model = made.model(generate_mesh(made.geometry, element_size=3e-3))
    slow = harmonic_response(reduce_model(model, count=4, outputs=made.outputs), frequency=[50.0])
    thicker = slow.displacement_per_volt[0, 0] - slow.displacement_per_volt[1, 0]
    assert abs(thicker) == approx(piezo_ceramic("pzt4").charge_constants[2, 2], rel=1e-3)


def test_impossible_stacks_are_refused() -> None:
    ring = partial(stack_of_pic255, outer_radius=5e-3, inner_radius=2.5e-3, length=12e-3)
    with raises(InvalidInput, match="a rod is bonded to both end masses"):
        ring(rod_radius=1e-3)
    with raises(InvalidInput, match="the rod must pass the bore"):
        ring(rod_radius=3e-3, back_length=1e-2, front_length=1e-2)
