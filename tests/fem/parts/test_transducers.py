"""Stacks of layers against one-dimensional theory, and the actuators' sizes against what is said of them."""

import inspect
from functools import partial

import numpy as np
import pytest
from pytest import approx, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.dong2015.transducers import (
    CUTTER_HEAD_DIMENSIONS,
    DONG_2015_TRANSDUCERS,
    TRIBOMETER_ACTUATOR_DIMENSIONS,
    acorn_nut,
    cutter_head,
    hub_disc,
    tribometer_actuator,
)
from sonolube.errors import InvalidInput
from sonolube.fem import (
    TRANSDUCERS,
    FixedSupport,
    ReducedModel,
    block,
    converged_electromechanical_model,
    coupled_resonances,
    direct_response,
    generate_mesh,
    harmonic_response,
    natural_modes,
    poled_part,
    reduce_model,
    series_parallel_resonances,
    stack_transducer,
)
from sonolube.fem.solver.krylov import krylov_reduction
from sonolube.materials import piezo_ceramic

PIC255 = piezo_ceramic("pic255")
RADIUS, LENGTH, LAYERS = 1.5e-3, 20e-3, 40.0
SLIM = stack_transducer(outer_radius=RADIUS, inner_radius=0.0, length=LENGTH, stack_layers=LAYERS)
AREA = np.pi * RADIUS**2
CHARGE = LAYERS * PIC255.charge_constants[2, 2]  # stroke per volt
STIFFNESS = AREA / (PIC255.compliance_short_circuit[2, 2] * LENGTH)


def test_a_slim_stack_strokes_and_charges_as_its_layers_do() -> None:
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
    series, _, coupling = series_parallel_resonances(few)
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


def test_a_rod_stands_beside_the_stack_as_a_spring_does() -> None:
    # Stroke falls by k_stack/(k_stack + k_rod); end masses are stiff against both.
    bolted = partial(
        stack_transducer,
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


def test_a_bar_poled_across_stretches_by_its_transverse_constant() -> None:
    made = poled_part(
        block(length=0.02, width=0.004, thickness=0.002), ceramic="pzt4", along="z", driven="+z", grounded="-z"
    )
    model = made.model(generate_mesh(made.geometry, element_size=3e-3))
    slow = harmonic_response(reduce_model(model, count=4, outputs=made.outputs), frequency=[50.0])
    thicker = slow.displacement_per_volt[0, 0] - slow.displacement_per_volt[1, 0]
    assert abs(thicker) == approx(piezo_ceramic("pzt4").charge_constants[2, 2], rel=1e-3)


@pytest.mark.parametrize(
    ("function", "sizes"),
    [(tribometer_actuator, TRIBOMETER_ACTUATOR_DIMENSIONS), (cutter_head, CUTTER_HEAD_DIMENSIONS)],
)
def test_every_size_of_an_actuator_says_where_it_is_from(function, sizes) -> None:  # type: ignore[no-untyped-def]
    defaults = {
        name: entry.default
        for name, entry in inspect.signature(function).parameters.items()
        if name not in {"ceramic", "metal"}
    }
    assert {size.name: size.value for size in sizes} == defaults
    assert [size.name for size in sizes if size.printed] == ["stack_layers"]


def test_the_tribometers_actuator_rings_near_its_printed_frequency() -> None:
    # 22 kHz in D 2.3.1; sizes are those of common hardware, so that no more than a tenth is claimed.
    made = tribometer_actuator()
    port = converged_electromechanical_model(
        lambda size: made.model(generate_mesh(made.geometry, element_size=size)),
        outputs=made.outputs,
        axis="z",
        highest_frequency=24e3,
        element_size=9e-3,
        relative_tolerance=0.02,
        least_coupling=0.2,
    )
    (mode,) = (mode for mode in port.modes if mode.coupling_factor > 0.2)
    assert mode.name == "axial 1"
    assert mode.series_frequency == approx(22e3, rel=0.1)


def test_the_coordinates_that_drive_and_outputs_move_answer_as_the_full_equations_and_all_modes_do() -> None:
    made = stack_transducer(outer_radius=5e-3, inner_radius=0.0, length=12e-3, back_length=15e-3)
    model = made.model(generate_mesh(made.geometry, element_size=6e-3))
    few, coordinates = krylov_reduction(model, outputs=made.outputs, highest_frequency=160e3)
    frequency = np.array([1e3, 52e3, 119e3])
    quick = harmonic_response(few, frequency=frequency)
    full = direct_response(model, frequency=frequency, outputs=made.outputs)
    assert np.abs(quick.admittance / full.admittance - 1).max() < 1e-3
    assert np.abs(quick.displacement_per_volt / full.displacement_per_volt - 1).max() < 1e-3
    known = natural_modes(model, count=60).natural_frequency
    series, _, coupling = coupled_resonances(few)
    driven = series[(coupling > 0.05) & (series < 160e3)]
    assert driven.size > 1
    assert np.abs(known[:, np.newaxis] / driven - 1).min(axis=0).max() < 1e-5
    assert len(coordinates) < 66  # fewer than the modes, rigid ones with them


def test_centre_and_rim_of_the_cutter_head_move_against_each_other_at_twenty_kilohertz() -> None:
    # D 4.4.4; the drive is at 20 kHz (Table 4.6).
    made = cutter_head()
    mesh = generate_mesh(made.geometry, element_size=6e-3)
    model = made.model(mesh)
    found = natural_modes(model, count=20)
    series, _, coupling = coupled_resonances(reduce_model(model, count=20, outputs=made.outputs))
    best = int(np.argmax(coupling[: found.natural_frequency.size]))
    top = mesh.face_nodes("tip.+z")
    reach = np.hypot(*mesh.nodes[top, :2].T)
    motion = found.shapes[best, top, 2]
    assert series[best] == approx(20e3, rel=0.05)
    assert motion[reach < 2e-3].mean() * motion[reach > 0.95 * reach.max()].mean() < 0


def test_an_acorn_nut_and_a_cutter_disc_have_the_volume_of_their_formula() -> None:
    # hexagon and a spherical zone of heights 0 to h: pi h (R^2 - h^2/3)
    high = np.sqrt(5e-3**2 - 0.8e-3**2)
    nut = acorn_nut(width=11e-3, length=6e-3, tip_radius=5e-3, contact_radius=0.8e-3)
    assert nut.volume == approx(np.sqrt(3) / 2 * 11e-3**2 * 6e-3 + np.pi * high * (5e-3**2 - high**2 / 3), rel=1e-3)
    disc = hub_disc(hub_radius=4e-3, hub_length=5e-3, disc_radius=10e-3, thickness=1e-3)
    assert disc.volume == approx(np.pi * (4e-3**2 * 5e-3 + 10e-3**2 * 1e-3), rel=1e-4)


def test_what_cannot_be_built_is_refused() -> None:
    with raises(InvalidInput, match="a rod is bonded to both end masses"):
        stack_transducer(rod_radius=1e-3)
    with raises(InvalidInput, match="the rod must pass the bore"):
        stack_transducer(rod_radius=3e-3, back_length=1e-2, front_length=1e-2)
    with raises(InvalidInput, match="contact_radius, tip_radius and half the width must rise"):
        acorn_nut(width=5e-3, length=5e-3, tip_radius=5e-3, contact_radius=1e-3)
    with raises(InvalidInput, match="hub_radius must be below disc_radius"):
        hub_disc(hub_radius=1e-2, hub_length=1e-2, disc_radius=1e-2, thickness=1e-3)
    assert set(TRANSDUCERS) | set(DONG_2015_TRANSDUCERS) == {"cutter_head", "stack", "tribometer_actuator"}


def test_a_mode_that_is_not_driven_is_not_paired_though_it_lies_between() -> None:
    # One driven mode at 1 and an idle one at 1.1, in rad/s: open, the first goes to sqrt(1 + b^2/C).
    model = ReducedModel(
        stiffness=np.diag([1.0, 1.21]).astype(np.complex128),
        drive=np.array([0.6, 0.0], dtype=np.complex128),
        clamped_capacitance=1.0,
        participation=np.zeros((0, 2)),
        outputs=(),
    )
    series, parallel, coupling = coupled_resonances(model)
    assert 2 * np.pi * series == approx([1.0, 1.1])
    assert 2 * np.pi * parallel == approx([np.sqrt(1.36), 1.1])
    assert coupling == approx([np.sqrt(1 - 1 / 1.36), 0.0])
