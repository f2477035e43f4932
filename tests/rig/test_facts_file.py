"""Files of facts: the example is the published facts, and every mistake is refused in one clear line."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from tests.identified import identified_tribometer
from tests.pin_on_disc import pin_on_disc_model, tribometer_test
from tests.same import same

from sonolube.errors import InvalidInput, SonolubeError, UnknownName
from sonolube.identification import identify
from sonolube.rig import read_rig, with_tables
from sonolube.rig.facts_file import identified_tables, read_facts, rig_forward_model
from sonolube.validation.tribometer import tribometer_model, tribometer_problem, tribometer_stack

EXAMPLES = Path(__file__).parents[2] / "examples"
FACTS = EXAMPLES / "facts" / "tribometer.toml"
RIG = EXAMPLES / "rigs" / "tribometer.toml"

SMALL = """
title = "Tip and stack"
source = "bench"

[parameters]
tip_mass = ["50 g", "500 g"]
stack_stiffness = ["1 GN/m", "3 GN/m"]

[conditions]
frequency = "2 kHz"

[[facts]]
observable = "tip_mass"
value = "120 g"
tolerance = "1 g"
rank = 1
source = "scales"

[[facts]]
observable = "electrical_resonance"
value = "22 kHz"
tolerance = "50 Hz"
rank = 1
source = "impedance"
"""


CHAIN = """
[structure]
kind = "chain"
stack_between = ["tip", "reaction"]
contact = "tip"
loaded = "arm"

[structure.masses]
tip = "0.1093 kg"
reaction = "2.41 kg"
arm = "0.602 kg"

[[structure.springs]]
between = ["reaction", "arm"]
spring_stiffness = "4.56e5 N/m"

[[structure.dampers]]
between = ["reaction", "arm"]
viscous_damping = "90 N s/m"

[[structure.dampers]]
between = ["tip", "ground"]
viscous_damping = "702 N s/m"

"""
CHAIN_ENTRIES = {
    "tip_mass": "masses.tip",
    "reaction_mass": "masses.reaction",
    "arm_mass": "masses.arm",
    "arm_stiffness": "springs.0.spring_stiffness",
    "arm_damping": "dampers.0.viscous_damping",
    "tip_damping": "dampers.1.viscous_damping",
}


def as_chain(folder: Path, facts: str) -> tuple[Path, Path]:
    """The tribometer's file with its structure as a chain, and a file of facts with the names of its entries."""
    before, _, rest = RIG.read_text(encoding="utf-8").partition("[structure]")
    rig = folder / "chain.toml"
    rig.write_text(before + CHAIN + rest[rest.index("[assumptions]") :], encoding="utf-8")
    for name, entry in CHAIN_ENTRIES.items():
        facts = re.sub(rf"^{name} =", f'"{entry}" =', facts, flags=re.MULTILINE)
        facts = re.sub(rf'(observable|added_to) = "([^"]*)\b{name}\b', rf'\1 = "\g<2>{entry}', facts)
    return rig, written(folder, re.sub(r'"(masses\.\w+)/(\w+)_mass"', r'"\1/masses.\2"', facts))


def written(folder: Path, text: str) -> Path:
    path = folder / "facts.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_example_holds_exactly_the_published_facts_with_their_sources() -> None:
    same(read_facts(FACTS), tribometer_problem())


def test_the_example_has_the_forward_model_of_the_published_facts() -> None:
    bounds = tribometer_problem().bounds
    logarithms = np.log(list(bounds.values()))
    points = logarithms[:, 0] + np.diff(logarithms).T[0] * np.random.default_rng(0).random((200, len(bounds)))
    parameters = dict(zip(bounds, np.exp(points.T), strict=True))
    found = rig_forward_model(RIG, read_facts(FACTS))(parameters)
    published, expected = tribometer_model()(parameters), pin_on_disc_model(tribometer_test())(parameters)
    assert set(found) == set(published) == set(expected)
    for name, values in expected.items():
        same(found[name], values, place=name)
        same(published[name], values, place=name)


@pytest.mark.slow
def test_the_example_gives_the_identification_of_the_published_facts() -> None:
    problem = read_facts(FACTS)
    found = identify(rig_forward_model(RIG, problem), facts=problem.facts, bounds=problem.bounds)
    expected = identified_tribometer()
    same(found.estimates, expected.estimates)
    same(found.observed, expected.observed)
    same(found.directions, expected.directions)
    same(found.consistent_fits, expected.consistent_fits)
    same(found.conflicts, expected.conflicts)


def test_a_rig_is_identified_from_facts_of_its_own(tmp_path: Path) -> None:
    problem = read_facts(written(tmp_path, SMALL))
    assert problem.title == "Tip and stack"
    found = identify(rig_forward_model(RIG, problem), facts=problem.facts, bounds=problem.bounds)
    # 120 g against 2.48 kg on the stack
    effective = 0.12 * 2.48 / 2.60
    assert found.estimates["tip_mass"].value == approx(0.12, rel=1e-4)
    assert found.estimates["stack_stiffness"].value == approx(effective * (2 * np.pi * 22e3) ** 2, rel=1e-3)
    text = with_tables(RIG.read_text(encoding="utf-8"), identified_tables(RIG, found))
    path = tmp_path / "rig.toml"
    path.write_text(text, encoding="utf-8")
    stack, old = read_rig(path).stack, tribometer_stack()
    assert stack is not None
    assert stack.stack_stiffness == approx(found.estimates["stack_stiffness"].value, rel=1e-4)
    assert stack.free_capacitance == approx(old.free_capacitance)
    assert 'reaction_mass = "2.41 kg"\n' in text  # fixed, so without an interval
    assert "scales" in text


def test_a_fact_may_have_conditions_of_its_own(tmp_path: Path) -> None:
    more = SMALL + (
        '\n[[facts]]\nname = "slow"\nobservable = "amplitude_per_volt"\nfrequency = "1 kHz"\nvalue = "4 nm/V"\n'
        'tolerance = "1 nm/V"\nrank = 2\nsource = "vibrometer"\n'
    )
    observations = read_facts(written(tmp_path, more)).observations
    assert observations["slow"].conditions.frequency == 1e3
    assert observations["tip_mass"].conditions.frequency == 2e3


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('source = "bench"', "", r"source: missing"),
        ("[parameters]", "[parameter]", r"parameter: unknown key; did you mean parameters\?$"),
        ("tip_mass = [", "tipmass = [", r"parameters.tipmass: no entry of the tables .*; did you mean tip_mass\?"),
        ('["50 g", "500 g"]', '["50 g"]', r"parameters.tip_mass: must be a lower and an upper bound, got 1 values"),
        (
            '["50 g", "500 g"]',
            '["50 g", "5 g"]',
            r"parameters.tip_mass: bounds must be positive and rise, got 50 g and 5 g",
        ),
        (
            '["50 g", "500 g"]',
            '["50 g", "500 m"]',
            r"parameters.tip_mass 500 m is a length; expected a mass, such as 70g",
        ),
        ("frequency =", "frequenzy =", r"conditions.frequenzy: unknown key; did you mean frequency\?"),
        ('"2 kHz"', '"2 km"', r"conditions.frequency: 2 km is a length; expected a frequency, such as 22kHz"),
        (
            'value = "120 g"',
            "value = 0.12",
            r"facts.0: value 0.12 has no unit; expected a mass, such as 70g, in quotes",
        ),
        ('tolerance = "1 g"', 'tolerance = "0 g"', r"facts.0: fact tip_mass: tolerance must be positive, got 0.0"),
        ('value = "22 kHz"', 'value = "22 THz"', r"facts.1: value 22 THz lies beyond any rig"),
        (
            'observable = "tip_mass"',
            'observable = "mass_of_tip"',
            r"facts.0: observable: unknown observable 'mass_of_tip'",
        ),
        (
            'observable = "tip_mass"',
            'observabel = "tip_mass"',
            r"facts.0.observabel: unknown key; did you mean observable\?",
        ),
        ("rank = 1", "rank = 0", r"2 faults; facts.0.rank: Input should be greater than or equal to 1; facts"),
        ("rank = 1", 'rank = 1\nrelation = "~"', r"2 faults; facts.0.relation: Input should be '=', '>=' or '<='"),
        ('"electrical_resonance"', '"tip_mass"', r"facts: two facts have the name tip_mass; give one of them a name"),
        ('"impedance"', '"impedance"\nadded_mass = "1 g"', r"facts.1: added_to must name the free parameter"),
        ("[conditions]", "[conditions", r"not valid TOML"),
    ],
)
def test_a_mistake_is_refused_in_one_line_that_names_the_key(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in SMALL
    path = written(tmp_path, SMALL.replace(old, new))
    with raises(InvalidInput, match=f"facts.toml: {message}") as refusal:
        read_facts(path)
    assert "\n" not in str(refusal.value)


def test_a_missing_condition_is_refused_by_the_name_of_the_fact(tmp_path: Path) -> None:
    fact = SMALL.replace('"electrical_resonance"', '"residual_frequency"')
    with raises(InvalidInput, match="fact residual_frequency: residual_frequency requires the condition normal_load"):
        rig_forward_model(RIG, read_facts(written(tmp_path, fact)))


def test_bounds_that_allow_an_impossible_stack_are_refused(tmp_path: Path) -> None:
    stiff = SMALL.replace('"3 GN/m"', '"30 GN/m"')
    with raises(InvalidInput, match=r"bounds must allow possible structures only, but at .* the coupling factor"):
        rig_forward_model(RIG, read_facts(written(tmp_path, stiff)))


def test_a_rig_without_a_structure_is_refused() -> None:
    rig = EXAMPLES / "rigs" / "welder_flat.toml"
    with raises(InvalidInput, match=r"welder_flat.toml: the tables stack and structure are missing"):
        rig_forward_model(rig, read_facts(FACTS))


@pytest.mark.parametrize(
    "content",
    [b"\xff\xfe", b"a = [" + b"[" * 100_000, b" " * 1_000_001, b"facts = 3", b"", b"[[facts]]\nrank = 1e400\n"],
)
def test_hostile_files_are_refused_in_one_line(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "facts.toml"
    path.write_bytes(content)
    with raises(SonolubeError, match=r"facts\.toml: ") as refusal:
        read_facts(path)
    assert "\n" not in str(refusal.value)
    assert len(str(refusal.value)) < 500


def test_a_missing_file_or_a_folder_is_refused(tmp_path: Path) -> None:
    with raises(InvalidInput, match=r"nowhere\.toml: no such file"):
        read_facts(tmp_path / "nowhere.toml")
    with raises(InvalidInput, match="cannot be read"):
        read_facts(tmp_path)


def test_facts_of_a_chain_have_the_forward_model_of_the_same_pin_on_disc_rig(tmp_path: Path) -> None:
    rig, facts = as_chain(tmp_path, FACTS.read_text(encoding="utf-8"))
    problem, bounds = read_facts(facts), tribometer_problem().bounds
    assert dict(problem.bounds) == {CHAIN_ENTRIES[name]: ends for name, ends in bounds.items()}
    logarithms = np.log(list(bounds.values()))
    points = np.exp((logarithms[:, 0] + np.diff(logarithms).T[0] * np.random.default_rng(1).random((50, 6))).T)
    found = rig_forward_model(rig, problem)(dict(zip(problem.bounds, points, strict=True)))
    expected = pin_on_disc_model(tribometer_test())(dict(zip(bounds, points, strict=True)))
    for name, values in expected.items():
        assert found[CHAIN_ENTRIES.get(name, name)] == approx(values, rel=1e-9), name


def test_a_chain_is_identified_and_written_back_with_its_comments(tmp_path: Path) -> None:
    rig, facts = as_chain(tmp_path, SMALL)
    problem = read_facts(facts)
    found = identify(rig_forward_model(rig, problem), facts=problem.facts, bounds=problem.bounds)
    text = with_tables(rig.read_text(encoding="utf-8"), identified_tables(rig, found))
    path = tmp_path / "identified.toml"
    path.write_text(text, encoding="utf-8")
    structure = tomllib.loads(text)["structure"]
    assert float(structure["masses"]["tip"].removesuffix(" kg")) == approx(0.12, abs=2e-3)
    assert structure["masses"]["reaction"] == "2.41 kg"
    assert structure["springs"] == [{"between": ["reaction", "arm"], "spring_stiffness": "4.56e+05 N/m"}]
    assert [each["viscous_damping"] for each in structure["dampers"]] == ["90 N s/m", "702 N s/m"]
    assert "masses.tip: 0.12 kg for 0.12 kg +- 0.001 kg, satisfied" in text
    assert read_rig(path).structure is not None


def test_a_parameter_that_the_rig_lacks_is_refused_with_the_closest_entry(tmp_path: Path) -> None:
    rig, facts = as_chain(tmp_path, SMALL)
    facts.write_text(facts.read_text(encoding="utf-8").replace("masses.tip", "masses.tup"), encoding="utf-8")
    with raises(UnknownName, match=r"masses\.tup.*did you mean masses\.tip"):
        rig_forward_model(rig, read_facts(facts))
