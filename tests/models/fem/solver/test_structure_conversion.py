"""Structures for dynamics against the response of the reduced model and rigid-body motion."""

import numpy as np
from pytest import approx

from sonolube.facts.materials import piezo_ceramic
from sonolube.models.dynamics import contact_receptance, drive_receptance, electrical_admittance, modal_structure
from sonolube.models.fem import (
    Electrodes,
    FixedSupport,
    Model,
    Output,
    box_mesh,
    change_order,
    contact_structure,
    harmonic_response,
    poled_medium,
    reduce_model,
    with_free_body,
)

PZT = piezo_ceramic("pzt4")

L, W = 0.01, 0.004

TIP = {"tip": Output(face="+x", along="x")}


def bar(*, lossless: bool, along_axis: bool = True, order: int = 2, **held: tuple[FixedSupport, ...]) -> Model:
    """A bar along x, poled_medium and driven along x, or poled_medium and driven across."""
    divisions = (6, 2, 2) if order == 2 else (2, 1, 1)
    mesh = change_order(box_mesh(length=L, width=W, thickness=W, divisions=divisions), order=order)
    direction = (1.0, 0.0, 0.0) if along_axis else (0.0, 0.0, 1.0)
    ends = ("-x", "+x") if along_axis else ("-z", "+z")
    return Model(
        mesh=mesh,
        media={"block": poled_medium(PZT, along=direction, lossless=lossless)},
        electrodes=Electrodes(driven=(ends[1],), grounded=(ends[0],)),
        fixed=held.get("fixed", ()),
    )


def test_the_structure_has_the_response_of_the_reduced_model() -> None:
    few = reduce_model(bar(lossless=False), count=12, outputs=TIP)
    structure = contact_structure(few, contact="tip")
    f = np.array([20e3, 60e3, 100e3])
    expected = harmonic_response(few, frequency=f)
    assert drive_receptance(structure, frequency=f) == approx(expected.displacement_per_volt[0], rel=0.03)
    assert electrical_admittance(structure, frequency=f).imag == approx(expected.admittance.imag, rel=5e-3)


def test_the_gap_between_two_free_bodies_has_the_receptance_of_both_masses() -> None:
    free = modal_structure(
        frequencies=[0.0],
        damping_ratios=0.0,
        drive_participation=[0.0],
        contact_participation=[-1 / np.sqrt(2.0)],  # 2 kg
        clamped_capacitance=0.0,
    )
    both = with_free_body(free, body_mass=3.0)
    omega = 2 * np.pi * 50.0
    assert contact_receptance(both, frequency=50.0) == approx(-(1 / 2.0 + 1 / 3.0) / omega**2)
