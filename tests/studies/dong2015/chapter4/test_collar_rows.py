"""Section 4.5 by finite elements: rows against each other and against closed forms."""

import numpy as np
import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from dong2015 import CLAIMS, ClaimVerdict, Verdict
from dong2015.chapter4 import collar_rows as chapter4_collar
from dong2015.chapter4.collar import pulled_rod
from dong2015.chapter4.collar_rows import collar_figures, collar_rows
from dong2015.claims import finding
from sonolube.errors import SonolubeError
from sonolube.extras import missing_package
from sonolube.models.friction import sine_stick_slip_ratio


def test_friction_along_the_rod_is_that_of_the_closed_form_at_each_amplitude() -> None:
    rod = pulled_rod()
    for k in (0, rod.relative_position.size // 2):
        closed_form = sine_stick_slip_ratio(
            decay_length=2e-6,  # Rq of 6 um over 3, Table 3.2
            vibration_amplitude=rod.vibration_amplitude[k],
            frequency=24.97e3,
            sliding_speed=rod.sliding_speed,
        )
        assert rod.friction_ratio[:, k] == approx(closed_form, abs=0.01)


def test_friction_falls_most_in_the_middle_of_the_rod_and_the_work_reduction_lies_between() -> None:
    rod = pulled_rod()
    assert np.all(np.argmin(rod.friction_ratio, axis=1) == rod.relative_position.size // 2)
    assert rod.relative_position == approx(1 - rod.relative_position[::-1])
    assert rod.vibration_amplitude == approx(rod.vibration_amplitude[::-1])
    assert np.all(rod.work_reduction > 1 - rod.friction_ratio.max(axis=1))
    assert np.all(rod.work_reduction < 1 - rod.friction_ratio.min(axis=1))
    assert np.all(np.diff(rod.work_reduction) < 0)


def test_without_finite_elements_the_rows_name_the_package_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def unavailable() -> SonolubeError:
        raise missing_package("fem")

    monkeypatch.setattr(chapter4_collar, "cad_kernel", unavailable)
    rows = [row for row in collar_rows() if row.id.startswith("4.5")]
    assert len(rows) == 11
    assert {row.verdict for row in rows} == {Verdict.NOT_COMPUTED}
    assert all("pip install netgen-mesher" in row.note for row in rows)
    assert not list(collar_figures())
    (claim,) = (each for each in CLAIMS if each.id == "collar")
    assert finding(claim, {row.id: row for row in rows}).verdict is ClaimVerdict.NOT_COMPUTED
