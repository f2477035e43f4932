"""Refusals with the dotted key of what they are of, for a page that shows each beside its field."""

from pathlib import Path

from pytest import raises

import sonolube as sl
from sonolube.checks import require_positive
from sonolube.errors import InvalidInput, SeveralFaults

RIG = Path(__file__).parents[1] / "examples" / "rigs" / "tribometer.toml"


def test_one_fault_of_a_rig_file_has_its_dotted_key() -> None:
    with raises(InvalidInput) as refusal:
        sl.read_rig(RIG, changes=["sliding.sliding_speed=3 N"])
    assert refusal.value.key == "sliding.sliding_speed"


def test_several_faults_have_a_key_each(tmp_path: Path) -> None:
    file = tmp_path / "rig.toml"
    text = (
        RIG.read_text()
        .replace("[sliding]", '[sliding]\nwobble = "1 m"')
        .replace("[contact]", '[contact]\nsize = "1 m"')
    )
    file.write_text(text)
    with raises(SeveralFaults) as refusal:
        sl.read_rig(file)
    assert sorted(refusal.value.keys) == ["contact.size", "sliding.wobble"]
    assert [fault.split(":")[0] for fault in refusal.value.faults] == list(refusal.value.keys)


def test_an_argument_of_a_function_is_the_key_of_its_refusal() -> None:
    with raises(InvalidInput) as refusal:
        require_positive(normal_load=-3.0)
    assert refusal.value.key == "normal_load"
