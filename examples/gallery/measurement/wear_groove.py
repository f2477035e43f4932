"""Wear groove

A worn track in a scan of known volume: place, width and depth are found, the unworn surface is estimated from
what lies beside the track, and the volume follows with its interval.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import sonolube as sl
from sonolube.models.surfaces import GrooveShape, GrooveTrack, synthetic_groove

shape = GrooveShape(groove_width=0.6e-3, groove_depth=20e-6, pile_up_height=3e-6, pile_up_width=0.1e-3)
track = GrooveTrack(track_direction=0.5, track_curvature=0.0, track_offset=5e-5)
scan = synthetic_groove(shape, track=track, seed=1).scan
with TemporaryDirectory() as folder:
    np.save(Path(folder) / "scan.npy", scan.height)
    spacing = f"{scan.spacing_x} m, {scan.spacing_y} m"
    figure = sl.plot(sl.measure.groove(Path(folder) / "scan.npy", spacing=spacing, length_unit="m"))

if __name__ == "__main__":
    figure.savefig("wear-groove.png", dpi=150)
