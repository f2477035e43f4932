"""Task `horn design`: a horn tuned to a frequency by its length, with gain, node, stress and neighbouring modes."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from sonolube.design.horns.drawing import horn_drawing, horn_notes
from sonolube.design.horns.figure import horn_axis_chart
from sonolube.design.horns.profile import HornProfile, horn_profile, profile_dxf
from sonolube.design.horns.shapes import TunableBody, body_from_geometry, horn_body
from sonolube.design.horns.tuning import (
    HornDesign,
    amplitude_limits,
    face_motion,
    loaded_frequency,
    section_motion,
    tuned_horn,
)
from sonolube.facts import materials
from sonolube.facts.materials import Material
from sonolube.models.fem import generate_mesh, medium_from_material, step_text
from sonolube.models.fem.figures import mode_figure, shaped_surface
from sonolube.models.fem.part_modes import longest_axis
from sonolube.report import Drawing
from sonolube.report.blocks import Block, Rows
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.files import InputFile
from sonolube.tasks.parameters import Number, Parameter, Stop, Watch
from sonolube.tasks.parts.named_parts import Axis, PartSizes, is_step, part_name, step_part
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.units import format_si, to_si

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_COARSE = 0.02  # m, fine enough to show the longest axis of most parts
_SHARP = 0.2  # change of the peak stress from mesh to mesh above which it is a caveat
_NEAREST = 3  # neighbouring modes printed
_LIMITS = {"fatigue_strength": "fatigue limit", "yield_strength": "yield point"}
_QUANTITIES = ("displacement_gain", "node_position", "face_uniformity", "face_asymmetry", "stress_per_displacement")


@task
def design(
    part: Annotated[
        InputFile,
        Parameter(
            help="block, booster, conical_horn, cylinder, exponential_horn, stepped_horn, or a STEP file.",
            kind="PART",
            is_file=True,
        ),
    ] = "stepped_horn",
    *,
    frequency: Annotated[
        Number, Parameter(help="Frequency of the tuned mode, such as 20kHz.", unit="Hz", quantity="frequency")
    ],
    material: Annotated[str, Parameter(help="Material of the horn.", kind="NAME")],
    sizes: Annotated[
        PartSizes | None,
        Parameter(
            help="A size, such as radius=20mm; others are chosen.", kind="SIZE=VALUE", option="--set", is_mapping=True
        ),
    ] = None,
    gain: Annotated[
        Number | None,
        Parameter(help="Displacement gain by which the radius of the working end is chosen.", unit="", kind="RATIO"),
    ] = None,
    tune: Annotated[str, Parameter(help="Length that is tuned.", kind="SIZE")] = "length",
    mode: Annotated[str, Parameter(help="Mode that is tuned.", kind="NAME")] = "axial 1",
    axis: Annotated[Axis | None, Parameter(help="Axis of the part of a STEP file; its longest by default.")] = None,
    tool_mass: Annotated[
        Number, Parameter(help="Of a tool on the working face.", unit="kg", quantity="tool_mass")
    ] = "10g",
    amplitude: Annotated[
        Number | None,
        Parameter(
            help="Of the working face, for the peak stress at it, such as 20um.",
            unit="m",
            quantity="vibration_amplitude",
        ),
    ] = None,
    tolerance: Annotated[
        Number, Parameter(help="Largest relative error of the frequency.", unit="", kind="RATIO")
    ] = 0.003,
    progress: Watch = None,
    cancelled: Stop = None,
) -> "HornAnswer":
    """Tune a horn's length to a frequency, and compute its gain, node, stress, face and neighbouring modes.

    Example: sonolube horn design stepped_horn --frequency 20kHz --material titanium_6al4v --set end_radius=10mm
    """
    if is_step(part):
        refuse_unused("tune", "gain", because="for a STEP file, which is cut off or extended at its far end")
    else:
        refuse_unused("axis", because=f"for {part_name(part)}; it is for STEP files")
    solid, target = materials.material(material), in_si("frequency", frequency)
    body = _body(part, sizes or {}, frequency=target, solid=solid, tune=tune, axis=axis, gain=in_si("gain", gain))
    with stage("tuning") as advance:
        found = tuned_horn(
            body,
            medium=medium_from_material(solid),
            frequency=target,
            mode=mode,
            relative_tolerance=in_si("tolerance", tolerance),
            advance=advance,
        )
    return HornAnswer(
        design=found,
        material=solid,
        tool_mass=in_si("tool_mass", tool_mass),
        amplitude=in_si("amplitude", amplitude),
        name=Path(part_name(part)).stem,
    )


def _body(
    part: InputFile,
    sizes: PartSizes,
    *,
    frequency: float,
    solid: Material,
    tune: str,
    axis: Axis | None,
    gain: float | None,
) -> TunableBody:
    """Horn by its shape and sizes, or of a STEP file."""
    if is_step(part):
        geometry = step_part(part, sizes)
        return body_from_geometry(geometry, axis=axis or longest_axis(generate_mesh(geometry, element_size=_COARSE)))
    lengths = {
        name: to_si(size, unit="m", name=name) if isinstance(size, str) else float(size) for name, size in sizes.items()
    }
    speed = (solid.value("youngs_modulus") / solid.value("density")) ** 0.5
    return horn_body(part_name(part), frequency=frequency, wave_speed=speed, sizes=lengths, tune=tune, gain=gain)


@answer
class HornAnswer(Answer):
    """A tuned horn: length, frequency, gain, node, uniformity of the face, stress, allowed amplitudes, neighbours."""

    design: HornDesign
    material: Material
    tool_mass: float
    amplitude: float | None
    name: str

    def blocks(self) -> Sequence[Block]:
        """Tuned size, frequency and what follows from the mode."""
        design, mode, thin = self.design, self.design.tuned.mode, self.design.body.thin
        sizes = ", ".join(f"{name} {format_si(value, 'm')}" for name, value in design.body.sizes.items())
        near = [f"{name} {at / mode.frequency - 1:+.1%}" for name, at in design.neighbours[:_NEAREST]]
        length = f"{1e3 * design.tuned.length:.2f} mm"
        gain = f"{design.displacement_gain:.2f}"
        if thin is not None:
            length += f"  (thin bar {1e3 * thin.length:.2f} mm)"
            gain += f"  (thin bar {thin.displacement_gain:.2f})"
        error = mode.frequency * mode.frequency_error
        rows = [
            (design.body.tuned_size, length),
            ("total length", f"{1e3 * design.total_length:.2f} mm"),
            ("frequency", f"{mode.frequency:.0f} Hz +-{error:.0f}  {mode.names[mode.row]}"),
            ("trim", f"{1e-3 * design.tuned.frequency_per_length:+.1f} Hz/mm"),
            ("neighbours", ", ".join(near) or "none below"),
            ("gain", gain),
            ("node", f"{1e3 * design.node_position:.1f} mm from the driven face"),
            ("face", f"Umin/Umax {design.face_uniformity:.3f}, asymmetry {design.face_asymmetry:.2g}"),
            ("peak stress", f"{1e-12 * design.stress_per_displacement:.2f} MPa per um of the working face"),
            *self._stress_rows(),
            *((_LIMITS[name], f"{1e6 * value:.0f} um, zero to peak") for name, value in self._amplitudes().items()),
            ("tool", f"{1e3 * self.tool_mass:g} g on the face: {self._loaded() - mode.frequency:+.0f} Hz"),
        ]
        return [f"{design.body.name} of {self.material.name}" + (f": {sizes}" if sizes else ""), Rows(rows)]

    def object(self) -> dict[str, Any]:
        """Sizes, frequency, quantities of the mode, amplitudes allowed and neighbouring modes."""
        design, tuned, thin = self.design, self.design.tuned, self.design.body.thin
        frequency = tuned.mode.frequency
        return {
            "part": design.body.name,
            "material": self.material.name,
            "mode": tuned.mode.names[tuned.mode.row],
            "tuned_size": design.body.tuned_size,
            "thin_bar_length": None if thin is None else {"value": thin.length, "unit": "m"},
            "sizes": si(design.body.sizes, unit="m"),
            **si({name: getattr(tuned, name) for name in ("length", "frequency_per_length")}),
            **si({"total_length": design.total_length}, unit="m"),
            **si({name: getattr(tuned.mode, name) for name in ("frequency", "frequency_error")}),
            **si({name: getattr(design, name) for name in _QUANTITIES}),
            **si({"tool_mass": self.tool_mass, "loaded_frequency": self._loaded()}),
            **si({"stress_change": design.stress_change}, unit=""),
            **(
                {}
                if self.amplitude is None
                else si({"vibration_amplitude": self.amplitude, "peak_stress": self._peak_stress()})
            ),
            "amplitude_limits": si(self._amplitudes(), unit="m"),
            "neighbours": [
                {"name": name, **si({"frequency": at}), **si({"gap": at / frequency - 1}, unit="")}
                for name, at in design.neighbours
            ],
            "nodes": tuned.mode.model.mesh.node_count,
        }

    def caveats(self) -> Sequence[str]:
        """A peak stress that depends on the mesh."""
        if self.design.stress_change <= _SHARP:
            return ()
        return (
            f"the peak stress changed by {self.design.stress_change:.0%} with the last refinement: it has no limit at a"
            f" sharp corner; give the corner an edge_radius, or lower {shown('tolerance')}",
        )

    def figures(self) -> Mapping[str, Drawing]:
        """Profile, motion and stress along the axis, a picture of the mode, and a drawing of a named shape."""
        mode, profile = self.design.tuned.mode, self._profile()
        title = f"{mode.names[mode.row]}, {mode.frequency:.0f} Hz"

        def picture() -> "Figure":
            return mode_figure(shaped_surface(mode.model.mesh, mode.displacement), title=title)

        def drawing() -> "Figure":
            assert profile is not None
            return horn_drawing(profile, notes=horn_notes(self.design, self.material, profile))

        return {
            f"{self.name}-axis": Drawing(chart=lambda: horn_axis_chart(self.design)),
            f"{self.name}-mode": Drawing(draw=picture, forms=("png",)),
            **({} if profile is None else {f"{self.name}-drawing": Drawing(draw=drawing)}),
        }

    def files(self) -> Mapping[str, str]:
        """Tuned solid as STEP, and the half profile of a named shape as DXF."""
        profile = self._profile()
        files = {f"{self.name}-tuned.step": step_text(self.design.geometry)}
        if profile is not None:
            files[f"{self.name}-drawing.dxf"] = profile_dxf(profile, horn_notes(self.design, self.material, profile))
        return files

    def dataset(self) -> "xr.Dataset":
        """Return the quantities of the mode, and its axial displacement over the distance from the driven face."""
        mode, axis = self.design.tuned.mode, self.design.body.axis
        place, displacement = section_motion(mode, axis)
        start = mode.model.mesh.nodes[:, "xyz".index(axis)].min()
        tip = float(np.mean(face_motion(mode.model, mode.displacement, self.design.working_face, axis)))
        about = {"units": "1", "long_name": "Axial displacement over the mean of the working face"}
        along = {"units": "m", "long_name": "Distance from the driven face"}
        return (
            super()
            .dataset()
            .assign(displacement_ratio=("position", displacement / tip, about))
            .assign_coords(position=("position", place - start, along))
        )

    def _profile(self) -> HornProfile | None:
        """Half profile of a named shape."""
        return horn_profile(self.design.body, length=self.design.tuned.length)

    def _stress_rows(self) -> list[tuple[str, str]]:
        """Peak stress at the amplitude that was asked for, beside each strength."""
        if self.amplitude is None:
            return []
        shares = [f"{self.amplitude / at:.0%} of the {_LIMITS[name]}" for name, at in self._amplitudes().items()]
        stress = f"{1e-6 * self._peak_stress():.0f} MPa"
        return [(f"at {1e6 * self.amplitude:g} um", ", ".join([stress, *shares]))]

    def _peak_stress(self) -> float:
        """Peak stress at the amplitude that was asked for. [Pa]"""
        return self.design.stress_per_displacement * (self.amplitude or 0.0)

    def _loaded(self) -> float:
        """Frequency with the tool on the working face."""
        return loaded_frequency(self.design, tool_mass=self.tool_mass)

    def _amplitudes(self) -> Mapping[str, float]:
        """Amplitudes of the working face at which the peak stress reaches fatigue strength and yield strength."""
        return amplitude_limits(self.design, material=self.material)
