"""Surfaces: height maps, their form, waviness, numbers and wear, and what a rough surface is to a contact model."""

from sonolube.surfaces.areal_parameters import (
    HeightParameters,
    HybridParameters,
    SpatialParameters,
    height_parameters,
    hybrid_parameters,
    spatial_parameters,
)
from sonolube.surfaces.asperities import (
    SamplingDependence,
    SummitStatistics,
    against_sampling_interval,
    combined,
    gaussian_summits,
    roughness,
    spectral_moments,
    summits,
)
from sonolube.surfaces.correlation import Autocorrelation, DecayLengths, autocorrelation, decay_lengths
from sonolube.surfaces.features import FeatureParameters, feature_parameters
from sonolube.surfaces.filtering import band_pass, high_pass, low_pass, profile_low_pass
from sonolube.surfaces.generated import HeightSpectrum, SelfAffineSpectrum, SingleScaleSpectrum, gaussian_surface
from sonolube.surfaces.grooves.ball_on_disc import WornCap, ball_cap_volume, disc_groove_volume, worn_cap
from sonolube.surfaces.grooves.detection import FoundGroove, find_groove
from sonolube.surfaces.grooves.generated import GeneratedGroove, GrooveShape, ScannedField, generated_groove
from sonolube.surfaces.grooves.groove import Groove, measure_groove
from sonolube.surfaces.grooves.track import GrooveTrack
from sonolube.surfaces.grooves.track_marks import TrackMarks, track_marks
from sonolube.surfaces.height_map import HeightMap
from sonolube.surfaces.levelling import form, level
from sonolube.surfaces.material_ratio import (
    FunctionalParameters,
    MaterialRatioCurve,
    functional_parameters,
    material_ratio_curve,
)
from sonolube.surfaces.profile_parameters import (
    ProfileParameters,
    ProfileStatistics,
    profile_parameters,
    profile_statistics,
)
from sonolube.surfaces.roughness import Roughness
from sonolube.surfaces.spectrum import (
    ArealSpectrum,
    ProfileSpectrum,
    RadialSpectrum,
    SpectralMoments,
    areal_spectrum,
    moments_of_spectrum,
    profile_spectrum,
    profiles,
    radial_spectrum,
)
from sonolube.surfaces.waviness import waviness_lengths

__all__ = [
    "ArealSpectrum",
    "Autocorrelation",
    "DecayLengths",
    "FeatureParameters",
    "FoundGroove",
    "FunctionalParameters",
    "GeneratedGroove",
    "Groove",
    "GrooveShape",
    "GrooveTrack",
    "HeightMap",
    "HeightParameters",
    "HeightSpectrum",
    "HybridParameters",
    "MaterialRatioCurve",
    "ProfileParameters",
    "ProfileSpectrum",
    "ProfileStatistics",
    "RadialSpectrum",
    "Roughness",
    "SamplingDependence",
    "ScannedField",
    "SelfAffineSpectrum",
    "SingleScaleSpectrum",
    "SpatialParameters",
    "SpectralMoments",
    "SummitStatistics",
    "TrackMarks",
    "WornCap",
    "against_sampling_interval",
    "areal_spectrum",
    "autocorrelation",
    "ball_cap_volume",
    "band_pass",
    "combined",
    "decay_lengths",
    "disc_groove_volume",
    "feature_parameters",
    "find_groove",
    "form",
    "functional_parameters",
    "gaussian_summits",
    "gaussian_surface",
    "generated_groove",
    "height_parameters",
    "high_pass",
    "hybrid_parameters",
    "level",
    "low_pass",
    "material_ratio_curve",
    "measure_groove",
    "moments_of_spectrum",
    "profile_low_pass",
    "profile_parameters",
    "profile_spectrum",
    "profile_statistics",
    "profiles",
    "radial_spectrum",
    "roughness",
    "spatial_parameters",
    "spectral_moments",
    "summits",
    "track_marks",
    "waviness_lengths",
    "worn_cap",
]
