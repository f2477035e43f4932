"""Axial mode of a stepped horn

A stepped titanium horn in its first axial mode, coloured by displacement: the thin end moves most, and the node
lies near the step.
"""

from sonolube.facts.materials import material
from sonolube.figure import publication_style
from sonolube.models import fem
from sonolube.models.fem.results.figures import mode_figure, shaped_surface

horn = fem.stepped_horn(radius=20e-3, end_radius=11.3e-3, length=0.0598, end_length=0.0634, edge_radius=8e-3)
mesh = fem.generate_mesh(horn, element_size=12e-3)
model = fem.Model(
    mesh=mesh, media={name: fem.medium_from_material(material("titanium_6al4v")) for name in mesh.regions}
)
modes = fem.natural_modes(model, count=12)
names = fem.mode_names(model, modes, axis="z")
row = names.index("axial 1")
with publication_style():
    title = f"axial 1, {1e-3 * modes.natural_frequency[row]:.1f} kHz"
    figure = mode_figure(shaped_surface(mesh, modes.shapes[row]), title=title)

if __name__ == "__main__":
    figure.savefig("mode-of-a-horn.png", dpi=150)
