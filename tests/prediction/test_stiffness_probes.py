"""Which resonances of the reference rig tell the stiffness of its contact."""

from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, raises
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.prediction.further_measurements import Probe, probe_sentences, stiffness_probes, told_probes
from sonolube.rig import read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def probes_of(name: str, *, decay_length: Any, **accuracy: float) -> tuple[Probe, ...]:
    rig = read_rig(RIGS / f"{name}.toml")
    assert rig.structure is not None
    return stiffness_probes(rig.structure, normal_load=rig.normal_load, decay_length=decay_length, **accuracy)


PROBES = probes_of("tribometer", decay_length=[2e-6, 0.7e-6])


def test_slow_modes_of_the_reference_rig_move_as_an_independent_program_found() -> None:
    floating, slow, _ = PROBES
    assert floating.pressed_frequency == approx([99.5, 127.8], abs=0.05)
    assert slow.pressed_frequency == approx([168.5, 221.7], abs=0.05)
    assert floating.resolvable.all()
    assert slow.resolvable.all()


def test_the_drive_resonance_moves_by_less_than_its_width_resolves() -> None:
    drive = PROBES[-1]
    assert drive.free_frequency == approx(22e3, rel=1e-3)
    assert drive.shift[0] == approx(7.6, abs=0.05)
    assert 2 * drive.peak_half_width[0] / drive.shift[0] == approx(140, rel=0.05)
    assert not drive.resolvable[0]
    assert np.isinf(drive.log_stiffness_deviation[0])
    # first order: k_n/(8 pi^2 m f_0)
    assert drive.shift[0] == approx(1.5e6 / (8 * np.pi**2 * drive.modal_mass * drive.free_frequency), rel=0.01)


def test_sentences_name_the_best_probe_first_and_the_blind_one_last() -> None:
    first, *_, last = probe_sentences(PROBES)
    assert "99.52 Hz at l = 2 um and 127.8 Hz at l = 700 nm" in first
    assert last.startswith("mode at 22 kHz")
    assert last.endswith("not resolvable")


def test_expected_uncertainty_falls_with_finer_frequencies_down_to_that_of_the_mass() -> None:
    coarse, fine = (
        probes_of("tribometer", decay_length=2e-6, resolution=share, modal_mass_deviation=0.05)[1]
        for share in (1 / 20, 1 / 1000)
    )
    assert coarse.log_stiffness_deviation[0] > 0.08
    assert fine.log_stiffness_deviation[0] == approx(0.05, rel=0.01)


def test_a_rig_without_structure_has_no_probe_and_is_told_so() -> None:
    assert "no structure is known" in probe_sentences(())[0]


def test_a_decay_length_of_zero_is_refused() -> None:
    with raises(InvalidInput, match="decay_length must be positive"):
        probes_of("tribometer", decay_length=0.0)


def test_a_prediction_tells_the_two_best_probes_and_the_mode_that_vibrates() -> None:
    collar = read_rig(RIGS / "collar.toml")
    assert collar.drive is not None
    probes = probes_of("collar", decay_length=1.6e-6)
    told = told_probes(probes, frequency=collar.drive.frequency)
    assert len(told) == 3
    best = min(probe.log_stiffness_deviation[0] for probe in probes)
    same(told[0].log_stiffness_deviation[0], best)
    assert abs(told[2].free_frequency - collar.drive.frequency) < 500
    assert told_probes((), frequency=2e4) == ()
