"""Figures of finite-element results: deformed mode shapes and electrical impedance spectra."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats
from sonolube.fem.impedance_spectra import SupportedSpectrum
from sonolube.fem.solver.element_order import change_order, transfer_field
from sonolube.fem.solver.mesh import HIGHEST_ORDER, Mesh, face_triangulation
from sonolube.figure import COLOURS, LINES, publication_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODE_COLOURS = "viridis"
"""Colour map of the displacement in pictures of modes."""

_EXAGGERATION = 0.08  # of the part's length, for the largest displacement drawn
_MOST_TRIANGLES = 12_000  # in a picture


def mode_figure(mesh: Mesh, shape: Floats, *, title: str, amplitude: float = 1.0) -> "Figure":
    """Deformed surface of a body in one of its modes, coloured by the magnitude of the displacement.

    Parameters
    ----------
    mesh : Mesh
    shape : ndarray, shape (nodes, 3)
        Displacements of the nodes, of any scale.
    title : str
    amplitude : float
        Displacement drawn over the largest one, -1 to 1.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    mesh, shape = _smooth(mesh, shape)
    patches = np.concatenate([face_triangulation(mesh, face=name) for name in mesh.faces if "|" not in name])
    size = np.linalg.norm(shape, axis=1)
    extent = np.ptp(mesh.nodes, axis=0)
    millimetres = 1e3 * (mesh.nodes + amplitude * shape * _EXAGGERATION * extent.max() / size.max())
    colours = ScalarMappable(norm=Normalize(0, 1), cmap=MODE_COLOURS)
    with publication_style():
        figure = Figure(figsize=(5.2, 4.0))
        axes = figure.add_subplot(projection="3d", computed_zorder=False)
        filled = colours.to_rgba(abs(amplitude) * (size / size.max())[patches].mean(axis=1))
        # Edges of the colour of their face hide the seams between neighbours.
        body = Poly3DCollection(millimetres[patches], facecolors=filled, edgecolors=filled, linewidths=0.3)
        body.set_rasterized(True)
        axes.add_collection3d(body)
        middle = 1e3 * (mesh.nodes.max(axis=0) + mesh.nodes.min(axis=0)) / 2
        half = 1e3 * extent * 0.5 + 90 * extent.max()
        axes.set(**{f"{k}lim": (middle[i] - half[i], middle[i] + half[i]) for i, k in enumerate("xyz")})
        axes.set_box_aspect(half, zoom=0.96 - 0.28 * half[2] / np.linalg.norm(half))  # tall ones need room for labels
        figure.suptitle(f"{title}\nlargest displacement drawn as {_EXAGGERATION:.0%} of the part's length", fontsize=9)
        for name, label in (("x", axes.set_xlabel), ("y", axes.set_ylabel), ("z", axes.set_zlabel)):
            label(f"{name} [mm]", labelpad=10)
        axes.tick_params(axis="z", pad=6)
        axes.locator_params(nbins=4)
        figure.colorbar(colours, ax=axes, shrink=0.7, pad=0.14, label="displacement over its largest")
    return figure


def impedance_figure(
    spectra: Mapping[str, SupportedSpectrum], *, title: str, measured: tuple[Floats, Complexes] | None = None
) -> "Figure":
    """Magnitude and phase of the impedance, and motion of the tip per volt, over frequency.

    Parameters
    ----------
    spectra : mapping of str to SupportedSpectrum
        By the name of the support, such as "free" and "clamped".
    title : str
    measured : tuple of two ndarray, optional
        Frequency [Hz] and complex impedance [ohm] of a measured spectrum.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.6, 5.8))
    magnitude, phase, motion = figure.subplots(3, 1, sharex=True, height_ratios=(1.4, 1, 1.2))
    if measured is not None:
        frequency, impedance = measured
        within = _within(frequency, spectra)
        f, z = 1e-3 * frequency[within], impedance[within]
        magnitude.plot(f, np.abs(z), ".", color="0.5", markersize=3, label="measured")
        phase.plot(f, np.degrees(np.angle(z)), ".", color="0.5", markersize=3)
    for k, (name, spectrum) in enumerate(spectra.items()):
        look: dict[str, Any] = {"color": COLOURS[k], "linestyle": LINES[k], "linewidth": 1.2}
        f = 1e-3 * spectrum.response.frequency
        magnitude.plot(f, np.abs(spectrum.impedance), label=name, **look)
        phase.plot(f, np.degrees(np.angle(spectrum.impedance)), **look)
        motion.plot(f, 1e9 * np.abs(spectrum.response.displacement_per_volt[0]), **look)
    magnitude.set(yscale="log", ylabel="Impedance [ohm]")
    phase.set(ylabel="Phase [deg]", ylim=(-100, 100), yticks=[-90, -45, 0, 45, 90])
    motion.set(yscale="log", ylabel="Tip motion per volt\n[nm/V]", xlabel="Frequency [kHz]")
    if len(spectra) > 1 or measured is not None:
        magnitude.legend(loc="best")
    magnitude.set_title(title, fontsize=9)
    return figure


def _within(frequency: Floats, spectra: Mapping[str, SupportedSpectrum]) -> NDArray[np.bool_]:
    """Which measured frequencies lie within the computed range."""
    computed = next(iter(spectra.values())).response.frequency
    return np.asarray((frequency >= computed[0]) & (frequency <= computed[-1]))


def _smooth(mesh: Mesh, shape: Floats) -> tuple[Mesh, Floats]:
    """Mesh with elements of an order that looks smooth in a picture, and the shape interpolated on its nodes."""
    triangles = sum(len(faces) for name, faces in mesh.faces.items() if "|" not in name)
    order = int(np.clip(np.sqrt(_MOST_TRIANGLES / triangles), 2, HIGHEST_ORDER))
    finer = change_order(mesh, order=order)
    return finer, transfer_field(shape, source=mesh, target=finer)
