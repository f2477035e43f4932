"""Modes files of the example rigs: computed again on a coarser mesh, and against the models they came from."""

import shlex
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from dong2015.chapter2.poisson_horn import ASSUMED_SOLIDS
from dong2015.hardware import FINAL_COLLAR, POISSON_HORN_SOLIDS, main_resonance, reduced_collar_model
from sonolube.models.dynamics import drive_receptance
from sonolube.models.fem import change_order, generate_mesh, harmonic_response, reduce_model
from sonolube.models.fem.results.part_modes import starting_size
from sonolube.rig import read_rig
from sonolube.rig.driven_rig import driven_rig
from sonolube.tasks.parts.named_parts import transducers

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
FILES = sorted((RIGS / "modes").glob("*.toml"))
OF_RIG = {"collar": "collar", "poisson_horn_aluminium": "poisson_al_steel", "poisson_horn_steel": "poisson_steel_al"}


def content(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def part_of(path: Path) -> str:
    return path.stem.removesuffix("-modes")


@pytest.mark.parametrize("path", FILES, ids=part_of)
def test_natural_frequencies_on_a_coarse_mesh_are_those_of_the_file_within_its_error(path: Path) -> None:
    # quartic elements on the first mesh of the command without its grading, for the shipped file's graded ones
    stated = content(path)
    made = transducers()[part_of(path)]()
    mesh = change_order(generate_mesh(made.geometry, element_size=starting_size(made.geometry)), order=4)
    words = shlex.split(stated["command"])
    contact = words[words.index("--contact") + 1]
    count = int(words[words.index("--count") + 1]) if "--count" in words else 6
    coarse = made.whole(reduce_model(made.model(mesh), count=count, outputs={contact: made.outputs[contact]}))
    squares = np.linalg.eigvalsh(coarse.stiffness.real)[1 : count + 1]
    expected = np.array(stated["natural_frequency"])[1 : count + 1]
    assert np.all(expected > 0)
    found = np.sqrt(squares) / (2 * np.pi)
    assert stated["frequency_error"] < 0.01
    assert found == approx(expected, rel=2 * stated["frequency_error"] + 0.01)  # 1 %: error of the coarse mesh
    below = expected < 25e3  # the range of the rigs, in which the coarse mesh is nearly converged
    assert np.median(np.abs(found / expected - 1)[below]) < stated["frequency_error"]


def test_the_file_of_the_collar_has_the_response_of_the_reduced_model_of_d_4_5() -> None:
    # an independent path: reduced_collar_model on its own mesh; bore over drive between the resonances, both lossy
    rig = driven_rig(read_rig(RIGS / "collar.toml"))
    model = reduced_collar_model(FINAL_COLLAR)
    resonance = main_resonance(model).series_frequency
    at = np.array([2e3, 4e3, 18e3])
    saddle = harmonic_response(model, frequency=at).displacement_per_volt[model.outputs.index("saddle")]
    own = drive_receptance(rig.structure, frequency=at)
    assert np.abs(own) == approx(np.abs(saddle), rel=0.04)
    listed = np.array(content(RIGS / "modes" / "collar-modes.toml")["natural_frequency"])
    assert np.abs(listed / resonance - 1).min() < 0.005


@pytest.mark.parametrize(("part", "ratio"), [("poisson_horn_aluminium", 0.33), ("poisson_horn_steel", 0.28)])
def test_the_face_of_a_horn_bulges_by_poissons_ratio_times_the_strain_of_a_half_wave(part: str, ratio: float) -> None:
    # thin bar of length L: normal amplitude nu (t/2) pi/L of the axial one (D 3.23); by finite elements 6 to 10 % less
    made = transducers()[part]()
    mesh = change_order(generate_mesh(made.geometry, element_size=starting_size(made.geometry)), order=3)
    model = made.whole(reduce_model(made.model(mesh), count=4, outputs=made.outputs))
    squares, shapes = np.linalg.eigh(model.stiffness.real)
    driven = int(np.argmin(np.abs(np.sqrt(np.maximum(squares, 0)) / (2 * np.pi) - 20e3)))
    motion = dict(zip(model.outputs, model.participation @ shapes[:, driven], strict=True))
    assert np.sqrt(squares[driven]) / (2 * np.pi) == approx(20e3, rel=0.005)
    bar = ratio * 25.4e-3 / 2 * np.pi / 127e-3
    assert abs(motion["contact"] / motion["tip"]) == approx(bar, rel=0.15)


def test_the_horns_of_the_part_are_the_solids_of_the_reproduction() -> None:
    for name, solid in POISSON_HORN_SOLIDS.items():
        assumed = next(each for key, each in ASSUMED_SOLIDS.items() if key == name)
        assert solid.density == assumed.density
        constrained = assumed.youngs_modulus * (1 - assumed.poisson_ratio)
        constrained /= (1 + assumed.poisson_ratio) * (1 - 2 * assumed.poisson_ratio)
        assert solid.elastic_stiffness[0, 0] == approx(constrained)
