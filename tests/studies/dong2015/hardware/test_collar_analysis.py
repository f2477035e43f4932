"""Collar element: symmetry classes, modes of the bore, power balance and measured resonances."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from pytest import approx, raises
from scipy.sparse import block_array
from scipy.sparse.linalg import splu

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from tests.models.fem.direct_response import direct_response

from dong2015.hardware.collar import FINAL_COLLAR, FIRST_COLLAR, THIN_RING_COLLAR, collar_geometry
from dong2015.hardware.collar_analysis import (
    BoreMotion,
    Parity,
    collar_media,
    collar_model,
    collar_modes,
    reduced_collar_model,
)
from dong2015.hardware.collar_tuning import main_resonance
from sonolube.errors import InvalidInput
from sonolube.models.fem import Electrodes, Model, Output, generate_mesh, harmonic_response, natural_modes, reduce_model
from sonolube.models.fem.solver.system import assemble_system


def test_quarters_of_all_parities_have_the_modes_of_the_whole() -> None:
    mesh = generate_mesh(collar_geometry(FINAL_COLLAR, whole=True), element_size=14e-3)
    media = {name: medium for name, medium in collar_media(FINAL_COLLAR).items() if name in mesh.regions}
    wired = Electrodes(driven=("frame|stack",), grounded=("saddle|stack",))
    whole = Model(mesh=mesh, media=media, electrodes=wired)
    expected = natural_modes(whole, count=12).elastic_frequency
    quarters = [
        collar_modes(FINAL_COLLAR, count=6, parity=Parity(odd_across=x, odd_along=z), element_size=14e-3, order=2)
        for x, z in product((False, True), repeat=2)
    ]
    assert np.sort(np.concatenate([quarter.natural_frequency for quarter in quarters]))[:12] == approx(
        expected, rel=0.015
    )
    outputs = {"crown": Output(face="ring.+y", along="y"), "base": Output(face="frame|stack", along="y")}
    full = direct_response(whole, frequency=[2e3], outputs=outputs)
    folded = harmonic_response(reduced_collar_model(FINAL_COLLAR, element_size=14e-3, order=2), frequency=[2e3])
    assert folded.admittance == approx(full.admittance, rel=0.01)
    crown = np.abs(full.displacement_per_volt[0, 0])
    assert folded.displacement_per_volt[[0, 2]] == approx(full.displacement_per_volt, rel=0.02, abs=0.005 * crown)


def test_the_bore_has_oval_modes_even_and_diagonal_oval_modes_odd_about_the_stacks() -> None:
    even, odd = (collar_modes(FIRST_COLLAR, count=10, parity=Parity(odd_across=x)) for x in (False, True))
    for modes in (even, odd):
        shares = np.array(list(modes.motion_fractions.values()))
        assert np.all(shares >= 0)
        assert np.all(shares.sum(axis=0) < 1.01)
    # the wall of this ring is a quarter of an inch: by the ring theory of Hoppe it turns oval at 44 kHz, thick as it is
    # somewhat below, and no stack that stands on it can hold that up
    hoppe = 6 / np.sqrt(5) * 5000.0 * 6.35e-3 / np.sqrt(12) / (2 * np.pi * 9.525e-3**2)
    assert 0.75 * hoppe < even.dominant_frequency(BoreMotion.OVAL) < hoppe
    assert odd.dominant_frequency(BoreMotion.DIAGONAL_OVAL) < even.dominant_frequency(BoreMotion.OVAL)
    with raises(InvalidInput, match="none of the 10 modes is diagonal oval; compute more modes, or those of"):
        even.dominant_frequency(BoreMotion.DIAGONAL_OVAL)


def test_clamping_the_base_lowers_no_mode() -> None:
    free, held = (
        natural_modes(collar_model(FINAL_COLLAR, clamped=clamped, order=2), count=8) for clamped in (False, True)
    )
    assert (free.rigid_body_count, held.rigid_body_count) == (1, 0)
    assert np.all(held.natural_frequency[:8] >= free.natural_frequency[:8])


def test_two_equal_stacks_leave_the_ring_at_rest() -> None:
    slow = harmonic_response(reduced_collar_model(THIN_RING_COLLAR, order=2), frequency=[1e3])
    saddle, base = np.abs(slow.displacement_per_volt[:, 0])
    mesh = collar_model(THIN_RING_COLLAR, order=2).mesh
    assert {"top|stack2", "ring|stack2"} <= set(mesh.faces)
    assert saddle < 10e-9  # of a free stack: both press on the ring, and the frame gives way
    assert base < saddle


def test_the_conductance_of_the_collar_is_positive_at_every_frequency() -> None:
    model = reduced_collar_model(FINAL_COLLAR, clamped=True, open_top=True, order=2)
    assert np.all(harmonic_response(model, frequency=np.linspace(1e3, 40e3, 400)).admittance.real > 0)


def test_the_power_at_resonance_is_the_sum_of_the_losses_of_the_parts() -> None:
    # Half the loss stiffness of each part times the square of its motion, at omega, and the dielectric loss inside it.
    model = collar_model(FINAL_COLLAR, order=2)
    frequency = main_resonance(reduced_collar_model(FINAL_COLLAR, order=2)).series_frequency
    whole, omega = assemble_system(model), 2 * np.pi * frequency
    elastic = whole.stiffness + 1j * whole.stiffness_loss - omega**2 * whole.mass
    dielectric = whole.dielectric - 1j * whole.dielectric_loss
    charge = whole.drive_dielectric - 1j * whole.drive_dielectric_loss
    blocks = block_array([[elastic, whole.coupling], [whole.coupling.T, -dielectric]], format="csc")
    solution = splu(blocks).solve(np.concatenate([-whole.drive_coupling, charge]))
    u, p = np.split(solution, [len(whole.free_dofs)])

    def lost_in(part: str) -> float:
        media = {
            name: medium if name == part else replace(medium, elastic_loss=0.0, loss_tangent=0.0)
            for name, medium in model.media.items()
        }
        own = assemble_system(replace(model, media=media))
        electric = (p.conj() @ (own.dielectric_loss @ p) + 2 * p.conj() @ own.drive_dielectric_loss).real
        return omega / 2 * float((u.conj() @ (own.stiffness_loss @ u)).real + electric - own.drive_capacitance.imag)

    lost = {part: lost_in(part) for part in model.media}
    assert all(power > 0 for power in lost.values())
    taken = direct_response(model, frequency=frequency, outputs={}).admittance[0].real / 2
    assert sum(lost.values()) == approx(taken, rel=1e-6)
    assert harmonic_response(reduce_model(model, count=12, outputs={}), frequency=frequency).admittance[
        0
    ].real / 2 == approx(taken, rel=1e-3)


@pytest.mark.parametrize(("open_top", "measured"), [(False, 25e3), (True, 24.4e3)])
def test_the_final_collar_has_the_measured_resonances(open_top: bool, measured: float) -> None:
    found = main_resonance(reduced_collar_model(FINAL_COLLAR, open_top=open_top))
    assert found.series_frequency == approx(measured, rel=0.005)
    finer, other = (
        main_resonance(reduced_collar_model(FINAL_COLLAR, open_top=open_top, **mesh)).series_frequency
        for mesh in ({"order": 4}, {"element_size": 12e-3})
    )
    assert 0 < found.series_frequency / finer - 1 < 0.002
    assert other == approx(found.series_frequency, rel=5e-4)
