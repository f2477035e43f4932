"""Values, columns, tables and datasets of sheets: what a reader sees of known numbers."""

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.charts import Axis, Chart, Line, one_panel
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.rotation import DiscRotation
from sonolube.report.measured.sheet import (
    Column,
    Sheet,
    Table,
    Value,
    attempted,
    captioned,
    field_value,
    joined,
    quantity_columns,
    quantity_value,
    rig_entries,
    sheet_blocks,
    sheets_dataset,
)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (Value("x", "X", 0.0123456, "N"), "12.35 mN"),  # four digits without uncertainty
        (Value("x", "X", 0.0123456, "N", uncertainty=0.0), "12.35 ± 0 mN"),
        (Value("x", "X", 0.0123456, "N", uncertainty=0.00123), "12.3 ± 1.2 mN"),
        (Value("x", "X", 0.0123456, "N", uncertainty=0.5), "12.3 ± 500 mN"),
        (Value("x", "X", 12.3456789, "N", uncertainty=0.000123), "12.34568 ± 0.00012 N"),
        (Value("x", "X", 12.3456789123, "N", uncertainty=1e-12), "12.345679 ± 1e-12 N"),  # eight digits at most
        (Value("x", "X", 2500.0, "N", interval=(2400.0, 2612.34)), "2.50 kN (2.40 to 2.62)"),
        (Value("x", "X", 0.25, "", interval=(0.2, 0.3)), "0.25 (0.20 to 0.30)"),
        (
            Value("series_frequency", "f", 19999.982, "Hz", interval=(19999.966, 20000.013)),
            "19.99998 kHz (19.99996 to 20.00002)",
        ),
        (Value("x", "X", np.radians(2.0), "rad", interval=(np.radians(1.5), np.radians(2.5))), "2.0 deg (1.5 to 2.5)"),
        (Value("x", "X", np.radians(2.0), "rad", uncertainty=np.radians(0.3)), "2 ± 0.3 deg"),
        (Value("x", "X", 0.0, "N", interval=(-0.02, 0.03)), "0.00 N (-0.02 to 0.03)"),
        (Value("x", "X", 0.25, "", uncertainty=0.01), "0.25 ± 0.01"),
        (Value("x", "X", 0.0, "N", uncertainty=0.01), "0 ± 0.01 N"),
        (Value("x", "X", float("nan"), "N", uncertainty=0.01), "not known"),
        (Value("x", "X", -3.0, "V"), "-3 V"),
        (Value("wear_rate", "W", 2.57e-11, "m2", uncertainty=1.2e-12), "0.0257 ± 0.0012 mm3/m"),
        (Value("wear_rate", "W", 2.5e-6, "m"), "2.5 um"),  # of another unit than the vocabulary's
    ],
)
def test_a_value_has_the_digits_that_its_uncertainty_leaves_a_meaning(value: Value, text: str) -> None:
    assert value.text == text


def test_cells_of_a_column_have_one_prefix_and_none_are_empty() -> None:
    column = Column("length", "Length", "m")
    assert column.texts([0.5e-6, None, 2.5e-6, float("nan"), "all"]) == ["0.5 um", "", "2.5 um", "", "all"]
    assert Column("count", "Count").texts([3, 4.0]) == ["3", "4"]


def part(number: float) -> Sheet:
    return Sheet(
        title="part",
        source={"a": "1"},
        values=(Value("x", "X", number, "N"),),
        tables=(Table("t", "T", (Column("c", "C"),), ((number,),)),),
        caveats=(f"caveat {number:g}",),
        not_found=(f"reason {number:g}",),
        rig_entries={f"key{number:g}": "text"},
    )


def test_parts_are_joined_in_their_order_and_origins_without_text_left_out() -> None:
    whole = joined([part(1), part(2)], title="file", source={"format": "CSV", "title": "", "field": "2 mm"})
    assert whole.title == "file"
    assert whole.source == {"format": "CSV", "field": "2 mm"}
    assert whole.size() == {"field": "2 mm"}
    assert [value.value for value in whole.values] == [1, 2]
    assert [table.rows for table in whole.tables] == [((1,),), ((2,),)]
    assert whole.caveats == ("caveat 1", "caveat 2")
    assert whole.not_found == ("reason 1", "reason 2")
    assert whole.rig_entries == {"key1": "text", "key2": "text"}


def test_an_analysis_that_is_not_possible_leaves_its_reason_and_a_defect_is_not_hidden() -> None:
    def refusing() -> Sheet:
        raise InvalidInput("too few")

    assert attempted(refusing, what="summits").not_found == ("summits: too few",)
    assert attempted(lambda: part(3), what="summits").values[0].value == 3
    with raises(ZeroDivisionError):
        attempted(lambda: part(1 / 0), what="summits")


def test_a_captioned_chart_is_a_figure_of_it() -> None:
    @captioned("Curve", "A line.")
    def curve(x: np.ndarray, *, factor: float) -> Chart:
        return one_panel(Axis("x"), Axis("y"), (Line(x=x, y=factor * x),), size=(3.0, 2.0))

    figure = curve(np.arange(3.0), factor=2.0)
    assert (figure.title, figure.drawing.caption) == ("Curve", "A line.")
    assert figure.drawing.chart is not None
    (line,) = figure.drawing.chart().panels[0].parts
    assert isinstance(line, Line)
    assert line.y.tolist() == [0, 2, 4]


def test_values_of_records_and_quantities_take_unit_and_label_of_the_vocabulary() -> None:
    load = quantity_value("normal_load", 3.0, uncertainty=0.1)
    assert (load.name, load.unit, load.uncertainty, load.interval) == ("normal_load", "N", 0.1, None)
    assert load.label
    assert quantity_value("normal_load", 3.0, label="Load", interval=(1.0, 4.0)).label == "Load"
    rotation = DiscRotation(
        time=np.zeros(2), revolutions=np.zeros(2), interpolated=np.zeros(2, bool), rotation_speed=np.ones(1),
        sliding_speed=np.ones(1), mean_rotation_speed=1.5, rotation_speed_uncertainty=0.25,
    )  # fmt: skip
    mean = field_value(rotation, "mean_rotation_speed", "Mean", "1/s")
    assert (mean.value, mean.label, mean.unit, mean.uncertainty) == (1.5, "Mean", "1/s", None)
    own = field_value(rotation, "rotation_speed")
    assert (own.unit, own.uncertainty, own.interval) == ("1/s", 0.25, None)
    assert own.label
    assert field_value(rotation, "mean_rotation_speed").unit == ""
    assert rig_entries("contact", {"normal_load": 3.0}) == {"contact.normal_load": "3 N"}
    assert quantity_columns({"normal_load": "Load"}) == (Column("normal_load", "Load", "N"),)


def test_a_sheet_in_text_has_title_size_values_tables_and_reasons() -> None:
    whole = joined([part(1)], title="file", source={"field": "2 mm", "sha256": "0"})
    blocks = sheet_blocks(whole)
    assert blocks[:2] == ["file", "  field: 2 mm"]
    assert blocks[2].rows == [("X", "1 N")]  # type: ignore[union-attr]
    assert blocks[3:5] == ["", "  T"]
    assert blocks[-1] == "  not found: reason 1"


def two_sheets() -> list[Sheet]:
    first = Sheet(
        title="a",
        source={"lateral unit": "mm"},
        values=(Value("x", "X", 1.0, "N", uncertainty=0.5), Value("y", "Y", 3.0, "", interval=(2.0, 5.0))),
        tables=(Table("t", "T", (Column("c", "C", "m"), Column("w", "W")), ((7.0, "up"), (None, None))),),
        not_found=("nothing",),
    )
    return [first, Sheet(title="b", values=(Value("x", "X", 9.0, "N"),))]


def test_a_dataset_of_several_sheets_is_labelled_and_nan_where_a_sheet_lacks_a_value() -> None:
    data = sheets_dataset(two_sheets())
    assert data["sheet"].values.tolist() == ["a", "b"]
    assert data["x"].values.tolist() == [1, 9]
    assert data["x"].attrs == {"units": "N", "long_name": "X"}
    assert data["x_uncertainty"].values == approx([0.5, np.nan], nan_ok=True)
    assert data["x_uncertainty"].attrs["long_name"] == "Standard uncertainty: X"
    assert data["y"].attrs["units"] == "1"
    assert data["y_lower"].values[0] == 2.0
    assert data["y_upper"].values[0] == 5.0
    assert data["t_c"].dims == ("t",)
    assert data["t_c"].values == approx([7.0, np.nan], nan_ok=True)
    assert data["t_c"].attrs == {"units": "m", "long_name": "C"}
    assert data["t_w"].values.tolist() == ["up", ""]
    assert data["t_sheet"].values.tolist() == ["a", "a"]
    assert data["source_lateral_unit"].values.tolist() == ["mm", ""]
    assert data.attrs["not_found"] == "a: nothing"


def test_a_dataset_of_one_sheet_has_scalars() -> None:
    data = sheets_dataset(two_sheets()[:1])
    assert data["x"].shape == ()
    assert float(data["y"]) == 3.0
    assert str(data["sheet"].values) == "a"
