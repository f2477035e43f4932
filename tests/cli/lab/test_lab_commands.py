"""Commands of the laboratory: runs, show, recover, export, and queries of the catalogue as tables of runs."""

from pathlib import Path

from pytest import approx
from tests.cli.conftest import ROOT, Program
from tests.cli.lab.test_run import SHORT
from tests.laboratory.catalogue.test_catalogue import run_of
from tests.laboratory.records.recorded import begun, block_of, recorded
from tests.laboratory.records.test_recovery import unfinished

RIG = ROOT / "examples" / "rigs" / "tribometer.toml"


def test_runs_lists_what_conditions_find(tmp_path: Path, sonolube: Program) -> None:
    run_of(tmp_path)
    found = run_of(tmp_path, normal_load=9.0, tags="map")
    run = sonolube("lab", "runs", tmp_path, "--load", "8N..10N", "--tag", "map")
    assert run.out.startswith(f"1 of 2 runs in {tmp_path}\n")
    assert found.name in run.out
    answer = sonolube("lab", "runs", tmp_path, "--material", "brass", "--json").answer
    assert [each["normal_load"] for each in answer["runs"]] == [5.0, 9.0]


def test_runs_takes_in_recordings_made_elsewhere(tmp_path: Path, sonolube: Program) -> None:
    (tmp_path / "old.csv").write_text("time (s),friction_force (N)\n0,1\n1,1\n2,1\n")
    more = ("--add", tmp_path / "old.csv", "--fact", "normal_load=4", "--fact", "pin_material=brass")
    answer = sonolube("lab", "runs", tmp_path / "runs", *more, "--json").answer
    assert [(each["title"], each["normal_load"]) for each in answer["runs"]] == [("old", 4.0)]
    assert "without --add" in sonolube("lab", "runs", tmp_path / "runs", *more[2:]).refusal


def test_show_tells_facts_events_and_gaps_and_draws_the_channels(tmp_path: Path, sonolube: Program) -> None:
    recorder = begun(tmp_path, operator="D")
    recorder.append(block_of(0, 20))
    recorder.append(block_of(25, 20))
    folder = recorder.finish("stopped", reason="a limit").folder
    run = sonolube("lab", "show", folder, "--out", tmp_path / "out")
    for text in ("stopped: a limit", "operator", "sample 20  gap: missing 5", "caveat: samples are missing: a gap"):
        assert text in run.out
    assert (tmp_path / "out" / f"{folder.name}-channels.png").stat().st_size > 10_000
    answer = sonolube("lab", "show", folder, "--json").answer
    assert (answer["samples"], answer["gaps"], answer["events"][0]["kind"]) == (40, 1, "gap")


def test_recover_completes_killed_runs_and_leaves_others(tmp_path: Path, sonolube: Program) -> None:
    killed, whole = unfinished(tmp_path), recorded(tmp_path)
    run = sonolube("lab", "recover", tmp_path)
    assert run.out.startswith(f"1 of 2 runs recovered\n  {killed.name}: interrupted, 30 samples\n")
    assert sonolube("lab", "recover", whole).out == "0 of 1 runs recovered\n"
    assert "holds no run" in sonolube("lab", "recover", whole / "raw").refusal


def test_recover_drops_raw_blocks_that_the_recording_holds(tmp_path: Path, sonolube: Program) -> None:
    whole = recorded(tmp_path)
    before = sonolube("lab", "show", whole, "--json").answer["samples"]
    assert list((whole / "raw").iterdir())
    assert sonolube("lab", "recover", whole, "--drop-blocks").code == 0
    assert not list((whole / "raw").iterdir())
    assert sonolube("lab", "show", whole, "--json").answer["samples"] == before


def test_facts_of_a_run_are_kept_with_it(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    (tmp_path / "short.toml").write_text(SHORT)
    words = ("lab", "run", tmp_path / "short.toml", "--rig", rigs / "power_map.toml", "--out", tmp_path / "runs")
    ran = sonolube(*words, "--fact", "operator=Jo", "--fact", "humidity=0.4", "--json").answer
    shown = sonolube("lab", "show", ran["folder"]).out
    assert "Jo" in shown
    assert "0.4" in shown


def test_recover_completes_a_run_that_is_named_itself(tmp_path: Path, sonolube: Program) -> None:
    killed = unfinished(tmp_path)
    assert sonolube("lab", "recover", killed).out.startswith("1 of 1 runs recovered\n")
    assert sonolube("lab", "show", killed, "--json").answer["outcome"] == "interrupted"


def test_a_run_at_work_is_told_beside_those_recovered(tmp_path: Path, sonolube: Program) -> None:
    unfinished(tmp_path)
    recorder = begun(tmp_path)
    run = sonolube("lab", "recover", tmp_path)
    assert (run.code, run.err.count("\n")) == (1, 1)
    assert "another run is at work" in run.err
    recorder.finish("completed")


def test_export_writes_what_measure_reads(tmp_path: Path, sonolube: Program) -> None:
    folder = run_of(tmp_path)
    for file_format, ending in (("netcdf", "nc"), ("tdms", "tdms"), ("csv", "csv")):
        answer = sonolube("lab", "export", folder, "--format", file_format, "--out", tmp_path / "out", "--json").answer
        assert answer["files"] == [str(tmp_path / "out" / f"{folder.name}.{ending}")]
    exported = sonolube("measure", "friction", tmp_path / "out", "--json").answer
    own = sonolube("measure", "friction", folder, "--json").answer
    assert len(exported["results"]) == 3
    assert len(own["results"]) == 1


def test_a_query_stands_for_a_table_of_runs(tmp_path: Path, sonolube: Program) -> None:
    run_of(tmp_path, levels={0.0: 1.0, 10.0: 0.6, 20.0: 0.3})
    query = f"catalogue:in={tmp_path},material=brass"
    answer = sonolube("compare", RIG, "--model", "kinematic", "--runs", query, "--json").answer
    assert answer["runs"]["runs"] == 2
    missing = sonolube("compare", RIG, "--model", "kinematic", "--runs", query.replace("brass", "gold")).refusal
    assert "finds none of 1 runs" in missing


def test_own_runs_stand_among_the_studies_of_the_literature_by_a_query(tmp_path: Path, sonolube: Program) -> None:
    folder = run_of(tmp_path, levels={0.0: 1.0, 10.0: 0.6}, nominal_area=1e-6)
    query = f"catalogue:in={tmp_path},material=brass"
    answer = sonolube("literature", "--table", query, "--out", tmp_path / "out", "--json").answer
    (point,) = answer["table"]
    assert (point["label"], point["sliding_speed"]) == ("Voltage steps", [0.02, 0.02])
    assert point["friction_reduction"] == approx(0.4, abs=0.02)
    assert point["nominal_pressure"] == approx(5e6)
    assert folder.is_dir()
    missing = sonolube("literature", "--table", query.replace("brass", "gold"), "--out", tmp_path / "out").refusal
    assert "finds none of 1 runs" in missing
