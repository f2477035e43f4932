"""Task `new` in Python: the rig and file of the command, which other tasks take."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, mark, raises
from tests.same import same, same_files

import sonolube as sl
from sonolube.errors import InvalidInput, SonolubeError, UnknownName
from sonolube.facts.materials import material
from sonolube.models.contact import layer_normal_stiffness
from sonolube.models.friction import SoftLayerModel
from sonolube.tasks.files import NamedBytes

KNOWN: dict[str, Any] = {"pin": "brass", "disc": "304", "load": "5 N", "speed": "0.2 m/s", "frequency": "20 kHz"}
KNOWN |= {"amplitude": "3 um", "finish": "ground N6"}
_LAYER = (
    ("dynamic_modulus_ratio", "dynamic_modulus_ratio"),
    ("layer_loss", "elastic_loss"),
    ("layer_density", "density"),
)


def test_a_new_rig_is_that_of_the_command_and_predicts_with_its_own_materials(
    tmp_path: Path, on_terminal: Callable[..., dict[str, Any]]
) -> None:
    options = [text for key, value in KNOWN.items() for text in (f"--{key}", value)]
    command, found = on_terminal("new", "rig.toml", *options), sl.new(**KNOWN)
    same(found.json_object(), command)
    same_files({"rig.toml": (tmp_path / "rig.toml").read_bytes()}, found.files())
    assert found.rig.table() == sl.read_rig(tmp_path / "rig.toml").table()
    prediction = sl.predict(found)
    assert "Heat of friction" in prediction.object()["statement"][-1]
    with_names = sl.predict(found.rig, pin="brass", disc="304")
    same(prediction["mean_temperature_rise"], with_names["mean_temperature_rise"])


def test_numbers_in_si_give_the_file_of_the_texts() -> None:
    in_si = KNOWN | {"load": 5.0, "speed": np.float64(0.2), "frequency": 20e3, "amplitude": 3e-6}
    same_files(sl.new(**in_si).files(), sl.new(**KNOWN).files())
    turning = KNOWN | {"speed": "60 rpm"}
    by_radius, by_diameter = (
        sl.new(**turning, **track).files() for track in ({"track_radius": 0.015}, {"track_diameter": "30 mm"})
    )
    same_files(by_radius, by_diameter)
    driven = KNOWN | {"amplitude": None, "actuator": "sa050510"}
    by_text = sl.new(**driven, voltage="40 V", friction="0.4", stiffness="1.5 MN/m")
    same_files(sl.new(**driven, voltage=40.0, friction=0.4, stiffness=1.5e6).files(), by_text.files())


def test_a_scan_may_be_bytes(tmp_path: Path) -> None:
    heights = 1e-6 * np.random.default_rng(0).standard_normal((64, 64))
    header = "Channel: Height\nWidth: 64 um\nHeight: 64 um\nValue units: m"
    np.savetxt(tmp_path / "plate.asc", heights, header=header)
    by_path = sl.new(**KNOWN, scan=tmp_path / "plate.asc")
    content = NamedBytes("plate.asc", (tmp_path / "plate.asc").read_bytes())
    same_files(sl.new(**KNOWN, scan=content).files(), by_path.files())
    assert by_path.files() != sl.new(**KNOWN).files()


def test_the_dataset_has_the_spread_of_what_nobody_measured() -> None:
    quantile = sl.new(**KNOWN)["quantile"].sel(entry="friction.friction_coefficient").to_numpy()
    low, high = quantile[[0, 2]]
    assert quantile[1] == approx((low + high) / 2)  # uniform


@mark.parametrize(
    ("change", "line"),
    [
        ({"load": -5.0}, r"^load -5\.0 N must be positive"),
        ({"load": float("nan")}, "^load 'nan N' is not a number"),
        ({"speed": "60 rpm"}, "^speed 60 rpm is a rotational speed: give track_radius or track_diameter too"),
        ({"amplitude": None}, "^give amplitude, calibration, or actuator with its voltage"),
        ({"voltage": 40.0}, "^actuator and voltage belong together"),
        ({"actuator": "sa050510", "voltage": 40.0}, "^give either amplitude or actuator, got both"),
        ({"decay_length": 1e-6, "stiffness": 1e6}, "^give either decay_length or stiffness, got both"),
        ({"shape": "cone 3mm"}, "^shape 'cone 3mm' must be 'flat'"),
    ],
)
def test_arguments_are_refused_by_their_names(change: dict[str, Any], line: str) -> None:
    with raises(InvalidInput, match=line):
        sl.new(**KNOWN | change)


@mark.parametrize("name", ["felt", "rubber", "pom", "skin", "webbing"])
def test_a_soft_layer_runs_from_its_material_alone_and_marks_what_is_assumed(name: str) -> None:
    soft = KNOWN | {"pin": name, "disc": "glass", "shape": "flat 20 mm"}
    found = sl.new(**soft, layer_thickness="3 mm").rig
    model, body = found.friction_model, material(name)
    assert isinstance(model, SoftLayerModel)
    of_class = material(body.family)
    stated = {**of_class.properties, **body.properties}
    assert (model.dynamic_modulus_ratio, model.layer_loss, model.layer_density) == approx(
        (stated["dynamic_modulus_ratio"].value, stated["elastic_loss"].value, stated["density"].value), rel=1e-3
    )
    assert model.layer_thickness == approx(3e-3)
    keys = ("friction.dynamic_modulus_ratio", "friction.layer_loss", "friction.layer_density")
    assert all(stated[key].source in found.assumptions[f"friction.{own}"] for own, key in _LAYER)
    assert all(key in found.uncertainty for key in keys[:2])
    ratio = float(sl.friction(found)["friction_ratio"])
    assert 0 <= ratio <= 1
    quiet = found.replace("vibration.vibration_amplitude", "0.01 nm")
    assert float(sl.friction(quiet)["friction_ratio"]) == approx(1.0, abs=1e-3)


def test_a_thin_felt_is_as_stiff_as_its_oedometric_modulus_says() -> None:
    felt = KNOWN | {"pin": "felt", "disc": "glass", "shape": "flat 60 mm"}
    rig = sl.new(**felt, layer_thickness="0.5 mm").rig
    model = rig.friction_model
    assert isinstance(model, SoftLayerModel)
    E, nu = material("felt").value("youngs_modulus"), 0.2
    winkler = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) * np.pi * 0.03**2 / 0.5e-3
    k = layer_normal_stiffness(model.layer(rig.contact), face_radius=0.03)
    assert k == approx(winkler, rel=0.03)


def test_a_layer_that_is_pressed_hard_is_computed_and_says_that_it_is_no_longer_linear() -> None:
    felt = KNOWN | {"pin": "felt", "disc": "glass", "shape": "flat 3 mm"}
    text = str(sl.friction(sl.new(**felt, layer_thickness="3 mm").rig))
    assert "presses the mean planes of this roughness together" in text
    assert "more than a fifth of its thickness" in " ".join(text.split())
    with raises(SonolubeError, match="leaves no separation between the surfaces"):
        sl.friction(sl.new(**felt, decay_length="0.2 um").rig.replace("friction.model", "asperity_stick_slip"))


def test_a_thickness_of_a_hard_body_or_within_the_plane_is_refused() -> None:
    with raises(InvalidInput, match=r"layer_thickness is of a soft body, and .* is none"):
        sl.new(**KNOWN, layer_thickness="3 mm")
    with raises(InvalidInput, match="a soft layer has no law for a vibration"):
        sl.new(**KNOWN | {"pin": "felt"}, layer_thickness="3 mm", direction="along")


def test_an_unknown_material_is_refused_with_the_nearest() -> None:
    with raises(UnknownName, match="unknown material 'stee'; did you mean steel"):
        sl.new(**KNOWN | {"pin": "stee"})
