"""All that is taken away names the version, the rig with its changes, and the seed of a task that draws."""

import html
import io
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import h5py
import pytest

import sonolube as sl
from sonolube.browser.answer_files import made_by, marked
from sonolube.browser.job import write_files
from sonolube.browser.requests import Places
from sonolube.browser.take_away import _FORMS, taken
from sonolube.design.horns.profile import horn_profile, profile_dxf
from sonolube.design.horns.shapes import horn_body
from sonolube.measurement.measured_runs import read_runs
from sonolube.models.fem import box_mesh, read_step, step_text, vtu_text
from sonolube.tasks.table import task_named

EXAMPLES = Path(__file__).parents[2] / "examples"
TRIBOMETER = EXAMPLES / "rigs" / "tribometer.toml"

CHANGE = ("drive.voltage_peak_to_peak", "21 V")
RIG = {"name": "tribometer", "changes": dict([CHANGE])}
ASKED = {"predict": {"rig": RIG, "draws": 400, "seed": 7}, "friction": {"rig": RIG}, "map": {"rig": RIG}}
NOWHERE = Places(rigs={})


@pytest.mark.parametrize("task", ASKED)
@pytest.mark.parametrize("form", [form for form in _FORMS if form != "svg"])
def test_each_form_names_version_rig_changes_and_seed(form: str, task: str) -> None:
    file = taken({"form": form, "task": task, "arguments": ASKED[task]}, NOWHERE)
    _expect_named(file["text"], "seed 7" if task == "predict" else "")
    assert file["name"].startswith("tribometer")
    assert form in ("toml",) or task in file["name"]


def test_a_figure_names_them_where_a_reader_of_svg_finds_them() -> None:
    file = taken({"form": "svg", "task": "predict", "arguments": ASKED["predict"]}, NOWHERE)
    (found,) = ElementTree.fromstring(file["text"]).findall("{http://www.w3.org/2000/svg}desc")
    _expect_named(found.text or "", "seed 7")


def test_a_seed_that_is_left_to_its_default_is_named() -> None:
    text = taken({"form": "csv", "task": "predict", "arguments": {"rig": RIG, "draws": 400}}, NOWHERE)["text"]
    _expect_named(text, "seed 0")


def _expect_named(text: str, seed: str) -> None:
    said = html.unescape(text)
    assert f"sonolube {sl.__version__}" in said
    assert "tribometer" in said
    key, value = CHANGE
    assert f"{key}={value}" in said or tomllib.loads(text)["drive"]["voltage_peak_to_peak"] == value
    assert seed in said


LINE = made_by(task_named("predict"), {"rig": RIG | {"name": 'my "rig" */ ?> <b> --'}, "seed": 7})
"""With all that would end a remark of some kind of file."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files of two jobs: tables, protocols and a dataset."""
    found = tmp_path_factory.mktemp("files")
    for answer in (
        sl.plan(TRIBOMETER, speed="20:40mm/s", points=2),
        sl.sweep(TRIBOMETER, over={CHANGE[0]: "2V:28V:3"}),
    ):
        write_files(answer.files(), folder=found, line=LINE)
    return found


def test_tables_protocols_and_datasets_of_jobs_are_read_as_before(folder: Path) -> None:
    endings = set()
    for path in (path for path in folder.rglob("*") if path.is_file()):
        endings.add(path.suffix)
        if path.suffix == ".nc":
            with h5py.File(path) as dataset:
                assert dataset.attrs["made_by"] == LINE
            continue
        first, _, rest = path.read_text(encoding="utf-8").partition("\n")
        assert first == f"# {LINE}"
        if path.suffix == ".toml":
            assert tomllib.loads(path.read_text(encoding="utf-8")) == tomllib.loads(rest)
    assert endings == {".csv", ".toml", ".nc"}


def test_a_table_of_runs_with_the_line_is_read(tmp_path: Path) -> None:
    text = (EXAMPLES / "tribometer-runs.csv").read_text(encoding="utf-8")
    (tmp_path / "plain.csv").write_text(text, encoding="utf-8")
    (tmp_path / "named.csv").write_text(str(marked(".csv", text, LINE)), encoding="utf-8")
    plain, named = (read_runs(tmp_path / f"{name}.csv") for name in ("plain", "named"))
    assert repr(named).replace("named.csv", "plain.csv") == repr(plain)


def test_grids_drawings_solids_and_pages_with_the_line_are_read(tmp_path: Path) -> None:
    grid = vtu_text(box_mesh(length=0.1, width=0.02, thickness=0.02, divisions=(1, 1, 1)), fields={})
    assert len(ElementTree.fromstring(marked("a.vtu", grid, LINE)).findall(".//Piece")) == 1
    page = marked("a.html", "<!doctype html><html><head><title>a</title></head></html>", LINE)
    assert f'content="{html.escape(LINE, quote=False).replace(chr(34), "&quot;")}"' in page
    assert marked("a.bin", b"\xff", LINE) == b"\xff"
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")
    ezdxf = pytest.importorskip("ezdxf", reason="ezdxf is not installed")
    body = horn_body("stepped_horn", frequency=20e3, wave_speed=5e3, sizes={})
    profile = horn_profile(body, length=body.length)
    assert profile is not None
    drawing = ezdxf.read(io.StringIO(str(marked("a.dxf", profile_dxf(profile, []), LINE))))
    assert not drawing.audit().errors
    solid = body.geometry_at(body.length)
    (tmp_path / "a.step").write_text(str(marked("a.step", step_text(solid), LINE)), encoding="utf-8")
    assert read_step(tmp_path / "a.step").volume == pytest.approx(solid.volume, rel=1e-6)
