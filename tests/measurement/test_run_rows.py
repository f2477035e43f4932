"""Rows of tables of runs: written and read again."""

from pathlib import Path

from hypothesis import given, strategies as st
from pytest import approx
from tests.tiers import examples

from sonolube.measurement.measured_runs import read_runs
from sonolube.measurement.run_rows import rows_of_table, run_rows_csv

sizes = st.floats(1e-6, 1e6)
rows = st.fixed_dictionaries(
    {"friction_force": sizes, "intrinsic_friction_force": sizes},
    optional={"sliding_speed": sizes, "vibration_amplitude": sizes, "normal_load": sizes, "run": st.just("a, b 1")},
)


@examples(40)
@given(given_rows=st.lists(rows, min_size=1, max_size=4))
def test_rows_are_read_as_they_were_written(given_rows: list[dict[str, float | str]]) -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "runs.csv")
        path.write_text(run_rows_csv(given_rows))
        found = rows_of_table(path)
    assert len(found) == len(given_rows)
    for one, other in zip(found, given_rows, strict=True):
        assert one.keys() == other.keys()
        for name, value in other.items():
            assert one[name] == (value if isinstance(value, str) else approx(value, rel=1e-9))


def test_units_are_those_usual_in_tables(tmp_path: Path) -> None:
    text = run_rows_csv([{"sliding_speed": 0.0203, "friction_force": 0.5, "intrinsic_friction_force": 1.0}])
    assert text == "sliding_speed [mm/s],friction_force [N],intrinsic_friction_force [N]\n20.3,0.5,1\n"
    (tmp_path / "runs.csv").write_text(text)
    assert read_runs(tmp_path / "runs.csv")["friction_reduction"].values == approx([0.5])
