"""Task `measure.stiffness` in Python: the answer of the program, spectra as bytes, and another load than the rig's."""

import json
from pathlib import Path

import numpy as np
import pytest
from pytest import CaptureFixture, approx, raises
from tests.same import same

from reliability import virtual_contact as virtual
from sonolube.cli import main
from sonolube.errors import InvalidInput
from sonolube.rig import read_rig
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.measure import stiffness

RIG = Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml"


@pytest.fixture
def spectra(tmp_path: Path) -> list[Path]:
    rng, f = np.random.default_rng(0), np.linspace(70, 400, 331)
    paths = []
    for name, spring in (("free", 0.0), ("pressed", 3 / 0.7e-6), ("again", 0.0)):
        v = virtual.noisy(rng, virtual.velocity(virtual.TRIBOMETER, f, spring=spring), 1e-3)
        rows = [f"{a},{abs(b)},{np.degrees(np.angle(b))}" for a, b in zip(f, v, strict=True)]
        paths.append(tmp_path / f"{name}.csv")
        paths[-1].write_text("\n".join(["frequency (Hz),velocity (m/s),phase (deg)", *rows]))
    return paths


def test_stiffness_in_python_is_the_answer_of_the_program(
    spectra: list[Path], tmp_path: Path, capfd: CaptureFixture[str]
) -> None:
    words = ["--rig", RIG, "--mode-near", "154Hz", "--load", "2N", "--mass-uncertainty", "20%", "--out", tmp_path]
    with raises(SystemExit):
        main([str(word) for word in ("measure", "stiffness", *spectra, *words, "--json")])
    program = json.loads(capfd.readouterr().out)
    assert sorted(Path(path).name for path in program.pop("files")) == [
        f"pressed-stiffness.{form}" for form in ("pdf", "png", "svg")
    ]
    text = stiffness(*spectra, rig=RIG, mode_near="154Hz", load="2N", mass_uncertainty="20%")
    in_si = stiffness(
        *(NamedBytes(path.name, path.read_bytes()) for path in spectra),
        rig=read_rig(RIG),
        mode_near=154.0,
        load=2.0,
        mass_uncertainty=0.2,
    )
    for answer in (text, in_si):
        same(answer.json_object(), program)
    data, values = text.dataset(), program["results"][0]["values"]
    assert float(data["normal_load"]) == 2.0
    same(float(data["normal_stiffness_upper"]), values["normal_stiffness"]["upper"])
    assert float(data["decay_length"]) == approx(2.0 / values["normal_stiffness"]["value"])
    assert text.plot().axes


def test_what_is_missing_is_named_as_in_python(spectra: list[Path]) -> None:
    with raises(InvalidInput, match=r"^rig is missing; give the rig, or load and modal_mass$"):
        stiffness(*spectra)
    with raises(InvalidInput, match=r"^amplitude has no meaning without large"):
        stiffness(*spectra, rig=RIG, amplitude=2e-6)
    with raises(InvalidInput, match=r"^load 2m is a length"):
        stiffness(*spectra, rig=RIG, load="2m")
