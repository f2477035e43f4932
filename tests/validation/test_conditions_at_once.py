"""Models that compute many conditions at once: the ratios of each condition alone, and what is out of range."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.errors import OutsideRange
from sonolube.rig import read_rig
from sonolube.validation.comparison import COMPARED_MODELS
from sonolube.validation.model_variant import ConditionColumns, ModelVariant, condition_columns
from sonolube.validation.run_conditions import RunConditions
from sonolube.validation.runs_fit import own_rig_variants

RIG = read_rig(Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml")
AT_ONCE = [variant for variant in own_rig_variants(COMPARED_MODELS) if variant.takes_columns]


def conditions(count: int = 12) -> tuple[RunConditions, ...]:
    """Conditions that differ in every input but the contact."""
    rng = np.random.default_rng(4)
    return tuple(
        RunConditions(
            label=str(place),
            set_name=chr(0x4E00 + place),
            friction_ratio=0.5,
            uncertainty=None,
            repeats=1,
            contact=RIG.contact,
            normal_load=float(rng.uniform(2, 5)),
            friction_coefficient=float(rng.uniform(0.2, 0.5)),
            sliding_speed=float(rng.uniform(0.01, 0.2)),
            vibration_amplitude=float(rng.uniform(0.3e-6, 3e-6)),
            frequency=float(rng.uniform(2e4, 4e4)),
        )
        for place in range(count)
    )


@pytest.mark.parametrize("variant", AT_ONCE, ids=lambda variant: variant.name)
def test_conditions_at_once_have_the_ratios_of_each_alone(variant: ModelVariant) -> None:
    assert len(AT_ONCE) > 10
    values = [parameter.initial_values[-1] for parameter in variant.parameters]
    together = variant.predict_all(conditions(), *values)
    alone = [variant.predict(one, *values) for one in conditions()]
    assert [ratio is None for ratio in together] == [ratio is None for ratio in alone]
    assert [ratio for ratio in together if ratio is not None] == approx(
        [ratio for ratio in alone if ratio is not None], abs=1e-9
    )


def test_one_condition_out_of_range_leaves_the_others_theirs() -> None:
    def short_of_two_micrometres(test: RunConditions | ConditionColumns) -> np.ndarray:
        amplitude = np.asarray(test.vibration_amplitude)
        if np.any(amplitude > 2e-6):
            raise OutsideRange("too far")
        return 1 - amplitude / 2e-6

    limited = ModelVariant("limited", "a line", short_of_two_micrometres, takes_columns=True)
    amplitudes = [1e-6, 0.5e-6, 3e-6, *[1.5e-6] * 7]
    every = [replace(one, vibration_amplitude=a) for one, a in zip(conditions(10), amplitudes, strict=True)]
    assert limited.predict_all(every) == approx([0.5, 0.75, None, *[0.25] * 7])


def test_conditions_on_two_contacts_make_no_columns() -> None:
    rough = replace(RIG.contact, nominal_area=2 * RIG.contact.nominal_area)
    assert condition_columns([*conditions(3), replace(conditions(1)[0], contact=rough)]) is None
