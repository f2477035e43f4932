"""Scans round two worn rings, with and without vibration, for the tutorial on measurements.

Run: python examples/wear_rings.py measured
"""

import sys
from pathlib import Path

import numpy as np

from sonolube.models.surfaces import GrooveShape, GrooveTrack, synthetic_groove

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "measured")
for ring, depth in {"ring-off": 60e-6, "ring-on": 30e-6}.items():
    (folder / ring).mkdir(parents=True, exist_ok=True)
    shape = GrooveShape(groove_width=0.9e-3, groove_depth=depth, pile_up_height=4e-6, pile_up_width=0.1e-3)
    for place in range(1, 4):
        track = GrooveTrack(track_direction=0.5 * place, track_curvature=0.0, track_offset=5e-5 * place)
        scan = synthetic_groove(shape, track=track, seed=place).scan
        np.save(folder / ring / f"scan-{place}.npy", scan.height)
        print(folder / ring / f"scan-{place}.npy")
