"""Lists that repeat a table, because a type or a lower room needs them spelled out, name all that the table has."""

import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Literal, cast, get_args, get_origin

import pytest

from sonolube.browser.answers import offered_tasks
from sonolube.cli.console.options import AmplitudeSource as TypedSource, FigureStyleName
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import PROMPT_DURATIONS, Limits, Metadata, Prompt, protocol_from
from sonolube.facts.protocol.step import LANES, Waveform
from sonolube.figure import FIGURE_STYLES
from sonolube.identification.stack_fit import RESIDUALS
from sonolube.laboratory import devices
from sonolube.laboratory.devices import Devices
from sonolube.laboratory.drivers import driver_table, function_generator
from sonolube.laboratory.interlocks import RunLimits, interlocks_for
from sonolube.laboratory.records import observation
from sonolube.laboratory.records.recording_files import EXPORT_FORMATS
from sonolube.laboratory.records.run_folder import read_run_facts
from sonolube.laboratory.records.set_point_steps import SET_POINT_CHANNELS
from sonolube.laboratory.run_plan import RunRequest, begin_record
from sonolube.measurement import recorded_conditions
from sonolube.models.dynamics.waveform import RAMP_SHAPES, WAVEFORMS
from sonolube.rig.file.sections import DriveSection
from sonolube.rig.record import AmplitudeSource
from sonolube.tasks.design import optimise
from sonolube.tasks.lab.protocol_run import virtual
from sonolube.tasks.lab.run_folders import export
from sonolube.tasks.measure.spectra import impedance
from sonolube.tasks.table import TASKS


def words(annotation: Any) -> set[str]:
    """Words of the literal types within an annotation."""
    if get_origin(annotation) is Literal:
        return set(get_args(annotation))
    return {word for part in get_args(annotation) for word in words(part)}


def choices(function: Callable[..., Any], name: str) -> set[str]:
    """Words that an argument of a task takes."""
    return words(inspect.signature(function).parameters[name].annotation)


LISTS: Mapping[str, tuple[set[str], set[str]]] = {
    "shapes of a ramp of a rig": (words(DriveSection.model_fields["ramp_shape"].annotation), {*RAMP_SHAPES}),
    "waveforms of a rig": (words(DriveSection.model_fields["waveform"].annotation), {*WAVEFORMS, "sampled"}),
    "waveforms of a step": ({*get_args(Waveform)}, {*devices.WAVEFORMS}),
    "waveforms of a generator": ({*function_generator._FUNCTIONS}, {*devices.WAVEFORMS}),
    "waveforms of designs": ({*optimise._WAVEFORMS}, {*WAVEFORMS}),
    "durations of prompts": ({*PROMPT_DURATIONS}, words(Prompt.model_fields["task"].annotation)),
    "sources of the amplitude on a terminal": ({*get_args(TypedSource)}, {*get_args(AmplitudeSource)}),
    "styles of figures on a terminal": ({*get_args(FigureStyleName)}, {*FIGURE_STYLES}),
    "formats of an export": (choices(export, "file_format"), {*EXPORT_FORMATS}),
    "formats of a virtual run": (choices(virtual, "file_format"), {*EXPORT_FORMATS}),
    "residuals of an impedance fit": (choices(impedance, "residual"), {*RESIDUALS}),
    "notes with set points that an observer follows": ({*observation._SET_POINTS}, {*map(str, LANES)} - {"record"}),
    "sections of a device map": (
        {*driver_table.MapEntries.model_fields} - {"title", "acquisitions"},
        {*driver_table.DRIVERS},
    ),
    "set points of conditions and drive": (
        {*recorded_conditions._SETTINGS, "voltage_peak_to_peak_set", "frequency_set"},
        {*SET_POINT_CHANNELS},
    ),
}


@pytest.mark.parametrize("name", LISTS)
def test_a_list_that_repeats_a_table_has_all_of_it(name: str) -> None:
    listed, table = LISTS[name]
    assert listed == table


@pytest.mark.parametrize("name", [name for name in Limits.model_fields if name != "duration_maximum"])
def test_every_limit_of_a_protocol_is_watched_or_refused_where_no_channel_can(name: str) -> None:
    given = {"voltage_maximum": "10 V", "duration_maximum": "1 s"} | {name: _limit(name)}
    step = {"kind": "wait", "duration": "1 s"}
    limits = protocol_from({"title": "a", "source": "b", "limits": given, "steps": [step]}).limits
    if name == "voltage_maximum":  # which the set points are held to
        assert interlocks_for(limits, {}, None) == ()
        return
    with pytest.raises(InvalidInput, match=f"limits.{name}"):
        interlocks_for(limits, {}, None)


def _limit(name: str) -> str:
    """Limit of one of its SI unit."""
    form = Limits.model_json_schema()["properties"][name]
    units = [each["x-si-unit"] for each in (form, *form.get("anyOf", ())) if "x-si-unit" in each]
    return f"10 {units[0]}"


def test_every_entry_of_the_metadata_of_a_protocol_is_a_fact_of_its_run(tmp_path: Path) -> None:
    given = {
        name: 3 if int in get_args(field.annotation) else f"{name} of the test"
        for name, field in Metadata.model_fields.items()
    }
    given |= {"normal_load": "3 N", "groove_diameter": "28 mm", "thermocouple": "contact"}
    content = {"title": "a", "source": "b", "limits": {"voltage_maximum": "1 V", "duration_maximum": "1 s"}}
    protocol = protocol_from(content | {"metadata": given, "steps": [{"kind": "wait", "duration": "1 s"}]})
    stand_in = SimpleNamespace(switch_off=None, simulated=False, description={}, channels={}, groove_diameter=0.05)
    request = RunRequest(protocol=protocol, name="a", rig=None)
    limits = RunLimits(stated=protocol.limits, locks=(), off=(), drive=None)
    recorder = begin_record(request, cast(Devices, stand_in), limits, out=tmp_path)
    known = read_run_facts(recorder.folder).facts
    recorder.finish("completed")
    of_bodies = {"pin_material", "disc_material"}  # which a run without a rig has in its protocol
    assert {*known} >= {*Metadata.model_fields} - of_bodies
    assert known["operator"] == "operator of the test"
    assert known["normal_load"] == pytest.approx(3.0)
    assert known["groove_diameter"] == pytest.approx(0.028)


OPENING = ("ready_devices", "first_readings", "run_and_record", "read_device_map")
"""Functions by which tasks come to devices."""


def test_a_page_may_call_no_task_whose_module_comes_to_devices() -> None:
    modules = {task.name: inspect.getmodule(inspect.unwrap(task.function)) for task in TASKS}
    opening = {name for name, module in modules.items() if any(hasattr(module, each) for each in OPENING)}
    assert opening >= {"lab run", "lab hold", "lab check"}
    assert {task.name for task in offered_tasks()} & opening == set()
