from .areal_parameters import (
    FeatureParameters as FeatureParameters,
    HeightParameters as HeightParameters,
    HybridParameters as HybridParameters,
    SpatialParameters as SpatialParameters,
    feature_parameters as feature_parameters,
    height_parameters as height_parameters,
    hybrid_parameters as hybrid_parameters,
    spatial_parameters as spatial_parameters,
)
from .asperities import (
    SamplingDependence as SamplingDependence,
    SummitStatistics as SummitStatistics,
    combined_roughness as combined_roughness,
    contact_roughness as contact_roughness,
    nayak_summit_statistics as nayak_summit_statistics,
    sampling_dependence as sampling_dependence,
    spectral_moments as spectral_moments,
    summit_statistics as summit_statistics,
)
from .correlation import (
    Autocorrelation as Autocorrelation,
    CorrelationLengths as CorrelationLengths,
    autocorrelation as autocorrelation,
    correlation_lengths as correlation_lengths,
)
from .finish import (
    RmsHeightEstimate as RmsHeightEstimate,
    SurfaceFinish as SurfaceFinish,
    TypicalSummits as TypicalSummits,
    rms_height_from_maximum_height as rms_height_from_maximum_height,
    rms_height_from_roughness_average as rms_height_from_roughness_average,
    surface_finish as surface_finish,
    surface_finish_names as surface_finish_names,
    typical_summits as typical_summits,
)
from .form_removal import dominant_wavelengths as dominant_wavelengths, fit_form as fit_form, remove_form as remove_form
from .gaussian_filter import high_pass as high_pass, low_pass as low_pass, profile_low_pass as profile_low_pass
from .grooves.ball_on_disc import (
    WearScar as WearScar,
    disc_volume_loss as disc_volume_loss,
    pin_volume_loss as pin_volume_loss,
    wear_scar as wear_scar,
)
from .grooves.detection import DetectedGroove as DetectedGroove, detect_groove as detect_groove
from .grooves.field_tracks import (
    FieldTrack as FieldTrack,
    FieldTracks as FieldTracks,
    field_tracks as field_tracks,
    without_tracks as without_tracks,
)
from .grooves.groove import Groove as Groove, measure_groove as measure_groove
from .grooves.synthetic import (
    GrooveShape as GrooveShape,
    ScannedField as ScannedField,
    SyntheticGroove as SyntheticGroove,
    synthetic_groove as synthetic_groove,
)
from .grooves.track import GrooveTrack as GrooveTrack
from .grooves.track_marks import TrackMarks as TrackMarks, track_marks as track_marks
from .height_map import HeightMap as HeightMap, Roughness as Roughness
from .material_ratio import (
    FunctionalParameters as FunctionalParameters,
    MaterialRatioCurve as MaterialRatioCurve,
    functional_parameters as functional_parameters,
    material_ratio_curve as material_ratio_curve,
)
from .profile_evaluation import (
    ProfileEvaluation as ProfileEvaluation,
    SettingClass as SettingClass,
    evaluate_profile as evaluate_profile,
)
from .random_surface import (
    GaussianCorrelationSpectrum as GaussianCorrelationSpectrum,
    HeightSpectrum as HeightSpectrum,
    SelfAffineSpectrum as SelfAffineSpectrum,
    gaussian_surface as gaussian_surface,
)
from .roughness_profile import (
    ProfileParameters as ProfileParameters,
    ProfileStatistics as ProfileStatistics,
    profile_parameters as profile_parameters,
    profile_statistics as profile_statistics,
)
from .spectrum import (
    ArealSpectrum as ArealSpectrum,
    ProfileSpectrum as ProfileSpectrum,
    RadialSpectrum as RadialSpectrum,
    SpectralMoments as SpectralMoments,
    areal_spectrum as areal_spectrum,
    profile_spectrum as profile_spectrum,
    profiles as profiles,
    radial_spectrum as radial_spectrum,
)
from .spikes import spike_heights as spike_heights
