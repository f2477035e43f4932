"""Error of a rig's friction model on unseen published tests."""

import numpy as np
from pytest import approx
from scipy.special import ellipk
from tests.same import same

from sonolube.models.friction import AsperityStickSlip, Kinematic
from sonolube.models.friction.models import FRICTION_MODELS
from sonolube.validation.assessment import unseen_error
from sonolube.validation.comparison import compare_models, compared_models
from sonolube.validation.published_tests import friction_tests


def test_a_model_without_constants_from_tests_errs_as_its_closed_form_does() -> None:
    # mean of v / sqrt(v^2 + V^2 cos^2), a complete elliptic integral
    errors = []
    for test in friction_tests("ABCDEFG"):
        peak = 2 * np.pi * test.frequency * test.vibration_amplitude
        whole = np.hypot(test.sliding_speed, peak)
        errors.append(2 / np.pi * test.sliding_speed / whole * ellipk((peak / whole) ** 2) - test.friction_ratio)
    found = unseen_error(Kinematic())
    assert found is not None
    assert found.rms == approx(np.sqrt(np.mean(np.square(errors))), rel=1e-3)
    assert found.count == len(errors) == 15


def test_the_error_of_the_default_model_is_the_one_that_compare_ranks_by() -> None:
    found = unseen_error(AsperityStickSlip())
    (compared,) = compare_models(compared_models(["asperity-stick-slip"]))
    assert found is not None
    assert compared.assessment is not None
    same(found.rms, compared.assessment.cross_validation_errors.rms)
    assert found.rms > compared.assessment.fit_errors.rms


def test_every_friction_model_has_an_error_at_its_defaults_and_none_at_other_parameters() -> None:
    for model in FRICTION_MODELS.values():
        if "normal" not in model.directions or model.for_soft_bodies:  # of which no published test along the normal is
            assert unseen_error(model()) is None
            continue
        if model.name in ("dahl", "lugre"):  # which are not among the variants fitted to the published tests
            assert unseen_error(model()) is None
            continue
        found = unseen_error(model())
        assert found is not None
        assert found.rms > 0
    assert unseen_error(AsperityStickSlip(memory_length=1e-6)) is None
