"""The track of a wear groove through a scan: a line or an arc of a circle, and positions across and along it."""

import math
from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, require_finite
from sonolube.surfaces.grooves.plane_coordinates import arc_coordinates, centred_coordinates
from sonolube.surfaces.height_map import HeightMap


@dataclass(frozen=True, kw_only=True, slots=True)
class GrooveTrack:
    """Where a groove runs in a scan, seen from the middle of the field.

    Parameters
    ----------
    track_direction : float
        Angle from the rows towards the columns at which the track passes the middle. [rad]
    track_curvature : float
        One over the radius of the circle about the ring's centre that passes through the middle of the field; zero for
        a straight track, positive where the centre lies to the left of the direction. [1/m]
    track_offset : float
        Distance of the track from the middle of the field, positive to the left of the direction. [m]
    """

    track_direction: float
    track_curvature: float
    track_offset: float

    def __post_init__(self) -> None:
        require_finite(
            track_direction=self.track_direction,
            track_curvature=self.track_curvature,
            track_offset=self.track_offset,
        )

    @property
    def groove_diameter(self) -> float:
        """Diameter of the ring of which the track is an arc; infinite where it is straight. [m]"""
        return 2 * abs(1 / self.track_curvature - self.track_offset) if self.track_curvature else math.inf

    def curvilinear_coordinates(self, surface: HeightMap) -> tuple[Floats, Floats]:
        """Return where each pixel lies beside the track, and how far along it, counted from the middle of the field.

        Parameters
        ----------
        surface : HeightMap

        Returns
        -------
        across : ndarray, shape of the heights
            Distance from the track in m, positive to the left of its direction.
        along : ndarray, shape of the heights
            Length of the track up to there in m.
        """
        x, y = centred_coordinates(surface)
        across, along = arc_coordinates(x, y, self.track_direction, self.track_curvature)
        return across - self.track_offset, along * (1 - self.track_curvature * self.track_offset)

    def place(self, surface: HeightMap, across: Floats, along: Floats) -> tuple[Floats, Floats]:
        """Return the row and column, with fractions, of positions beside and along the track.

        Parameters
        ----------
        surface : HeightMap
        across : ndarray, any shape
            Distances from the track in m.
        along : ndarray, shape of `across`
            Lengths along the track in m.

        Returns
        -------
        row : ndarray, shape of `across`
        column : ndarray, shape of `across`
        """
        k, from_circle = self.track_curvature, across + self.track_offset
        turn = k * along / (1 - k * self.track_offset)
        half = along / (1 - k * self.track_offset) * np.sinc(turn / (2 * math.pi)) / 2  # sin(turn/2)/k
        radius = 1 - k * from_circle
        left, ahead = from_circle + 2 * k * half**2 * radius, 2 * half * np.cos(turn / 2) * radius
        cos, sin = math.cos(self.track_direction), math.sin(self.track_direction)
        rows, columns = surface.height.shape
        column = (ahead * cos - left * sin) / surface.spacing_x + (columns - 1) / 2
        row = (ahead * sin + left * cos) / surface.spacing_y + (rows - 1) / 2
        return row, column
