"""Track of a wear groove in a scan, a line or a circular arc, and curvilinear coordinates about it."""

import math
from dataclasses import asdict, dataclass

import numpy as np

from sonolube.checks import Floats, require_finite
from sonolube.models.surfaces.grooves.plane_coordinates import arc_coordinates, centred_coordinates
from sonolube.models.surfaces.height_map import HeightMap


@dataclass(frozen=True, kw_only=True, slots=True)
class GrooveTrack:
    """Centre line of a wear groove in a scan, relative to the centre of the field.

    Parameters
    ----------
    track_direction : float
        Direction of the track past the centre of the field, from the rows towards the columns. [rad]
    track_curvature : float
        Curvature of the concentric circle through the centre of the field; zero for a straight track, positive for a
        centre to the left of the direction. [1/m]
    track_offset : float
        Distance of the track from the centre of the field, positive to the left of the direction. [m]
    """

    track_direction: float
    track_curvature: float
    track_offset: float

    def __post_init__(self) -> None:
        require_finite(**asdict(self))

    @property
    def groove_diameter(self) -> float:
        """Diameter of the circular wear track on the disc; infinite for a straight track. [m]"""
        return 2 * abs(1 / self.track_curvature - self.track_offset) if self.track_curvature else math.inf

    def curvilinear_coordinates(self, surface: HeightMap) -> tuple[Floats, Floats]:
        """Transverse distance and arc length of each pixel with respect to the track.

        Parameters
        ----------
        surface : HeightMap

        Returns
        -------
        transverse : ndarray, shape of the heights
            Distance from the track in m, positive to the left of its direction.
        arc_length : ndarray, shape of the heights
            Length along the track from the centre of the field, in m.
        """
        x, y = centred_coordinates(surface)
        transverse, arc_length = arc_coordinates(x, y, self.track_direction, self.track_curvature)
        return transverse - self.track_offset, arc_length * (1 - self.track_curvature * self.track_offset)

    def pixel_position(self, surface: HeightMap, transverse: Floats, arc_length: Floats) -> tuple[Floats, Floats]:
        """Fractional row and column of points given by curvilinear coordinates; inverse of `curvilinear_coordinates`.

        Parameters
        ----------
        surface : HeightMap
        transverse : ndarray, any shape
            Distances from the track in m.
        arc_length : ndarray, shape of `transverse`
            Lengths along the track in m.

        Returns
        -------
        row : ndarray, shape of `transverse`
        column : ndarray, shape of `transverse`
        """
        k, from_circle = self.track_curvature, transverse + self.track_offset
        angle = k * arc_length / (1 - k * self.track_offset)
        half = arc_length / (1 - k * self.track_offset) * np.sinc(angle / (2 * math.pi)) / 2  # sin(angle/2)/k
        radius = 1 - k * from_circle
        left, ahead = from_circle + 2 * k * half**2 * radius, 2 * half * np.cos(angle / 2) * radius
        cos, sin = math.cos(self.track_direction), math.sin(self.track_direction)
        rows, columns = surface.height.shape
        column = (ahead * cos - left * sin) / surface.spacing_x + (columns - 1) / 2
        row = (ahead * sin + left * cos) / surface.spacing_y + (rows - 1) / 2
        return row, column
