"""Main tasks in Python: the same numbers and figures as the commands, with units, caveats and assumptions."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from pytest import CaptureFixture, MonkeyPatch, approx, importorskip, mark, raises

import sonolube as sl
from sonolube.cli import main
from sonolube.errors import InvalidInput, MissingPackage, UnknownName
from sonolube.figure import publication_style, render_figure
from sonolube.rig.figures import simulation_figure
from sonolube.workbench.part_modes import DEFAULT_MATERIAL, SupportedPart, supported_part

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "examples" / "rigs"
SHARED = ROOT.parent / "shared" / "data"
VOLTAGE = "drive.voltage_peak_to_peak"


def tribometer() -> sl.Rig:
    return sl.read_rig(RIGS / "tribometer.toml")


def answer(capfd: CaptureFixture[str], *arguments: object) -> dict[str, Any]:
    with raises(SystemExit) as end:
        main([*map(str, arguments), "--json"])
    assert not end.value.code
    content: dict[str, Any] = json.loads(capfd.readouterr().out)
    return content


@mark.parametrize("name", ["tribometer", "power_map", "poisson_al_steel", "welder_round"])
def test_a_simulation_in_python_has_the_numbers_and_notes_of_the_command(
    name: str, capfd: CaptureFixture[str], tmp_path: Path
) -> None:
    path = RIGS / f"{name}.toml"
    command, result = answer(capfd, "simulate", path, "--out", tmp_path), sl.simulate(sl.read_rig(path))
    for quantity in ("friction_ratio", "friction_force", "vibration_amplitude"):
        assert float(result[quantity]) == command[quantity]["value"]
        assert result[quantity].attrs["units"] == (command[quantity]["unit"] or "1")
    assert result.attrs["caveats"].split("\n") == (command["caveats"] or [""])
    assert result.attrs["status"] == command["status"]
    assert result.attrs["amplitude_source"] == command["amplitude_source"]
    (written,) = tmp_path.glob("*.nc")
    with xr.open_dataset(written) as stored:
        assert stored["displacement"].to_numpy() == approx(result["displacement"].to_numpy())


def test_a_sweep_in_python_is_that_of_the_command_and_of_single_points(
    capfd: CaptureFixture[str], tmp_path: Path
) -> None:
    over = "2V:28V:5"
    command = answer(capfd, "sweep", RIGS / "tribometer.toml", "--over", f"{VOLTAGE}={over}", "--out", tmp_path)
    swept = sl.sweep(tribometer(), {VOLTAGE: over})
    assert float(swept["friction_ratio"].min()) == command["least_friction"]["friction_ratio"]["value"]
    single = [sl.simulate(tribometer().replace(VOLTAGE, f"{volts} V")) for volts in np.linspace(2, 28, 5)]
    assert swept["friction_ratio"].to_numpy() == approx([float(one["friction_ratio"]) for one in single], abs=1e-6)
    assert "identified from resonance" in swept.attrs["assumptions"]


def test_numbers_in_si_text_and_drawn_points_make_the_same_kind_of_sweep() -> None:
    by_text = sl.sweep(tribometer(), {VOLTAGE: "10 V, 20 V"})
    assert sl.sweep(tribometer(), {VOLTAGE: [10.0, 20.0]}).equals(by_text)
    drawn = sl.sweep(tribometer(), {VOLTAGE: "10V:20V"}, sample="lhs", points=8, seed=3)
    assert drawn["friction_ratio"].sizes == {"point": 8}
    assert float(drawn["voltage_peak_to_peak"].min()) >= 10
    again = sl.sweep(tribometer(), {VOLTAGE: (10.0, 20.0)}, sample="lhs", points=8, seed=3)
    assert again["friction_ratio"].equals(drawn["friction_ratio"])


def test_a_map_takes_other_axes_and_carries_the_notes_of_the_rig() -> None:
    mapped = sl.map(
        sl.read_rig(RIGS / "power_map.toml"),
        over={"sliding.sliding_speed": "20mm/s:200mm/s:3", "contact.normal_load": [5.0], VOLTAGE: "10V, 20V"},
    )
    assert mapped["friction_reduction"].sizes == {"normal_load": 1, "voltage_peak_to_peak": 2, "sliding_speed": 3}
    assert "assumed" in mapped.attrs["assumptions"] or mapped.attrs["assumptions"]
    assert mapped.attrs["caveats"]


def test_results_and_their_files_draw_the_figure_of_the_command(tmp_path: Path) -> None:
    result = sl.simulate(tribometer())
    result.to_netcdf(tmp_path / "kept.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "kept.nc", engine="h5netcdf") as kept:
        figures = [sl.plot(result), sl.plot(kept)]
    with publication_style():
        figures.append(simulation_figure(result))
    lines = [[line.get_xydata() for axes in figure.axes for line in axes.lines] for figure in figures]
    for own, other in zip(lines[0], lines[1], strict=True):
        assert np.asarray(own) == approx(np.asarray(other))
    for own, other in zip(lines[0], lines[2], strict=True):
        assert np.array_equal(own, other)


def test_every_kind_of_result_has_its_figure() -> None:
    rig = tribometer()
    results = [sl.sweep(rig, {VOLTAGE: "10V:20V:3"}), sl.predict(rig, draws=200)]
    assert [bool(sl.plot(result).axes) for result in results] == [True, True]


def test_a_comparison_has_the_rigs_ratios_of_the_command_and_its_figure(
    capfd: CaptureFixture[str], tmp_path: Path
) -> None:
    names, path = ("kinematic", "asperity-stick-slip"), RIGS / "tribometer.toml"
    options = [option for name in names for option in ("--model", name)]
    command = answer(capfd, "compare", path, *options, "--out", tmp_path)
    result = sl.compare(sl.read_rig(path), models=names)
    for each in command["rig"]["predictions"]:
        assert float(result["rig_friction_ratio"].sel(model=each["model"])) == each["friction_ratio"]
    assert [label.get_text() for label in sl.plot(result).axes[0].get_yticklabels()][-1] == "asperity stick slip"
    without = sl.compare(models=names)
    assert {axes.get_title().split("\n")[0] for axes in sl.plot(without).axes} == {"kinematic", "asperity stick slip"}


def test_a_new_rig_is_that_of_the_command_and_predicts_with_its_own_materials(
    capfd: CaptureFixture[str], tmp_path: Path
) -> None:
    known: dict[str, Any] = {"pin": "brass", "disc": "304", "load": "5 N", "speed": "0.2 m/s", "frequency": "20 kHz"}
    options = [text for key, value in known.items() for text in (f"--{key}", value)]
    path = tmp_path / "rig.toml"
    answer(capfd, "new", path, *options, "--amplitude", "3um", "--finish", "ground N6")
    rig = sl.new_rig(**known, amplitude="3 um", finish="ground N6")
    assert rig.table() == sl.read_rig(path).table()
    prediction = sl.predict(rig, draws=300)
    assert "Heat of friction" in prediction.attrs["statement"]
    with_names = sl.predict(rig, draws=300, pin="brass", disc="304")
    assert prediction["mean_temperature_rise"].equals(with_names["mean_temperature_rise"])


def test_a_fit_of_own_runs_has_its_figure() -> None:
    fitted = sl.fit_runs(sl.read_runs(ROOT / "examples" / "tribometer-runs.csv"), tribometer())
    assert sl.plot(fitted).axes


def test_what_is_no_result_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"plot draws results of comparison, map, .* and of measure and fit"):
        sl.plot(xr.Dataset())
    with raises(UnknownName, match="velocity-power"):
        sl.map(tribometer(), "velocity-powr")
    with raises(InvalidInput, match=r"over drive\.voltage_peak_to_peak=2V:28V must look like"):
        sl.sweep(tribometer(), {VOLTAGE: "2V:28V"})
    with raises(InvalidInput, match="between two ends, got 3 numbers"):
        sl.sweep(tribometer(), {VOLTAGE: [1.0, 2.0, 3.0]}, sample="lhs")


def test_a_measured_surface_has_the_values_of_the_command(capfd: CaptureFixture[str]) -> None:
    path = SHARED / "surfaces" / "opd-1.opd"
    (command,) = answer(capfd, "measure", "surface", path)["results"]
    sheet = sl.measure.surface(path)
    values = sheet.dataset()
    for name, value in command["values"].items():
        assert float(values[name]) == value["value"]
        assert values[name].attrs["units"] == (value["unit"] or "1")
    assert sl.plot(sheet).axes
    assert repr(sheet).startswith(command["title"])
    assert sheet._repr_html_().count("<tr>") == len(command["values"])
    with raises(UnknownName):
        sl.plot(sheet, title="no such figure")


BAR: dict[str, Any] = {"sizes": {"length": "60mm", "radius": 6e-3}, "count": 2, "tolerance": 0.05}
BAR_OPTIONS = ("--set", "length=60mm", "--set", "radius=6mm", "--count", "2", "--tolerance", "0.05")


def test_modes_in_python_have_the_numbers_and_the_very_pictures_of_the_command(
    capfd: CaptureFixture[str], tmp_path: Path
) -> None:
    importorskip("netgen.occ", reason="netgen-mesher is not installed")
    command = answer(capfd, "modes", "cylinder", *BAR_OPTIONS, "--density", "2000kg/m3", "--out", tmp_path)
    result = sl.modes("cylinder", density=2000.0, **BAR)
    assert [str(name) for name in result["mode"].to_numpy()] == [mode["name"] for mode in command["modes"]]
    for quantity in ("natural_frequency", "frequency_error"):
        assert list(result[quantity].to_numpy()) == [mode[quantity]["value"] for mode in command["modes"]]
        assert result[quantity].attrs["units"] == (command["modes"][0][quantity]["unit"] or "1")
    assert result.attrs["material"] == command["material"]
    assert (list(result.attrs["nodes"]), result.attrs["rigid_motions"]) == (command["nodes"], 6)
    result.to_netcdf(tmp_path / "kept.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "kept.nc", engine="h5netcdf") as kept:
        pictures = [sl.plot(result), sl.plot(kept, title="bending 2")]
    written = sorted(tmp_path.glob("*.png"))
    assert [render_figure(picture, "png") for picture in pictures] == [path.read_bytes() for path in written]
    with raises(UnknownName, match="unknown figure of modes 'bendin 1'; did you mean bending 1"):
        sl.plot(result, title="bendin 1")


def test_modes_carry_what_is_assumed_of_a_part(
    capfd: CaptureFixture[str], tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    importorskip("netgen.occ", reason="netgen-mesher is not installed")
    assert (
        "62 layers" in supported_part("tribometer_actuator", {}, material=DEFAULT_MATERIAL).assumptions["outer_radius"]
    )
    assumed = {"radius": "scaled from a drawing", "length": "of the catalogue"}
    monkeypatch.setattr(SupportedPart, "assumptions", assumed)  # a transducer takes a minute to solve
    command = answer(capfd, "modes", "cylinder", *BAR_OPTIONS, "--out", tmp_path)
    assert command["assumptions"] == assumed
    assert sl.modes("cylinder", **BAR).attrs["assumptions"] == "radius: scaled from a drawing\nlength: of the catalogue"


def test_a_part_that_cannot_be_made_is_refused_in_the_words_of_python(monkeypatch: MonkeyPatch) -> None:
    with raises(InvalidInput, match="a cylinder needs radius; give each in sizes, such as radius=20mm"):
        sl.modes("cylinder", sizes={"length": "60mm"})
    with raises(InvalidInput, match=r"^material pzt_4: a piezoelectric ceramic needs its poling"):
        sl.modes("cylinder", material="pzt_4", **BAR)
    with raises(InvalidInput, match="stack has its own materials; leave material='brass' out"):
        sl.modes("stack", material="brass")
    for module in ("netgen", "netgen.occ", "netgen.meshing"):
        monkeypatch.setitem(sys.modules, module, None)
    with raises(MissingPackage, match=r"^bodies and their meshes, .* not installed: pip install 'sonolube\[fem\]'$"):
        sl.modes("cylinder", **BAR)


def test_files_without_spacing_or_unit_take_them_as_the_command_does(
    capfd: CaptureFixture[str], tmp_path: Path
) -> None:
    heights = 1e-6 * np.random.default_rng(2).standard_normal((64, 80))
    np.save(tmp_path / "grid.npy", heights)
    y, x = np.mgrid[:40, :50]
    columns = np.stack([2.0 * x.ravel(), 3.0 * y.ravel(), 1e6 * heights[:40, :50].ravel()], axis=1)
    np.savetxt(tmp_path / "points.xyz", columns)
    for name, options, given in (
        ("grid.npy", ("--spacing", "0.5um,0.6um"), {"spacing": "0.5um,0.6um"}),
        ("points.xyz", ("--length-unit", "um"), {"length_unit": "um"}),
    ):
        (command,) = answer(capfd, "measure", "surface", tmp_path / name, *options)["results"]
        values = sl.measure.surface(tmp_path / name, **given).dataset()
        assert {key: float(values[key]) for key in command["values"]} == {
            key: value["value"] for key, value in command["values"].items()
        }
    with raises(InvalidInput, match="give spacing_x and spacing_y"):
        sl.measure.surface(tmp_path / "grid.npy")
    with raises(InvalidInput, match="spacing 1N is a force; expected a length"):
        sl.measure.groove(tmp_path / "grid.npy", spacing="1N")


def test_a_groove_in_a_bare_grid_is_measured_with_its_spacing(capfd: CaptureFixture[str], tmp_path: Path) -> None:
    x = 8e-6 * np.arange(160)
    section = -3e-6 * np.exp(-(((x - x.mean()) / 120e-6) ** 2))
    np.save(tmp_path / "groove.npy", section + 5e-8 * np.random.default_rng(3).standard_normal((120, 160)))
    (command,) = answer(capfd, "measure", "groove", tmp_path / "groove.npy", "--spacing", "8um")["results"]
    values = sl.measure.groove(tmp_path / "groove.npy", spacing="8um").dataset()
    assert float(values["groove_width"]) == command["values"]["groove_width"]["value"]


def test_importing_the_package_is_fast_to_complete_and_loads_nothing() -> None:
    code = (
        "import sys, sonolube as sl\n"
        "print(dir(sl))\n"
        "print([name for name in ('numpy', 'scipy', 'numba', 'xarray', 'matplotlib') if name in sys.modules])\n"
        "print(dir(sl.measure))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names, loaded, measure = run.stdout.splitlines()
    assert loaded == "[]"
    assert {"read_rig", "predict", "simulate", "sweep", "map", "measure", "design", "published", "plot"} <= set(
        eval(names)
    )
    assert eval(measure) == sl.measure.__all__
    assert not [name for name in (*eval(names), *eval(measure)) if name in ("np", "Path", "dataclass", "Callable")]
