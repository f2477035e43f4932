"""Transducers of the dissertation: sources of their sizes and their printed frequencies."""

import inspect

import numpy as np
import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from dong2015.hardware import (
    CUTTER_HEAD_DIMENSIONS,
    DONG_2015_TRANSDUCERS,
    TRIBOMETER_ACTUATOR_DIMENSIONS,
    cutter_head,
    tribometer_actuator,
)
from sonolube.models.fem import (
    TRANSDUCERS,
    converged_electromechanical_model,
    coupled_resonances,
    generate_mesh,
    natural_modes,
    reduce_model,
)


@pytest.mark.parametrize(
    ("function", "sizes"),
    [(tribometer_actuator, TRIBOMETER_ACTUATOR_DIMENSIONS), (cutter_head, CUTTER_HEAD_DIMENSIONS)],
)
def test_every_default_size_has_a_source(function, sizes) -> None:  # type: ignore[no-untyped-def]
    defaults = {
        name: entry.default
        for name, entry in inspect.signature(function).parameters.items()
        if name not in {"ceramic", "metal"}
    }
    assert {size.name: size.value for size in sizes} == defaults
    assert [size.name for size in sizes if size.printed] == ["stack_layers"]


def test_the_tribometers_actuator_resonates_near_its_printed_frequency() -> None:
    # 22 kHz in D 2.3.1; sizes are those of common hardware, so that no more than a tenth is claimed.
    made = tribometer_actuator()
    found = converged_electromechanical_model(
        lambda size: made.model(generate_mesh(made.geometry, element_size=size)),
        outputs=made.outputs,
        axis="z",
        highest_frequency=24e3,
        element_size=9e-3,
        relative_tolerance=0.02,
        least_coupling=0.2,
    )
    (mode,) = (mode for mode in found.modes if mode.coupling_factor > 0.2)
    assert mode.name == "axial 1"
    assert mode.series_frequency == approx(22e3, rel=0.1)


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


def test_the_default_stack_is_the_ring_stack_of_table_4_7() -> None:
    # 12 mm long, 10 mm outside and 5 mm inside
    assert DONG_2015_TRANSDUCERS["stack"]().geometry.volume == approx(np.pi * (5e-3**2 - 2.5e-3**2) * 12e-3, rel=1e-3)
    assert set(TRANSDUCERS) | set(DONG_2015_TRANSDUCERS) == {
        "collar",
        "cutter_head",
        "poisson_horn_aluminium",
        "poisson_horn_steel",
        "stack",
        "tribometer_actuator",
    }
