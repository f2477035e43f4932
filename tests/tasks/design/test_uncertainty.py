"""Task `uncertainty` in Python: the numbers of the command, keys in SI, kept parts, and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pytest import raises
from tests.same import same

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.tasks.design.uncertainty import uncertainty

SPEED = "sliding.sliding_speed"


@pytest.fixture
def path(rigs: Path) -> Path:
    return rigs / "tribometer_uncertain.toml"


def test_statistics_are_those_of_the_command_also_of_a_changed_rig(
    path: Path, on_terminal: Callable[..., dict[str, Any]]
) -> None:
    found = uncertainty(path, samples=32)
    same(found.json_object(), on_terminal("uncertainty", path, "--samples", 32) | {"caveats": found.every_caveat()})
    assert "take more samples" in found.every_caveat()[0]
    changed = uncertainty(sl.read_rig(path).replace("contact.normal_load", "4 N"), samples=32, of="friction_force")
    other = on_terminal(
        "uncertainty", path, "--samples", 32, "--set", "contact.normal_load=4N", "--of", "friction_force"
    )
    same(changed.object()["mean"], other["mean"])


def test_a_band_takes_keys_as_text_or_in_si_and_keeps_parts_in_a_folder(path: Path, tmp_path: Path) -> None:
    kept = uncertainty(path, samples=32, over={SPEED: "20mm/s,40mm/s"}, keep=tmp_path)
    assert {each.name for each in tmp_path.iterdir()} >= {"sweep.nc", "sweep.json"}
    again = uncertainty(path, samples=32, over={SPEED: [0.02, 0.04]}, keep=tmp_path)
    same(kept.dataset(), again.dataset())
    assert kept["friction_ratio"].sizes == {"sample": 32, "sliding_speed": 2}
    with raises(InvalidInput, match="holds another sweep"):
        uncertainty(path, samples=64, keep=tmp_path)


def test_arguments_are_refused_by_their_names(path: Path, rigs: Path) -> None:
    with raises(InvalidInput, match=r"^samples must be finite and lie between 32 and inf, got 8"):
        uncertainty(path, samples=8)
    with raises(InvalidInput, match=r"^over friction\.model: a band needs numbers"):
        uncertainty(path, over={"friction.model": ["kinematic", "asperity_stick_slip"]})
    with raises(InvalidInput, match=r"^sobol needs independent entries .* leave out over and identified"):
        uncertainty(path, sobol=True, identified=True)
    with raises(InvalidInput, match=r"tribometer\.toml: the table uncertainty is missing"):
        uncertainty(rigs / "tribometer.toml")
