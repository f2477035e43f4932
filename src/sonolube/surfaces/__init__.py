"""Surface metrology: height maps, filters, ISO 25178 and 21920 parameters, spectra, asperities and wear grooves."""

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
    combined_roughness,
    contact_roughness,
    nayak_summit_statistics,
    sampling_dependence,
    spectral_moments,
    summit_statistics,
)
from sonolube.surfaces.correlation import Autocorrelation, CorrelationLengths, autocorrelation, correlation_lengths
from sonolube.surfaces.features import FeatureParameters, feature_parameters
from sonolube.surfaces.form_removal import fit_form, remove_form
from sonolube.surfaces.gaussian_filter import band_pass, high_pass, low_pass, profile_low_pass
from sonolube.surfaces.grooves.ball_on_disc import WearScar, disc_volume_loss, pin_volume_loss, wear_scar
from sonolube.surfaces.grooves.detection import DetectedGroove, detect_groove
from sonolube.surfaces.grooves.groove import Groove, measure_groove
from sonolube.surfaces.grooves.synthetic import GrooveShape, ScannedField, SyntheticGroove, synthetic_groove
from sonolube.surfaces.grooves.track import GrooveTrack
from sonolube.surfaces.grooves.track_marks import TrackMarks, track_marks
from sonolube.surfaces.height_map import HeightMap
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
from sonolube.surfaces.random_surface import (
    GaussianCorrelationSpectrum,
    HeightSpectrum,
    SelfAffineSpectrum,
    gaussian_surface,
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
from sonolube.surfaces.waviness import dominant_wavelengths

__all__ = [
    "ArealSpectrum",
    "Autocorrelation",
    "CorrelationLengths",
    "DetectedGroove",
    "FeatureParameters",
    "FunctionalParameters",
    "GaussianCorrelationSpectrum",
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
    "SpatialParameters",
    "SpectralMoments",
    "SummitStatistics",
    "SyntheticGroove",
    "TrackMarks",
    "WearScar",
    "areal_spectrum",
    "autocorrelation",
    "band_pass",
    "combined_roughness",
    "contact_roughness",
    "correlation_lengths",
    "detect_groove",
    "disc_volume_loss",
    "dominant_wavelengths",
    "feature_parameters",
    "fit_form",
    "functional_parameters",
    "gaussian_surface",
    "height_parameters",
    "high_pass",
    "hybrid_parameters",
    "low_pass",
    "material_ratio_curve",
    "measure_groove",
    "moments_of_spectrum",
    "nayak_summit_statistics",
    "pin_volume_loss",
    "profile_low_pass",
    "profile_parameters",
    "profile_spectrum",
    "profile_statistics",
    "profiles",
    "radial_spectrum",
    "remove_form",
    "sampling_dependence",
    "spatial_parameters",
    "spectral_moments",
    "summit_statistics",
    "synthetic_groove",
    "track_marks",
    "wear_scar",
]
