"""Matrices of parametric structures, against structures built one by one."""

from collections.abc import Mapping

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.identification import StructureBuilder, parametric_structure, reference_parameters
from sonolube.identification.structure_parametrisation import StructureMatrices, _affine_arrays
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics import GROUND, Damper, LumpedChain, Spring, Structure, chain_structure, modal_structure

STACK = {
    "free_capacitance": 360e-9,
    "free_stroke_per_volt": 6e-9,
    "stack_stiffness": 2e9,
    "stack_mass": 0.05,
    "stack_damping": 30.0,
}


def mounted_stack(parameters: Mapping[str, float]) -> Structure:
    """Build a stack on the ground that carries one mass, held by a spring."""
    stack = PiezoStack(**{name: parameters.get(name, value) for name, value in STACK.items()})
    return chain_structure(
        LumpedChain(
            masses={"head": parameters.get("tip_mass", 0.2)},
            springs=(Spring(between=("head", GROUND), spring_stiffness=parameters.get("arm_stiffness", 1e8)),),
            dampers=(Damper(between=("head", GROUND), viscous_damping=50.0),),
            stack=stack,
            stack_between=("head", GROUND),
            contact="head",
        )
    )


def two_modes(parameters: Mapping[str, float]) -> Structure:
    return modal_structure(
        frequencies=[parameters["frequency"], 31e3],
        damping_ratios=parameters["damping_ratio"],
        drive_participation=[5.0, 1.0],
        contact_participation=[2.0, -1.0],
        clamped_capacitance=200e-9,
    )


def require_same(matrices: StructureMatrices, index: int, built: Structure) -> None:
    for name in ("mass_matrix", "damping_matrix", "stiffness_matrix", "drive_vector", "contact_vector"):
        expected = getattr(built, name)
        assert getattr(matrices, name)[index] == approx(expected, rel=1e-12, abs=1e-12 * np.abs(expected).max()), name
    assert matrices.clamped_capacitance[index] == approx(built.clamped_capacitance, rel=1e-9)


@pytest.mark.parametrize(
    ("build", "values"),
    [
        (mounted_stack, {"tip_mass": [0.1, 0.7], "arm_stiffness": [1e6, 3e8]}),
        (
            mounted_stack,
            {"stack_stiffness": [1e9, 3e9], "stack_damping": [1.0, 900.0], "free_capacitance": [3e-7, 1e-6]},
        ),
        (mounted_stack, {"free_stroke_per_volt": [1e-9, 9e-9], "stack_stiffness": [1e9, 3e9]}),  # bilinear
        (two_modes, {"frequency": [20e3, 24e3], "damping_ratio": [1e-3, 3e-2]}),
    ],
    ids=["masses and springs", "stack", "stroke and stiffness", "modes"],
)
def test_the_matrices_of_many_are_those_of_structures_built_one_by_one(
    build: StructureBuilder, values: dict[str, list[float]]
) -> None:
    bounds = {name: (min(each) / 1.2, max(each) * 1.1) for name, each in values.items()}
    structure = parametric_structure(build, reference=reference_parameters(build, bounds=bounds))
    matrices = structure.matrices({name: np.array(each) for name, each in values.items()}, {})
    for index in range(2):
        require_same(matrices, index, build({name: each[index] for name, each in values.items()}))


@pytest.mark.parametrize("free", [{}, {"free_stroke_per_volt": np.array([5e-9])}], ids=["interpolated", "built"])
def test_an_added_mass_is_that_of_a_heavier_part(free: dict[str, np.ndarray]) -> None:
    parameters = {"tip_mass": np.array([0.3]), **free}
    reference = {name: 0.9 * float(values[0]) for name, values in parameters.items()}
    structure = parametric_structure(mounted_stack, reference=reference)
    matrices = structure.matrices(parameters, {"tip_mass": 0.25})
    require_same(matrices, 0, mounted_stack({name: float(v[0]) for name, v in parameters.items()} | {"tip_mass": 0.55}))


def test_bounds_that_allow_an_impossible_stack_are_refused_with_the_corner() -> None:
    bounds = {"free_stroke_per_volt": (1e-9, 20e-9), "free_capacitance": (100e-9, 500e-9)}
    with raises(
        InvalidInput,
        match=r"at free_stroke_per_volt 2e-08 m/V, free_capacitance 1e-07 F: .* the coupling factor would exceed 1",
    ):
        reference_parameters(mounted_stack, bounds=bounds)


def test_more_parameters_than_have_corners_to_check_are_refused() -> None:
    with raises(InvalidInput, match="at most 12 parameters can be free, got 13"):
        reference_parameters(mounted_stack, bounds={f"p{index}": (1.0, 2.0) for index in range(13)})


def test_parameters_other_than_the_free_ones_are_refused() -> None:
    structure = parametric_structure(mounted_stack, reference={"tip_mass": 1.0})
    with raises(InvalidInput, match="parameters must be tip_mass, got arm_stiffness"):
        structure.matrices({"arm_stiffness": np.array([1.0])}, {})


def test_a_structure_that_is_linear_in_its_parameters_is_known_from_its_change_by_each() -> None:
    linear = _affine_arrays(mounted_stack, {"tip_mass": 0.2, "arm_stiffness": 1e8})
    assert linear is not None
    assert _affine_arrays(two_modes, {"frequency": 20e3, "damping_ratio": 0.01}) is None  # by its square

    def impossible(parameters: Mapping[str, float]) -> Structure:
        if parameters["tip_mass"] > 0.3:
            raise InvalidInput("too heavy")
        return mounted_stack(parameters)

    assert _affine_arrays(impossible, {"tip_mass": 0.2}) is None
