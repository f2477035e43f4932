"""Task `modes` with the file of another program: the structure of a rig, on a terminal and in Python, and refusals."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, mark, raises
from tests.mode_files import frd_text, write_universal_file
from tests.same import same

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.rig import read_rig
from sonolube.rig.driven_rig import driven_rig
from sonolube.tasks.files import NamedBytes
from sonolube.text.units import to_si

Program = Callable[..., Any]

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
X = np.linspace(0, 1, 11)
POSITION = np.stack([100 * X, 0 * X, 0 * X], axis=1)
SHAPE = np.stack([np.stack([np.cos(k * np.pi * X), 0 * X, 0 * X], axis=1) for k in range(4)])
BAR: dict[str, Any] = {"frequency": [0, 25e3, 50e3, 75e3], "position": POSITION, "shape": SHAPE}
BAR |= {"mass": [0.3e-3, 0.15e-3, 0.15e-3, 0.15e-3]}  # of 0.3 kg in tonnes, free
ASKED: dict[str, Any] = {
    "tip": "100,0,0mm",
    "direction": "+x",
    "port": ("1", "6"),
    "force_per_volt": "12 N/V",
    "clamped_capacitance": 4e-9,
    "quality_factor": 500,
}
UNITS: dict[str, Any] = {"length_unit": "mm", "force_unit": "N"}
TYPED = (
    *("--tip", "100,0,0mm", "--direction", "+x", "--port", "1", "--port", "6", "--force-per-volt", "12N/V"),
    *("--clamped-capacitance", "4nF", "--quality-factor", "500"),
)


def test_a_terminal_and_python_have_the_same_structure_of_a_bar_in_closed_form(
    sonolube: Program, tmp_path: Path
) -> None:
    write_universal_file(tmp_path / "bar.unv", factors=(1e3, 1.0), **BAR)
    typed = sonolube("modes", "--from", tmp_path / "bar.unv", *TYPED, "--out", tmp_path, "--json").answer
    (written,) = typed.pop("files")
    found = sl.modes(from_file=tmp_path / "bar.unv", **ASKED)
    ours, theirs = found.json_object(), typed
    assert "--clamped-capacitance 4nF" in theirs["structure"].pop("command")
    ours["structure"].pop("command")
    same(ours, theirs)
    stated = tomllib.loads(Path(written).read_text(encoding="utf-8"))
    # cos(k pi x/L) of 0.3 kg: 1/sqrt(0.3), else sqrt(2/0.3); from x = 0 to L/2 it falls by 1 - cos(k pi/2)
    root = np.sqrt(2 / 0.3)
    assert stated["natural_frequency"] == [0, 25e3, 50e3, 75e3]
    assert stated["contact_participation"] == approx([-1 / np.sqrt(0.3), root, -root, root], rel=1e-6)
    assert stated["drive_participation"] == approx([0, -12 * root, -24 * root, -12 * root], rel=1e-6)
    assert stated["damping_ratio"] == approx([0, 1e-3, 1e-3, 1e-3])
    assert theirs["modes"][1]["displacement_per_volt"]["value"] == approx(
        12 * root**2 / (2e-3 * (2 * np.pi * 25e3) ** 2), rel=1e-6
    )


def test_results_of_calculix_in_bytes_are_a_rig_of_another_body_on_the_contact(tmp_path: Path) -> None:
    content = frd_text(**BAR).encode()
    found = sl.modes(from_file=NamedBytes("bar.frd", content), body_mass="2kg", **ASKED, **UNITS)
    (text,) = found.files().values()
    (tmp_path / "bar-modes.toml").write_text(str(text), encoding="utf-8")
    rig = (RIGS / "collar.toml").read_text(encoding="utf-8").replace("modes/collar-modes.toml", "bar-modes.toml")
    (tmp_path / "rig.toml").write_text(rig, encoding="utf-8")
    structure = driven_rig(read_rig(tmp_path / "rig.toml")).structure
    assert structure.coordinates == 5
    assert structure.contact_vector[-1] == approx(1 / np.sqrt(2))
    assert structure.clamped_capacitance == approx(4e-9)
    assert "node 11 at 100 mm, 0 m, 0 m" in str(found)
    assert "modes above 75 kHz are left out" in str(found)
    data = found.dataset()
    assert data["contact_participation"].to_numpy()[:4] == approx(structure.contact_vector[:4])
    assert data["drive_participation"].attrs["units"] == "N/V kg**-0.5"


def test_a_table_of_other_columns_simulates_as_the_modes_it_was_made_of(tmp_path: Path) -> None:
    own = tomllib.loads((RIGS / "modes" / "collar-modes.toml").read_text(encoding="utf-8"))
    mass = np.linspace(0.5, 3.0, len(own["natural_frequency"]))
    columns = {
        "natural_frequency [kHz]": 1e-3 * np.array(own["natural_frequency"]),
        "quality_factor": 0.5 / np.maximum(own["damping_ratio"], 1e-12),
        "port_participation": np.array(own["drive_participation"]) * np.sqrt(mass) / 7.0,
        "contact_participation": np.array(own["contact_participation"]) * np.sqrt(mass),
        "modal_mass [g]": 1e3 * mass,
    }
    rows = (",".join(f"{value:.17g}" for value in row) for row in zip(*columns.values(), strict=True))
    (tmp_path / "table.csv").write_text("\n".join([",".join(columns), *rows]), encoding="utf-8")
    capacitance = own["clamped_capacitance"]
    found = sl.modes(from_file=tmp_path / "table.csv", force_per_volt=7.0, clamped_capacitance=capacitance)
    (tmp_path / "collar-modes.toml").write_text(str(*found.files().values()), encoding="utf-8")
    text = (RIGS / "collar.toml").read_text(encoding="utf-8")
    (tmp_path / "rig.toml").write_text(text.replace("modes/collar-modes", "collar-modes"), encoding="utf-8")
    changes = ["vibration.amplitude_source=computed", "drive.frequency=24.9kHz"]
    rigs = [read_rig(path, changes=changes) for path in (tmp_path / "rig.toml", RIGS / "collar.toml")]
    again, before = map(sl.simulate, rigs)
    for name in ("friction_force", "vibration_amplitude"):
        assert float(again[name]) == approx(float(before[name]), rel=1e-6)
    by_voltage = float(sl.simulate(RIGS / "collar.toml")["vibration_amplitude"])  # without the modes
    assert float(before["vibration_amplitude"]) != approx(by_voltage, rel=0.01)


def _receptance(content: dict[str, Any], frequency: float, of: str) -> float:
    """Displacement of the contact per force on it or per voltage, without damping, by the modes of an answer."""
    omega, turning = 2 * np.pi * np.array(content["natural_frequency"]), 2 * np.pi * frequency
    tip, other = np.array(content["contact_participation"]), np.array(content[of])
    return float(np.sum(tip * other / (omega**2 - turning**2)))


@mark.parametrize("frequency", [5e3, 15e3, 30e3, 37e3])
def test_static_values_make_a_few_modes_of_a_bar_respond_as_all_of_them_do(frequency: float) -> None:
    # a free bar of 0.3 kg, half a wave at 25 kHz: EA = m omega_1^2 L/pi^2; by inertia relief its end yields by L/3EA,
    # and 12 N/V between x = 0 and the middle, which stretch that half, move it by an eighth of 12 N L/EA against +x
    L, stiffness = 0.1, 0.3 * (2 * np.pi * 25e3) ** 2 * 0.1 / np.pi**2
    statics: dict[str, Any] = {
        "static_compliance": L / (3 * stiffness),
        "displacement_per_volt": -12 * L / (8 * stiffness),
    }
    content = {"from_file": NamedBytes("bar.frd", frd_text(**BAR).encode()), **ASKED, **UNITS}
    few, corrected = (
        tomllib.loads(str(*sl.modes(**content, **more).files().values())) for more in (dict[str, Any](), statics)
    )
    wave = np.pi * frequency / 25e3
    exact = -np.cos(wave) / (wave / L * stiffness * np.sin(wave))  # of a free bar in closed form
    order, root = np.arange(1, 20_000), np.sqrt(2 / 0.3)
    shares = -((-1.0) ** order) * root * -12 * root * (1 - np.cos(order * np.pi / 2))
    driven = float(np.sum(shares / ((2 * np.pi * 25e3 * order) ** 2 - (2 * np.pi * frequency) ** 2)))
    for of, right in (("contact_participation", exact), ("drive_participation", driven)):
        errors = [abs(_receptance(each, frequency, of) - right) for each in (few, corrected)]
        assert errors[1] < 0.2 * errors[0]
    (caveat,) = [each for each in sl.modes(**content).caveats() if "are left out" in each]
    missing = L / (3 * stiffness) - sum(
        (c / (2 * np.pi * f)) ** 2
        for f, c in zip(few["natural_frequency"], few["contact_participation"], strict=True)
        if f
    )
    told = to_si(caveat.split("about ")[1].split(" beside")[0], unit="m/N", name="compliance")
    assert told == approx(missing, rel=0.05)
    added = corrected["natural_frequency"][-1], corrected["clamped_capacitance"]
    assert added[0] == approx(300e3)
    assert to_si(added[1], unit="F", name="C") < 4e-9


def test_static_values_that_the_modes_exceed_are_refused() -> None:
    content = {"from_file": NamedBytes("bar.frd", frd_text(**BAR).encode()), **ASKED, **UNITS}
    with raises(InvalidInput, match="static_compliance 1e-12 m/N must exceed"):
        sl.modes(**content, static_compliance=1e-12, displacement_per_volt=0.0)
    with raises(InvalidInput, match="belong together"):
        sl.modes(**content, static_compliance=1e-6)


@mark.parametrize(
    ("changes", "complaint"),
    [
        ({"tip": ()}, "needs tip, a node or point"),
        ({"direction": None}, "needs direction, the direction from the tip to the other body"),
        ({"port": ("1",)}, "needs port, two nodes or points, the ends of the stack; got 1"),
        ({"port": ("1", "1")}, "port: needs two ends of the stack at different positions"),
        ({"force_per_volt": None}, "needs force_per_volt, the blocked force"),
        ({"force_per_volt": "12 N"}, "force_per_volt"),
        ({"clamped_capacitance": None}, "needs clamped_capacitance"),
        ({"quality_factor": None}, "states no damping of 3 of 4 modes"),
        ({"modal_mass": "1kg"}, "modal_mass: the file states"),
        ({"force_unit": None}, "needs force_unit"),
        ({"length_unit": "kg"}, "kg"),
        ({"direction": "+y"}, "the contact moves in none of the 3 elastic modes"),
        ({"body_stiffness": "1N/m"}, "body_stiffness has no meaning without body_mass"),
        ({"count": 3}, "count has no meaning for from_file; it is for a part"),
        ({"part": "block"}, "part has no meaning for from_file"),
    ],
)
def test_what_is_missing_or_needless_beside_a_file_is_refused_in_one_line(
    changes: dict[str, Any], complaint: str
) -> None:
    arguments = ASKED | UNITS | changes
    with raises(InvalidInput, match=complaint) as refusal:
        sl.modes(from_file=NamedBytes("bar.frd", frd_text(**BAR).encode()), **arguments)
    assert "\n" not in str(refusal.value)


def test_a_part_takes_nothing_that_is_for_a_file_and_a_table_nothing_that_is_for_shapes(tmp_path: Path) -> None:
    with raises(InvalidInput, match="tip has no meaning for a part; it is for from_file"):
        sl.modes("block", tip="1")
    with raises(InvalidInput, match="needs a part, such as block, or from_file"):
        sl.modes()
    table = NamedBytes("t.toml", b"natural_frequency = [1e3]\ncontact_participation = [1]\nquality_factor = [50]\n")
    with raises(InvalidInput, match=r"t\.toml: column drive_participation is missing"):
        sl.modes(from_file=table)
    for line, complaint in (
        (b"port_participation = [1]\n", "port_participation needs the blocked force per volt"),
        (b"drive_participation = [1]\n", "needs clamped_capacitance"),
        (b"drive_participation = [1]\nport_participation = [1]\n", "has both drive_participation and port_part"),
        (b"drive_participation = [1, 2]\n", "drive_participation has 2 entries, natural_frequency 1"),
    ):
        with raises(InvalidInput, match=complaint):
            sl.modes(from_file=NamedBytes("t.toml", table.content + line))
    with raises(InvalidInput, match="tip has no meaning for a table of modes"):
        sl.modes(from_file=table, tip="1")
    with raises(InvalidInput, match="leave out force_per_volt"):
        sl.modes(from_file=NamedBytes("t.toml", table.content + b"drive_participation = [1]\n"), force_per_volt=1.0)


def test_a_refused_file_writes_nothing(sonolube: Program, tmp_path: Path) -> None:
    (tmp_path / "bar.frd").write_bytes(frd_text(**BAR).encode()[:-400])
    run = sonolube("modes", "--from", tmp_path / "bar.frd", *TYPED, "--length-unit", "mm", "--force-unit", "N")
    assert "cannot be read as CalculiX result" in run.refusal
    assert [path.name for path in tmp_path.iterdir()] == ["bar.frd"]
