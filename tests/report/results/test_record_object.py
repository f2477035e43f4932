"""Fields of records, numbers that JSON lacks, quantities as datasets, and a rig in words."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from pytest import MonkeyPatch, approx, mark

from sonolube.report.results import record_object as results


def test_fields_come_in_the_order_of_their_names() -> None:
    assert list(results.picked(SimpleNamespace(a=1, b=2, c=3), "c", "a").items()) == [("c", 3), ("a", 1)]


@mark.parametrize(("value", "found"), [(1.5, 1.5), (np.inf, None), (-np.inf, None), (np.nan, None), (0.0, 0.0)])
def test_numbers_that_json_lacks_are_null(value: float, found: float | None) -> None:
    assert results.finite(value) == (None if found is None else approx(found))


def test_facts_of_several_things_have_units_and_nan_where_one_is_not_known() -> None:
    found = results.facts_dataset(
        "body", {"brass": {"density": 8500.0, "hardness": 1.2e9}, "wood": {"density": 700.0}},
        {"brass": "Brass", "wood": "Oak"},
    )  # fmt: skip
    assert found["density"].values == approx([8500.0, 700.0])
    assert found["hardness"].values[0] == approx(1.2e9)
    assert np.isnan(found["hardness"].values[1])
    assert found["hardness"].attrs["units"] == "Pa"
    assert found["title"].values.tolist() == ["Brass", "Oak"]
    assert found["body"].values.tolist() == ["brass", "wood"]


def test_scalars_are_the_quantities_of_an_object_and_its_texts_are_attributes() -> None:
    content = {
        "rig": "own", "normal_load": {"value": 3.0, "unit": "N"}, "lost": {"value": None, "unit": "m"},
        "more": {"value": 1.0, "unit": "m", "lower": 0.0}, "list": [1.0],
    }  # fmt: skip
    found = results.scalar_dataset(content)
    assert set(found.data_vars) == {"normal_load", "lost"}
    assert float(found["normal_load"]) == approx(3.0)
    assert found["normal_load"].attrs == {"units": "N", "long_name": "normal load"}
    assert np.isnan(float(found["lost"]))
    assert found.attrs == {"rig": "own"}


def test_a_rig_in_one_line_has_title_load_speed_and_friction_model(monkeypatch: MonkeyPatch) -> None:
    own: Any = SimpleNamespace(
        title="Own rig", normal_load=3.0, sliding_speed=0.0203, friction_model=SimpleNamespace(name="kinematic"),
        file=Path("folder/own.toml"), source="measured", friction_coefficient=0.2034,
    )  # fmt: skip
    labels = {"amplitude_source": "stated", "amplitude_origin": "2.5 um, as the file states"}
    monkeypatch.setattr("sonolube.rig.amplitude_labels", lambda known: labels if known is own else {})
    assert results.friction_model_text(own) == "friction model kinematic"
    assert results.operating_point(own) == "Own rig, 3 N, 20.3 mm/s, friction model kinematic"
    assert results.amplitude_rows(own) == [("amplitude", "2.5 um, as the file states")]
    assert results.rig_settings(own) == [
        ("rig", "Own rig (own.toml)"),
        ("source of its numbers", "measured"),
        ("load and speed", "3 N, 20.3 mm/s"),
        ("without vibration", "coefficient of friction 0.203"),
        ("friction model", "kinematic"),
        ("amplitude", "2.5 um, as the file states"),
    ]
    own.file, own.source = None, ""
    assert results.rig_settings(own)[:2] == [("rig", "Own rig"), ("load and speed", "3 N, 20.3 mm/s")]
