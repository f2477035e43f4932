"""Tasks `horn face` and `horn design`: friction along the face of a Poisson horn, and a horn tuned by its length.

The face of a Poisson horn has transition and motor regions (D 2.1); a tuned horn has its gain, node, stress and
neighbouring modes.
"""

from collections.abc import Mapping, Sequence
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Unpack

import numpy as np

from sonolube.design.horns.face import FaceFriction, HornFace, face_friction_chart, transition_region
from sonolube.design.horns.profile import HornProfile, horn_drawing, horn_notes, horn_profile, profile_dxf
from sonolube.design.horns.shapes import TunableBody, body_from_geometry, horn_body
from sonolube.design.horns.tuning import HornDesign, face_motion, horn_axis_chart, section_motion, tuned_horn
from sonolube.errors import InvalidInput
from sonolube.facts import materials
from sonolube.facts.materials import Material
from sonolube.models.fem import generate_mesh, medium_from_material, step_text
from sonolube.models.fem.results.figures import mode_figure, shaped_surface
from sonolube.models.fem.results.mode_surfaces import SurfaceModes, surface_modes
from sonolube.models.fem.results.part_modes import frequency_text, longest_axis
from sonolube.report import Drawing
from sonolube.report.results.parts import horns as results
from sonolube.studies import study_horn_face
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.files import InputFile
from sonolube.tasks.parameters import File, KeyValues, Number, Parameter, Quantity, Watched
from sonolube.tasks.parts.named_parts import Axis, PartSizes, is_step, part_name, step_part
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.text.units import to_si

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@task
def face(
    horn: Annotated[str, Parameter("Material of the horn: aluminium or steel.", "HORN")],
    *,
    frequency: Annotated[Number, Quantity("Of the drive on the horn's end.", "frequency")] = "20kHz",
    amplitude: Annotated[Number, Quantity("Of the driven end, zero to peak.", "vibration_amplitude")] = "8.5um",
    sliding_speed: Annotated[Number, Quantity("Of the block towards the node.", "sliding_speed")] = "5mm/s",
    **watch: Unpack[Watched],
) -> "FaceAnswer":
    """Friction of a block along the face of a Poisson horn: its transition and motor regions.

    Example: sonolube horn face aluminium

    Examples
    --------
    >>> import sonolube as sl
    >>> ratio = sl.horn.face("aluminium")["friction_ratio"]
    >>> round(float(ratio.min()), 2), round(float(ratio.max()), 2)  # negative where the horn drives the block
    (-0.35, 0.68)
    """
    at, height, speed = _positive(frequency=frequency, amplitude=amplitude, sliding_speed=sliding_speed)
    modelled = study_horn_face(horn)
    with stage("solving"):
        found = modelled.friction(frequency=at, axial_amplitude=height, sliding_speed=speed)
    return FaceAnswer(horn=horn, face=modelled, friction=found)


def _positive(**given: Number) -> list[float]:
    """Values in SI of arguments that must be positive."""
    values = {name: in_si(name, value) for name, value in given.items()}
    for name, value in values.items():
        if not value > 0:
            raise InvalidInput(f"{shown(name)} must be positive")
    return list(values.values())


@answer
class FaceAnswer(Answer):
    """Friction along the face of a Poisson horn, and its regions beside those measured."""

    horn: str
    face: HornFace
    friction: FaceFriction

    def blocks(self) -> Sequence[Block]:
        """Node, regions, and the greatest motor force."""
        return results.face_blocks(self.horn, self.face, self.friction)

    def object(self) -> dict[str, Any]:
        """Node, limits of the transition region computed and measured, least friction ratio."""
        return results.face_object(self.horn, self.face, self.friction)

    def caveats(self) -> Sequence[str]:
        """A side of the face that drives nowhere."""
        if not any(map(isnan, transition_region(self.friction))):
            return ()
        return ("the face does not drive the block on a side: its transition region reaches the end of the face there",)

    def assumptions(self) -> Mapping[str, str]:
        """Shape, contact and loss that D does not print."""
        return self.face.assumptions

    def figures(self) -> Mapping[str, Drawing]:
        """Friction over the position on the face."""
        return {
            f"horn-{self.horn}-face": Drawing(chart=lambda: face_friction_chart(self.horn, self.face, self.friction))
        }

    def files(self) -> Mapping[str, Dataset]:
        """Friction ratio over the position as netCDF."""
        import xarray as xr

        data = {"friction_ratio": ("position", self.friction.ratio, {"units": "1"})}
        coordinates = {"position": ("position", self.friction.position, {"units": "m"})}
        return {f"horn-{self.horn}-face.nc": xr.Dataset(data, coordinates, {"title": f"Face of the {self.horn} horn"})}


_COARSE = 0.02  # m, fine enough to show the longest axis of most parts
_SHARP = 0.2  # change of the peak stress from mesh to mesh above which it is a caveat


@task
def design(
    part: Annotated[
        InputFile,
        File("block, booster, conical_horn, cylinder, exponential_horn, stepped_horn, or a STEP file.", "PART"),
    ] = "stepped_horn",
    *,
    frequency: Annotated[Number, Quantity("Frequency of the tuned mode, such as 20kHz.", "frequency")],
    material: Annotated[str, Parameter("Material of the horn.", "NAME")],
    sizes: Annotated[
        PartSizes | None, KeyValues("A size, such as radius=20mm; others are chosen.", "SIZE=VALUE", option="--set")
    ] = None,
    gain: Annotated[
        Number | None, Quantity("Displacement gain by which the radius of the working end is chosen.", "", kind="RATIO")
    ] = None,
    tune: Annotated[str, Parameter("Length that is tuned.", "SIZE")] = "length",
    mode: Annotated[str, Parameter("Mode that is tuned.", "NAME")] = "axial 1",
    axis: Annotated[Axis | None, Parameter("Axis of the part of a STEP file; its longest by default.")] = None,
    tool_mass: Annotated[Number, Quantity("Of a tool on the working face.", "tool_mass")] = "10g",
    amplitude: Annotated[
        Number | None, Quantity("Of the working face, for the peak stress at it, such as 20um.", "vibration_amplitude")
    ] = None,
    tolerance: Annotated[Number, Quantity("Largest relative error of the frequency.", "", kind="RATIO")] = 0.003,
    **watch: Unpack[Watched],
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
        return results.horn_blocks(
            self.design, self.material, tool_mass=self.tool_mass, vibration_amplitude=self.amplitude
        )

    def object(self) -> dict[str, Any]:
        """Sizes, frequency, quantities of the mode, amplitudes allowed and neighbouring modes."""
        return results.horn_object(
            self.design, self.material, tool_mass=self.tool_mass, vibration_amplitude=self.amplitude
        )

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

    def surface_modes(self) -> SurfaceModes:
        """Tuned mode, over the mean displacement of the working face, and its neighbours on the surface of the horn."""
        mode, axis = self.design.tuned.mode, self.design.body.axis
        rows = range(mode.modes.rigid_body_count, len(mode.names))
        frequencies = [(mode.names[row], f"{mode.modes.natural_frequency[row]:.0f} Hz") for row in rows]
        tuned = frequency_text(frequency=mode.frequency, relative_error=mode.frequency_error)
        frequencies[mode.row - rows.start] = (mode.names[mode.row], tuned)
        tip = float(np.mean(face_motion(mode.model, mode.displacement, self.design.working_face, axis)))
        return surface_modes(
            mode.model,
            mode.modes.shapes[list(rows)],
            frequencies=frequencies,
            axis=axis,
            references={mode.names[mode.row]: ("the displacement of the working face", tip)},
        )

    def dataset(self) -> Dataset:
        """Quantities of the mode, and its axial displacement over the distance from the driven face."""
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
