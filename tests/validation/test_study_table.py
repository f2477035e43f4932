"""Earlier studies as a table: written in the columns of runs, read again, extended by own ones, drawn on the map."""

import csv
import io
from pathlib import Path

import pytest
from pytest import approx

from sonolube.charts import Note, Points
from sonolube.errors import InvalidInput, UnknownName
from sonolube.measurement.measured_runs import read_runs
from sonolube.validation.previous_study_map import STUDY_COLUMNS, StudyPoint, studies_of_runs, study_chart, study_table

OWN = "study,direction,sliding_speed [mm/s],normal_load [N],nominal_area [mm2],friction_ratio,source\n{}\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "studies.csv"
    path.write_text(text)
    return path


def read_studies(path: Path) -> tuple[tuple[StudyPoint, ...], tuple[str, ...]]:
    return studies_of_runs(read_runs(path), title=str(path))


def test_the_table_of_the_package_reads_as_runs_with_a_source_for_each_point(tmp_path: Path) -> None:
    runs = read_runs(written(tmp_path, study_table()))
    assert len(STUDY_COLUMNS) == 14
    assert all(str(source) for source in runs["source"].to_numpy())
    places = {str(study): place for place, study in enumerate(runs["study"].to_numpy())}
    gutowski = runs.isel(run=places["Gutowski and Leus"])
    assert float(gutowski["friction_reduction"]) == approx(0.9)
    assert float(gutowski["nominal_pressure"]) == approx(31e3)
    fast = runs.isel(run=places["Dong 2015, A-3"])  # D Table 2.3: 1.472 N to 1.041 N at 87 mm/s
    assert float(fast["friction_reduction"]) == approx(1 - 1.041 / 1.472, abs=1e-6)
    assert float(fast["sliding_speed"]) == approx(0.087)


def test_an_extended_table_adds_its_own_points_only(tmp_path: Path) -> None:
    assert read_studies(written(tmp_path, study_table())) == ((), ())
    cells = {
        "study": "Mine",
        "direction": "transverse",
        "sliding_speed": "50",
        "friction_reduction": "40",
        "source": "p. 3",
    }
    row = ",".join(cells.get(column.name, "") for column in STUDY_COLUMNS)
    (point,), _ = read_studies(written(tmp_path, f"{study_table()}{row}\n"))
    assert (point.label, point.direction) == ("Mine", "transverse")
    assert point.friction_reduction == approx(0.4)


def test_a_load_on_an_area_places_a_point_on_the_map_within_a_ring(tmp_path: Path) -> None:
    rows = 'Mine,transverse,50,10,4,0.6,"notebook, p. 3"\nElsewhere,,,,,0.3,"notebook, p. 4"'
    points, _ = read_studies(written(tmp_path, OWN.format(rows)))
    assert points[0].nominal_pressure == approx(2.5e6)
    aside, known = study_chart(others=points).panels
    (own,) = (part for part in known.parts if isinstance(part, Points) and part.label == "own table")
    assert float(own.y[0]) == approx(2.5e6)
    assert any(isinstance(part, Note) and "Elsewhere" in part.text for part in aside.parts)
    sources = [source for part in known.parts if isinstance(part, Points) for source in part.sources]
    assert "Mine: notebook, p. 3" in sources


@pytest.mark.parametrize(
    ("row", "error", "message"),
    [
        ("Mine,transverse,50,10,4,0.6,", InvalidInput, "every point needs a source: run 1 names none"),
        (",transverse,50,10,4,0.6,p. 3", InvalidInput, "every point needs a study: run 1 names none"),
        ("Mine,sideways,50,10,4,0.6,p. 3", UnknownName, "sideways"),
        ("Mine,transverse,50,10,4,,p. 3", InvalidInput, "no run has a result yet"),
    ],
)
def test_points_without_a_source_or_a_number_are_refused_in_one_line(
    tmp_path: Path, row: str, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message) as refusal:
        read_studies(written(tmp_path, OWN.format(row)))
    assert "\n" not in str(refusal.value)


def rows_of_the_package() -> dict[str, dict[str, str]]:
    rows = list(csv.reader(io.StringIO(study_table())))
    names = [column.name for column in STUDY_COLUMNS]
    return {row[names.index("study")]: dict(zip(names, row, strict=True)) for row in rows[1:]}


def test_cells_are_in_the_units_of_their_headings_and_empty_where_nothing_is_printed() -> None:
    rows = rows_of_the_package()
    fast = rows["Dong 2015, A-3"]  # D Table 2.3: 87 mm/s, 3 N, 2.5 um, 22 kHz
    headings = dict(
        zip([column.name for column in STUDY_COLUMNS], study_table().split("\n")[0].split(","), strict=True)
    )
    assert headings["sliding_speed"] == "sliding_speed [mm/s]"
    assert float(fast["sliding_speed"]) == approx(87)
    assert float(fast["normal_load"]) == approx(3)
    assert float(fast["friction_reduction"]) == approx(100 * (1 - 1.041 / 1.472), rel=1e-4)
    assert fast["nominal_pressure"] == fast["lowest_speed"] == ""
    assert fast["source"] == "D, steel on aluminium, three speeds (Table 2.3)"
    littmann = rows["Littmann et al."]
    assert (float(littmann["lowest_speed"]), float(littmann["sliding_speed"])) == (0.0, 500.0)
    assert littmann["source"].startswith("D 1.3.1, its references ")
    assert rows["Dong 2015, D-1"]["friction_reduction_uncertainty"] == ""
    assert sum(name.startswith("Dong 2015, ") for name in rows) == 17


def test_a_stated_pressure_goes_before_load_over_area_and_a_range_has_two_speeds(tmp_path: Path) -> None:
    head = (
        "study,direction,lowest_speed [mm/s],sliding_speed [mm/s],normal_load [N],nominal_area [mm2],"
        "nominal_pressure [MPa],friction_ratio,source\n"
    )
    rows = "Mine,transverse,20,50,10,4,7,0.6,p. 3\nMine,transverse,,50,10,4,,0.5,p. 3\n"
    (ranged, single), _ = read_studies(written(tmp_path, head + rows))
    assert ranged.sliding_speed == approx((0.02, 0.05))
    assert ranged.nominal_pressure == approx(7e6)
    assert ranged.source == "p. 3"
    assert single.sliding_speed == approx((0.05, 0.05))
    assert single.nominal_pressure == approx(2.5e6)


def test_a_point_of_the_package_is_left_out_and_the_same_study_with_another_reduction_is_not(tmp_path: Path) -> None:
    head = "study,direction,sliding_speed [mm/s],friction_ratio,source\n"
    rows = "Gutowski and Leus,longitudinal,0.62,0.1,D\nGutowski and Leus,longitudinal,0.62,0.3,own reading\n"
    points, _ = read_studies(written(tmp_path, head + rows))
    assert [point.friction_reduction for point in points] == approx([0.7])
