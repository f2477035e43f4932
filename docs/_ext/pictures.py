"""Figures of scripts as PNG for light and dark pages, drawn at a build where script or package have changed."""

import hashlib
import json
import os
import runpy
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path

os.environ.setdefault("MPLBACKEND", "Agg")

import dark_figures
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

import sonolube
from sonolube.figure import render_figure

ROOT = Path(__file__).parents[2]
STORE = ROOT / "out" / "pictures"
_RESOLUTION = 180  # dots per inch
_SOURCES = {".py", ".toml", ".npz", ".json"}


@cache
def _package() -> bytes:
    """Return the digest of the package's files."""
    digest = hashlib.sha256()
    for path in sorted(Path(sonolube.__file__).parent.rglob("*")):
        if path.suffix in _SOURCES:
            digest.update(path.read_bytes())
    return digest.digest()


def kept(script: Path, make: Callable[[Path], object]) -> tuple[Path, object]:
    """Return the folder of a script's pictures, and the record of what `make` drew there, now or before."""
    own = b"".join(Path(name).read_bytes() for name in (__file__, dark_figures.__file__))
    digest = hashlib.sha256(script.read_bytes() + own + _package()).hexdigest()[:16]
    folder = STORE / f"{script.stem}-{digest}"
    record = folder / "record.json"
    if not record.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        record.write_text(json.dumps(make(folder)), encoding="utf-8")
    return folder, json.loads(record.read_text(encoding="utf-8"))


def figure_of(script: Path) -> Figure:
    """Run a script of the gallery and return its `figure`; a warning is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = runpy.run_path(str(script), run_name="gallery")["figure"]
    plt.close("all")
    if not isinstance(figure, Figure):
        raise TypeError(f"{script}: `figure` must be a figure, got {type(figure).__name__}")
    return figure


def write(figure: Figure, path: Path) -> None:
    """Write a figure as PNG, and beside it the same for dark pages."""
    path.write_bytes(render_figure(figure, "png", resolution=_RESOLUTION))
    dark_figures.darken(figure)
    dark_of(path).write_bytes(render_figure(figure, "png", resolution=_RESOLUTION))


def dark_of(path: Path) -> Path:
    """Return where the picture for dark pages lies."""
    return path.with_name(f"{path.stem}-dark{path.suffix}")


def image(title: str, shown: str) -> str:
    """Return the pictures of a figure as Markdown, of which the theme shows one, by the path of the light one."""
    place, _, name = shown.rpartition("/")
    return "\n\n".join(
        f"```{{image}} {path}\n:alt: {title}\n:class: {kind}\n:loading: lazy\n```"
        for path, kind in ((shown, "only-light"), (f"{place}/{dark_of(Path(name))}", "only-dark"))
    )


def picture_of(script: Path) -> Path:
    """Return the picture of a script of the gallery."""
    folder, name = kept(script, lambda folder: _drawn(script, folder))
    return folder / str(name)


def _drawn(script: Path, folder: Path) -> str:
    name = f"{script.stem.replace('_', '-')}.png"
    write(figure_of(script), folder / name)
    return name
