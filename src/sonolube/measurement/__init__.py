"""Measurement: instrument files read into records with uncertainty, and the analyses of friction tests.

`README.md` beside this file describes the methods, the names and the sub-rooms.
"""

from sonolube.measurement.friction.loops import FrictionLoops, FrictionWork, friction_loops, friction_work
from sonolube.measurement.friction.motor_current import MotorCalibration, friction_from_motor_current
from sonolube.measurement.friction.reduction import FrictionReductionEstimate, estimate_friction_reduction
from sonolube.measurement.friction.rotation import DiscRotation, disc_rotation, hall_pulse_times, revolutions_at
from sonolube.measurement.friction.running_in import SteadyStateOnset, steady_state_onset
from sonolube.measurement.friction.stick_slip import StickSlipEstimate, estimate_stick_slip
from sonolube.measurement.friction.voltage_steps import VoltageStep, friction_at_voltage_steps, voltage_envelope
from sonolube.measurement.friction.windows import (
    DEFAULT_WINDOW_DURATION,
    WindowStatistics,
    streamed_window_statistics,
    window_statistics,
)
from sonolube.measurement.friction.wobble import WobbleCorrection, remove_wobble
from sonolube.measurement.friction_analysis import (
    FrictionCycles,
    MotorFrictionTrace,
    RunningIn,
    analyse_cycles,
    analyse_motor_current,
    analyse_rotation,
    analyse_running_in,
    analyse_stick_slip,
    analyse_voltage_steps,
    analyse_windows,
    analyse_wobble,
    channel_values,
)
from sonolube.measurement.gauge.calibration import (
    BranchCalibration,
    ForceEstimate,
    PreisachCalibration,
    dissipated_energy,
    fit_branches,
    fit_preisach,
    force_from_branches,
    force_from_preisach,
    major_loop_dissipation,
)
from sonolube.measurement.gauge.preisach import PreisachPlane, mean_relay_widths, preisach_output, relay_fractions
from sonolube.measurement.impedance.formats import IMPEDANCE_FORMATS, ImpedanceFormat
from sonolube.measurement.impedance.reader import read_impedance
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.measurement.recordings.formats import RECORDING_FORMATS, RecordingFormat, StreamedRecordingFormat
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, TextLayout, read_mapping
from sonolube.measurement.recordings.reader import (
    read_recording,
    recording_blocks,
    recording_format_name,
    write_recording,
)
from sonolube.measurement.statistics.autocorrelation import (
    CorrelatedMean,
    correlated_mean,
    correlation_time,
    statistical_inefficiency,
)
from sonolube.measurement.statistics.log_parameter_fit import (
    ConfidenceInterval,
    LogParameterFit,
    confidence_intervals,
    fit_log_parameters,
    residual_inefficiency,
)
from sonolube.measurement.statistics.repeated_tests import (
    MeanDifference,
    MeanEstimate,
    RatioEstimate,
    Repeatability,
    compare_means,
    mean_estimate,
    ratio_interval,
    repeatability,
)
from sonolube.measurement.surface_files.formats import SURFACE_FORMATS, SurfaceFormat
from sonolube.measurement.surface_files.reader import SurfaceFile, read_height_map, read_surface_file
from sonolube.measurement.temperature import (
    TemperatureResponse,
    TemperatureRise,
    fit_temperature_response,
    heating_rate,
    temperature_rise_between,
    temperature_rise_by_stage,
)
from sonolube.measurement.vibration import (
    AmplitudePerVolt,
    OperatingDeflectionShape,
    amplitude_per_volt,
    complex_amplitudes,
    modal_assurance_criterion,
    operating_deflection_shape,
)
from sonolube.measurement.wear_track import (
    WearReduction,
    WearTrack,
    measure_wear_track,
    wear_reduction_between_tracks,
    wear_track_from_grooves,
)

__all__ = [
    "DEFAULT_WINDOW_DURATION",
    "IMPEDANCE_FORMATS",
    "RECORDING_FORMATS",
    "SURFACE_FORMATS",
    "AmplitudePerVolt",
    "BranchCalibration",
    "ChannelSource",
    "ConfidenceInterval",
    "CorrelatedMean",
    "DiscRotation",
    "ForceEstimate",
    "FrictionCycles",
    "FrictionLoops",
    "FrictionReductionEstimate",
    "FrictionWork",
    "ImpedanceFormat",
    "ImpedanceSpectrum",
    "LogParameterFit",
    "MeanDifference",
    "MeanEstimate",
    "MotorCalibration",
    "MotorFrictionTrace",
    "OperatingDeflectionShape",
    "PreisachCalibration",
    "PreisachPlane",
    "RatioEstimate",
    "RecordingFormat",
    "RecordingMapping",
    "Repeatability",
    "RunningIn",
    "SteadyStateOnset",
    "StickSlipEstimate",
    "StreamedRecordingFormat",
    "SurfaceFile",
    "SurfaceFormat",
    "TemperatureResponse",
    "TemperatureRise",
    "TextLayout",
    "VoltageStep",
    "WearReduction",
    "WearTrack",
    "WindowStatistics",
    "WobbleCorrection",
    "amplitude_per_volt",
    "analyse_cycles",
    "analyse_motor_current",
    "analyse_rotation",
    "analyse_running_in",
    "analyse_stick_slip",
    "analyse_voltage_steps",
    "analyse_windows",
    "analyse_wobble",
    "channel_values",
    "compare_means",
    "complex_amplitudes",
    "confidence_intervals",
    "correlated_mean",
    "correlation_time",
    "disc_rotation",
    "dissipated_energy",
    "estimate_friction_reduction",
    "estimate_stick_slip",
    "fit_branches",
    "fit_log_parameters",
    "fit_preisach",
    "fit_temperature_response",
    "force_from_branches",
    "force_from_preisach",
    "friction_at_voltage_steps",
    "friction_from_motor_current",
    "friction_loops",
    "friction_work",
    "hall_pulse_times",
    "heating_rate",
    "major_loop_dissipation",
    "mean_estimate",
    "mean_relay_widths",
    "measure_wear_track",
    "modal_assurance_criterion",
    "operating_deflection_shape",
    "preisach_output",
    "ratio_interval",
    "read_height_map",
    "read_impedance",
    "read_mapping",
    "read_recording",
    "read_surface_file",
    "recording_blocks",
    "recording_format_name",
    "relay_fractions",
    "remove_wobble",
    "repeatability",
    "residual_inefficiency",
    "revolutions_at",
    "statistical_inefficiency",
    "steady_state_onset",
    "streamed_window_statistics",
    "temperature_rise_between",
    "temperature_rise_by_stage",
    "voltage_envelope",
    "wear_reduction_between_tracks",
    "wear_track_from_grooves",
    "window_statistics",
    "write_recording",
]
