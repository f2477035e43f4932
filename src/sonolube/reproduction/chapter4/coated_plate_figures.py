"""Section 4.1.2 and appendix B, coated steel: figure of the map of friction reduction over sliding speed and power."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

from sonolube.charts import draw_chart
from sonolube.design import map_chart, velocity_power_map
from sonolube.facts.published import si_value
from sonolube.figure import ReportFigure
from sonolube.reproduction.chapter4.maps import power_maps
from sonolube.reproduction.tribometer_rigs import IDENTIFIED_NOTE, plate_rig
from sonolube.rig.driven_rig import DrivenRig
from sonolube.validation.contacts import RMS_OVER_ARITHMETIC_MEAN

if TYPE_CHECKING:
    import xarray as xr


def coated_plate_figures() -> Iterator[ReportFigure]:
    """Figure of the maps on coated steel."""
    yield ReportFigure(
        name="figures-4-12-b-coated-power-maps",
        title="Friction reduction over sliding speed and power on coated steel",
        caption="As D figure 4.12 and the maps of appendix B on coated steel, by the multi-scale model, for all seven "
        "loads. Of the coating only roughness, thickness and hardness are printed: the contact is that of the uncoated "
        "plate with the roughness of the coating, 1.73 µm read as R_a. Its modulus is left out: in this contact it "
        "changes the separation, not the reduction; the coating's own compliance would. The reduction is up to 1.2 "
        "percentage points less than on uncoated steel; in D it is greater at low voltages, and at higher ones less at "
        f"low speeds and greater at high ones. {IDENTIFIED_NOTE}.",
        draw=lambda: draw_chart(map_chart(coated_power_maps())),
    )


def coated_plate_rig() -> DrivenRig:
    """Tribometer with the coated steel plates of section 4.1: the roughness of the coating on steel."""
    rig = plate_rig()
    height = RMS_OVER_ARITHMETIC_MEAN * si_value("4.1.3-roughness-coated")
    rough = replace(rig.contact.roughness, rms_height=height)
    return replace(
        rig,
        title="Tribometer with coated steel plates",
        contact=replace(rig.contact, roughness=rough),
        friction_coefficient=si_value("4.1.3-friction-coated-last"),  # a coefficient: erratum E18
    )


@cache
def coated_power_maps() -> "xr.Dataset":
    """Friction reduction on coated steel over the speeds, powers and loads of the maps on uncoated steel."""
    uncoated = power_maps()
    return velocity_power_map(
        coated_plate_rig(),
        sliding_speed=uncoated["sliding_speed"].values,
        voltage_peak_to_peak=uncoated["voltage_peak_to_peak"].values,
        normal_load=uncoated["normal_load"].values,
    )
