"""Section 4.5 by finite elements: rows against each other and against what no finite element knows."""

import numpy as np
import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.errors import SonolubeError
from sonolube.fem.solver.cad import MissingPackage
from sonolube.friction import sine_stick_slip_ratio
from sonolube.reproduce import Verdict
from sonolube.reproduce.chapter4 import collar_rows as chapter4_collar
from sonolube.reproduce.chapter4.collar import pull
from sonolube.reproduce.chapter4.collar_figures import collar_figures
from sonolube.reproduce.chapter4.collar_rows import collar_rows


def test_friction_along_the_rod_is_that_of_the_closed_form_at_each_amplitude() -> None:
    rod = pull()
    for k in (0, rod.place.size // 2):
        closed_form = sine_stick_slip_ratio(
            decay_length=2e-6,  # Rq of 6 um over 3, Table 3.2
            vibration_amplitude=rod.vibration_amplitude[k],
            frequency=24.97e3,
            sliding_speed=rod.sliding_speed,
        )
        assert rod.friction_ratio[:, k] == approx(closed_form, abs=0.01)


def test_the_middle_of_the_rod_gains_most_and_the_work_lies_between() -> None:
    rod = pull()
    assert np.all(np.argmin(rod.friction_ratio, axis=1) == rod.place.size // 2)
    assert rod.place == approx(1 - rod.place[::-1])
    assert rod.vibration_amplitude == approx(rod.vibration_amplitude[::-1])
    assert np.all(rod.work_reduction > 1 - rod.friction_ratio.max(axis=1))
    assert np.all(rod.work_reduction < 1 - rod.friction_ratio.min(axis=1))
    assert np.all(np.diff(rod.work_reduction) < 0)


def test_without_finite_elements_the_rows_say_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def lacking() -> SonolubeError:
        raise MissingPackage("finite elements need netgen-mesher; install it with: pip install sonolube[fem]")

    monkeypatch.setattr(chapter4_collar, "cad_kernel", lacking)
    rows = list(collar_rows())
    assert {row.verdict for row in rows} == {Verdict.UNDETERMINED}
    assert all("pip install sonolube[fem]" in row.note for row in rows)
    assert collar_figures() == ()
