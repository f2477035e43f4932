"""Homogenised stack against the stack model with the printed constants."""

import numpy as np
import pytest
from pytest import approx, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.models.actuator import PiezoStack
from sonolube.models.fem import (
    Electrodes,
    FixedSupport,
    Model,
    Output,
    generate_mesh,
    harmonic_response,
    homogenised_stack,
    isotropic_medium,
    poled_medium,
    reduce_model,
    ring,
    stack_ceramic,
)

# Table 4.7; its capacitance with 20 layers of its permittivity, 42 nF as printed
PRINTED_STACK = PiezoStack(
    free_capacitance=41.7e-9, free_stroke_per_volt=20 * 500e-12, stack_stiffness=140e6, stack_damping=0.0
)


def stack_alone(*, blocked: bool) -> Model:
    mesh = generate_mesh(ring(outer_radius=5e-3, inner_radius=2.5e-3, length=12e-3), element_size=4e-3)
    ceramic = stack_ceramic(
        material("pic151"),
        youngs_modulus=140e6 * 12e-3 / (np.pi * (5e-3**2 - 2.5e-3**2)),
        charge_constant_15=550e-12,
        shear_modulus=23.5e9,
    )
    return Model(
        mesh=mesh,
        media={"ring": homogenised_stack(poled_medium(ceramic, along=(0.0, 0.0, 1.0), lossless=True), stack_layers=20)},
        electrodes=Electrodes(driven=("-z",), grounded=("+z",)),
        fixed=(FixedSupport(face="-z", along="z"), FixedSupport(face="+z", along="z")) if blocked else (),
    )


def slow_capacitance(model: Model) -> float:
    slow = harmonic_response(
        reduce_model(model, count=3, outputs={"end": Output(face="+z", along="x")}), frequency=100.0
    )
    return float(slow.admittance[0].imag / (2 * np.pi * 100.0))


def test_the_homogenised_block_has_charge_and_stroke_of_the_stack() -> None:
    ends = {"top": Output(face="+z", along="z"), "foot": Output(face="-z", along="z")}
    model = reduce_model(stack_alone(blocked=False), count=3, outputs=ends)
    slow = harmonic_response(model, frequency=100.0)
    top, foot = slow.displacement_per_volt[:, 0]
    assert (top - foot).real == approx(PRINTED_STACK.free_stroke_per_volt, rel=1e-3)
    assert slow.admittance[0].imag / (2 * np.pi * 100.0) == approx(PRINTED_STACK.free_capacitance, rel=5e-3)


def test_the_homogenised_block_has_the_blocked_force_of_the_stack() -> None:
    # What charge a held stack does not take is its force times its stroke: C_T - C_S = F_b s.
    charge = slow_capacitance(stack_alone(blocked=False)) - slow_capacitance(stack_alone(blocked=True))
    force_per_volt = charge / PRINTED_STACK.free_stroke_per_volt
    assert force_per_volt == approx(PRINTED_STACK.charge_per_elongation, rel=5e-3)


def test_an_unpoled_medium_and_a_stack_stiffer_than_its_ceramic_are_refused() -> None:
    steel = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=8000.0)
    with raises(InvalidInput, match="only a poled medium can be layered"):
        homogenised_stack(steel, stack_layers=2)
    with raises(InvalidInput, match="must not exceed its ceramic's"):
        stack_ceramic(material("pic151"), youngs_modulus=1e11, charge_constant_15=5e-10, shear_modulus=2e10)
