"""Command `measure stiffness` on spectra made by other code."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from reliability import virtual_contact as virtual
from sonolube.cli import main

RIG = Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml"
SPRING = 3 / 0.7e-6


def run(*words: object) -> int:
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    return int(ended.value.code or 0)


@pytest.fixture
def spectra(tmp_path: Path) -> Path:
    rng = np.random.default_rng(0)
    slow, fast = np.linspace(70, 400, 331), np.linspace(18e3, 26e3, 201)
    loud = virtual.equivalent_spring(SPRING, amplitude=2.5e-6, decay_length=0.7e-6)
    for name, f, spring, noise in (
        ("free", slow, 0.0, 1e-3),
        ("pressed", slow, SPRING, 1e-3),
        ("again", slow, 0.0, 1e-3),
        ("loud", slow, loud, 1e-3),
        ("drive-free", fast, 0.0, 2e-2),
        ("drive-pressed", fast, 1.5e6, 2e-2),
    ):
        v = virtual.noisy(rng, virtual.velocity(virtual.TRIBOMETER, f, spring=spring), noise)
        rows = [f"{a},{abs(b)},{np.degrees(np.angle(b))}" for a, b in zip(f, v, strict=True)]
        (tmp_path / f"{name}.csv").write_text("\n".join(["frequency (Hz),velocity (m/s),phase (deg)", *rows]))
    return tmp_path


def test_slow_resonances_give_the_stiffness_and_the_lines_of_the_rig_file(
    spectra: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [spectra / f"{name}.csv" for name in ("free", "pressed", "again")]
    words = ["--rig", RIG, "--mode-near", "154Hz", "--out", spectra / "out"]
    assert run("measure", "stiffness", *files, *words, "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    values = answer["results"][0]["values"]
    stiffness = values["normal_stiffness"]
    assert stiffness["lower"] < SPRING < stiffness["upper"]
    assert stiffness["value"] == approx(SPRING, rel=0.03)
    assert values["decay_length"]["value"] == approx(0.7e-6, rel=0.03)
    assert [line.split(" =")[0] for line in answer["rig_lines"]] == [
        *("[contact]", "normal_stiffness"),
        *("[uncertainty]", '"contact.normal_stiffness"'),
    ]
    assert answer["rig_lines"][-1].endswith('"lognormal factor 1.11"')  # 10 % of modal mass
    assert (spectra / "out" / "pressed-stiffness.png").stat().st_size > 10_000


def test_the_large_drive_gives_the_decay_length_a_second_time(
    spectra: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [spectra / f"{name}.csv" for name in ("free", "pressed", "again")]
    loud = ["--large", spectra / "loud.csv", "--amplitude", "2.5um"]
    assert (
        run("measure", "stiffness", *files, "--rig", RIG, "--mode-near", "154Hz", *loud, "--out", spectra / "out") == 0
    )
    text = capsys.readouterr().out
    assert "Decay length by the ratio of shifts" in text
    assert "Decay length by both" in text
    assert "lognormal factor 1.05" in text


def test_the_drive_resonance_gives_a_sentence_instead_of_a_number(
    spectra: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [spectra / f"drive-{name}.csv" for name in ("free", "pressed")]
    assert run("measure", "stiffness", *files, "--rig", RIG, "--out", spectra / "out") == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "not found: normal stiffness: the shift of" in text
    assert "below three standard uncertainties" in text
    assert "for the rig file" not in text
    assert not re.search(r"\bnan\b", text.lower())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--load", "3N"), "modal_mass is missing"),
        ((), "--rig is missing; give the rig, or --load and --modal-mass"),
        (("--rig", RIG, "--large", "free.csv"), "--amplitude is missing"),
        (("--rig", RIG, "--amplitude", "2um"), "--amplitude has no meaning without --large"),
    ],
)
def test_what_is_missing_is_named(
    spectra: Path,
    words: tuple[str, ...],
    message: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(spectra)
    assert run("measure", "stiffness", "free.csv", "pressed.csv", *words) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
