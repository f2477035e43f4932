"""Series and parallel resonances against open-circuit modes and a two-mode model."""

import numpy as np
from pytest import approx

from sonolube.facts.materials import piezo_ceramic
from sonolube.models.fem import (
    Electrodes,
    FixedSupport,
    Model,
    Output,
    ReducedModel,
    box_mesh,
    change_order,
    coupled_resonances,
    natural_modes,
    poled_medium,
    reduce_model,
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


def test_parallel_resonances_are_the_natural_frequencies_of_the_open_circuit() -> None:
    shorted = bar(lossless=True)
    opened = Model(mesh=shorted.mesh, media=shorted.media, electrodes=Electrodes(floating=("+x",), grounded=("-x",)))
    series, parallel, coupling = coupled_resonances(reduce_model(shorted, count=8, outputs=TIP))
    assert np.all(series[:6] == 0)
    assert np.all(coupling[:6] == 0)
    assert natural_modes(shorted, count=8).natural_frequency == approx(series[:14], rel=1e-6, abs=1.0)
    assert natural_modes(opened, count=8).natural_frequency == approx(np.sort(parallel)[:14], rel=2e-4, abs=1.0)


def test_a_mode_that_is_not_driven_has_one_frequency() -> None:
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
