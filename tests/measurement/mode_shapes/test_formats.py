"""Records of universal and CalculiX files, one at a time, by hand."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.mode_shapes.formats import (
    UNIVERSAL_FILE,
    ModeShapes,
    UnitSystem,
    _checked,
    _is_shape,
    _Mode,
    _mode_shapes,
    _nodal,
    _own_scales,
    _positions,
    _real_shape,
    _rigid_count,
    _universal_mode,
    read_mode_shapes,
)

FILE = Path("horn.unv")


def found(frequency: list[float], **changed: Any) -> ModeShapes:
    count = len(frequency)
    values = {
        "damping_ratio": np.full(count, np.nan),
        "modal_mass": np.arange(1.0, count + 1),
        "shape": np.arange(count * 3.0).reshape(count, 1, 3),
    }
    return ModeShapes(
        natural_frequency=np.array(frequency),
        node=np.array([5]),
        position=np.zeros((1, 3)),
        format_name=UNIVERSAL_FILE,
        **(values | changed),
    )


@pytest.mark.parametrize(
    ("frequency", "rigid"),
    [
        ([1.0, 99.0, 9000.0], 0),
        ([1.0, 101.0, 9000.0], 1),
        ([0.0, 1.0, 101.0], 2),
        ([0.0, 0.0, 0.0], 0),
        ([1.0, 101.0, 10_200.0], 2),  # the highest jump counts
        ([0.1] * 6 + [50.0], 6),
        ([0.1] * 7 + [50.0], 0),  # a body has six rigid motions
        ([5.0], 0),
    ],
)
def test_up_to_six_modes_a_hundredfold_below_the_others_are_rigid(frequency: list[float], rigid: int) -> None:
    assert _rigid_count(np.array(frequency)) == rigid


def test_modes_are_ordered_by_frequency_and_rigid_ones_set_to_zero_with_a_caveat() -> None:
    modes = _checked(found([500.0, 0.5, 300.0]), FILE)
    assert modes.natural_frequency.tolist() == [0.0, 300.0, 500.0]
    assert modes.modal_mass.tolist() == [2.0, 3.0, 1.0]
    assert modes.shape[:, 0, 0].tolist() == [3.0, 6.0, 0.0]
    assert modes.caveats == (
        "1 modes up to 0.5 Hz are taken for rigid motions, of frequency zero: the next has 300 Hz",
    )
    assert _checked(found([0.0, 300.0]), FILE).caveats == ()


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"shape": np.full((2, 1, 3), np.inf)}, "is not finite"),
        ({"modal_mass": np.array([1.0, np.inf])}, "is not finite"),
        ({"modal_mass": np.array([1.0, -1.0])}, "negative frequency, modal mass or damping"),
        ({"damping_ratio": np.array([0.1, -0.1])}, "it is no stable vibration"),
    ],
)
def test_modes_that_are_no_stable_vibration_are_refused(changed: dict[str, Any], words: str) -> None:
    with raises(InvalidInput, match=f"horn.unv: a .*{words}"):
        _checked(found([100.0, 200.0], **changed), FILE)


def test_a_negative_frequency_is_refused() -> None:
    with raises(InvalidInput, match="negative frequency"):
        _checked(found([-100.0, 200.0]), FILE)


def test_a_complex_shape_is_turned_to_its_largest_real_part() -> None:
    shape, skew = _real_shape(np.exp(0.8j) * np.array([[3.0, 0, 0], [0, 1j, 0]]))
    assert np.abs(shape) == approx(np.array([[3.0, 0, 0], [0, 0, 0]]), abs=1e-12)
    assert skew == approx(1 / np.sqrt(10))
    real, none = _real_shape(np.array([[1, 2, 3]]))
    assert real.tolist() == [[1.0, 2.0, 3.0]]
    assert none == 0.0
    assert _real_shape(np.zeros((1, 3), complex))[1] == 0.0


NORMAL = {
    "analysis_type": 2, "data_ch": 2, "spec_data_type": 8, "node_nums": [4, 9],
    "r1": [1.0, 2.0], "r2": [3.0, 4.0], "r3": [5.0, 6.0],
    "freq": 120.0, "modal_m": 2.5, "modal_damp_vis": 0.0, "modal_damp_his": 0.06,
}  # fmt: skip


def test_a_normal_mode_has_its_mass_and_half_of_a_hysteretic_loss_factor() -> None:
    mode = _universal_mode(NORMAL)
    assert (mode.frequency, mode.mass, mode.damping, mode.skew) == approx((120.0, 2.5, 0.03, 0.0))
    assert mode.node.tolist() == [4, 9]
    assert mode.shape.tolist() == [[1, 3, 5], [2, 4, 6]]
    viscous = _universal_mode(NORMAL | {"modal_damp_vis": 0.01})
    assert viscous.damping == 0.01
    silent = _universal_mode(NORMAL | {"modal_m": 0.0, "modal_damp_his": 0.0})
    assert math.isnan(silent.mass)
    assert math.isnan(silent.damping)
    with raises(ValueError, match="1 nodes with displacements of 2"):
        _universal_mode(NORMAL | {"node_nums": [4]})


def test_a_complex_mode_follows_from_its_eigenvalue_and_modal_a() -> None:
    mode = _universal_mode(NORMAL | {"analysis_type": 3, "eig": -3.0 + 4.0j, "modal_a": 20j})
    # |lambda| = 5: frequency 5/2 pi, damping 3/5, mass 20/10
    assert mode.frequency == approx(5 / (2 * np.pi))
    assert mode.damping == approx(0.6)
    assert mode.mass == approx(2.0)
    rigid = _universal_mode(NORMAL | {"analysis_type": 3, "eig": 0j, "modal_a": 20j})
    assert rigid.frequency == 0.0
    assert math.isnan(rigid.mass)
    assert math.isnan(rigid.damping)


@pytest.mark.parametrize(
    ("changed", "accepted"),
    [
        ({}, True),
        ({"analysis_type": 7, "data_ch": 3, "spec_data_type": 0}, True),
        ({"analysis_type": 1}, False),
        ({"data_ch": 4}, False),
        ({"spec_data_type": 2}, False),  # stresses
    ],
)
def test_displacements_of_natural_modes_are_read(changed: dict[str, int], accepted: bool) -> None:
    assert _is_shape(NORMAL | changed) == accepted


def test_positions_and_units_are_those_of_the_file() -> None:
    nodes = _positions({"node_nums": [3.0, 8.0], "x": [1, 2], "y": [3, 4], "z": [5, 6]})
    assert {number: row.tolist() for number, row in nodes.items()} == {3: [1, 3, 5], 8: [2, 4, 6]}
    with raises(ValueError, match="a node is not finite"):
        _positions({"node_nums": [3.0], "x": [np.nan], "y": [3], "z": [5]})
    assert _own_scales([{"length": 1000.0, "force": 4.0}]) == approx((1e-3, 0.25))
    assert _own_scales([]) is None
    for factor in (0.0, -1.0, 1e13, np.nan):
        with raises(ValueError, match="is none between units"):
            _own_scales([{"length": factor, "force": 1.0}])
    assert UnitSystem(length_unit="mm", force_unit="kN").scales == approx((1e-3, 1e3))


def test_a_node_that_a_mode_leaves_out_does_not_move_in_it_and_masses_are_of_force_over_acceleration(
    tmp_path: Path,
) -> None:
    path = tmp_path / "horn.unv"
    path.touch()
    one = _Mode(frequency=10.0, node=np.array([9, 4]), shape=np.array([[1.0, 2, 3], [4, 5, 6]]), mass=3.0)
    other = _Mode(frequency=20.0, node=np.array([7]), shape=np.array([[7.0, 8, 9]]), damping=0.02)
    modes = _mode_shapes(
        [one, other], {4: np.array([1.0, 2, 3]), 11: np.array([4.0, 5, 6])}, (1e-3, 2.0), format_name="x", path=path
    )
    assert modes.node.tolist() == [4, 7, 9, 11]
    assert modes.shape[0].tolist() == [[4, 5, 6], [0, 0, 0], [1, 2, 3], [0, 0, 0]]
    assert modes.shape[1].tolist() == [[0, 0, 0], [7, 8, 9], [0, 0, 0], [0, 0, 0]]
    assert modes.position[0] == approx([1e-3, 2e-3, 3e-3])
    assert modes.position[3] == approx([4e-3, 5e-3, 6e-3])
    assert np.isnan(modes.position[1:3]).all()
    assert modes.modal_mass == approx([6000.0, np.nan], nan_ok=True)
    assert modes.damping_ratio == approx([np.nan, 0.02], nan_ok=True)


def test_a_row_of_a_calculix_node_has_fixed_columns() -> None:
    row = b" -1" + b"     12345" + b" 1.00000E+00-2.50000E-01 3.00000E+02"
    number, values = _nodal([row, row + b" trailing"], 10)
    assert number.tolist() == [12345, 12345]
    assert values[0].tolist() == [1.0, -0.25, 300.0]
    short, _ = _nodal([b" -1" + b"   42" + row[13:]], 5)
    assert short.tolist() == [42]
    assert _nodal([], 10)[1].shape == (0, 3)
    for bad in (row[:-1], b" -2" + row[3:]):
        with raises(ValueError, match="a node is not ' -1'"):
            _nodal([bad], 10)
    with raises(ValueError, match="is not finite"):
        _nodal([row.replace(b" 3.00000E+02", b"         nan")], 10)


def test_a_file_of_neither_format_and_one_without_units_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "modes.txt"
    path.write_text("frequency\n1\n")
    with raises(InvalidInput, match="is neither a universal file nor a result of CalculiX"):
        read_mode_shapes(path)
    frd = tmp_path / "modes.frd"
    frd.write_text("    1C\n 9999\n")
    with raises(InvalidInput, match="results of CalculiX have no units; give length_unit and force_unit, such as mm"):
        read_mode_shapes(frd)
    with raises(InvalidInput, match="holds no natural mode"):
        read_mode_shapes(frd, units=UnitSystem(length_unit="mm", force_unit="N"))
