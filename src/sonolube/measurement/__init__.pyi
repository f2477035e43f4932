from .contact_stiffness.analysis import (
    MeasuredContactStiffness as MeasuredContactStiffness,
    measured_contact_stiffness as measured_contact_stiffness,
)
from .contact_stiffness.large_vibration import (
    decay_length_from_ratio as decay_length_from_ratio,
    equivalent_stiffness_ratio as equivalent_stiffness_ratio,
)
from .contact_stiffness.resonance_fit import (
    Resonance as Resonance,
    ResonanceFit as ResonanceFit,
    fit_resonances as fit_resonances,
)
from .contact_stiffness.resonance_spectrum import (
    ResonanceSpectrum as ResonanceSpectrum,
    read_resonance_spectrum as read_resonance_spectrum,
    vibration_spectrum as vibration_spectrum,
)
from .contact_stiffness.stiffness_estimate import (
    ContactStiffness as ContactStiffness,
    LogEstimate as LogEstimate,
    single_mode as single_mode,
)
from .friction.force_cycle import (
    ForceCycle as ForceCycle,
    StickSlipBurst as StickSlipBurst,
    StickSlipEstimate as StickSlipEstimate,
    find_cycle as find_cycle,
)
from .friction.loops import (
    FrictionLoops as FrictionLoops,
    FrictionWork as FrictionWork,
    friction_loops as friction_loops,
    friction_work as friction_work,
)
from .friction.rotation import (
    DiscRotation as DiscRotation,
    MotorCalibration as MotorCalibration,
    MotorFrictionTrace as MotorFrictionTrace,
    disc_rotation as disc_rotation,
    friction_from_motor_current as friction_from_motor_current,
    hall_pulse_times as hall_pulse_times,
    revolutions_at as revolutions_at,
)
from .friction.sliding import at_rest as at_rest
from .friction.slip_events import SlipChain as SlipChain, find_slips as find_slips, noise_spectra as noise_spectra
from .friction.step_means import (
    SampledParts as SampledParts,
    StepMeans as StepMeans,
    mean_of_parts as mean_of_parts,
    sampled_parts as sampled_parts,
    without_wobble as without_wobble,
    wobble_columns as wobble_columns,
)
from .friction.stick_slip import estimate_stick_slip as estimate_stick_slip, stick_slip_of_parts as stick_slip_of_parts
from .friction.voltage_steps import (
    VoltageStep as VoltageStep,
    friction_at_voltage_steps as friction_at_voltage_steps,
    rotation_speed_at_voltage_steps as rotation_speed_at_voltage_steps,
    voltage_envelope as voltage_envelope,
)
from .friction.windows import (
    DEFAULT_WINDOW_DURATION as DEFAULT_WINDOW_DURATION,
    SteadyStateOnset as SteadyStateOnset,
    WindowStatistics as WindowStatistics,
    steady_state_onset as steady_state_onset,
    streamed_window_statistics as streamed_window_statistics,
    window_statistics as window_statistics,
)
from .friction.wobble import (
    WobbleCorrection as WobbleCorrection,
    find_rotation_speed as find_rotation_speed,
    harmonic_columns as harmonic_columns,
    refined_speed as refined_speed,
    remove_wobble as remove_wobble,
)
from .friction_analysis import (
    FrictionCycles as FrictionCycles,
    RunningIn as RunningIn,
    analyse_cycles as analyse_cycles,
    analyse_motor_current as analyse_motor_current,
    analyse_rotation as analyse_rotation,
    analyse_rotation_speed as analyse_rotation_speed,
    analyse_running_in as analyse_running_in,
    analyse_stick_slip as analyse_stick_slip,
    analyse_voltage_steps as analyse_voltage_steps,
    analyse_windows as analyse_windows,
    analyse_wobble as analyse_wobble,
    channel_values as channel_values,
)
from .gauge.calibration import (
    BranchCalibration as BranchCalibration,
    ForceEstimate as ForceEstimate,
    PreisachCalibration as PreisachCalibration,
    dissipated_energy as dissipated_energy,
    fit_branches as fit_branches,
    fit_preisach as fit_preisach,
    force_from_branches as force_from_branches,
    force_from_preisach as force_from_preisach,
    major_loop_dissipation as major_loop_dissipation,
)
from .gauge.preisach import (
    PreisachPlane as PreisachPlane,
    mean_relay_widths as mean_relay_widths,
    preisach_output as preisach_output,
    relay_fractions as relay_fractions,
)
from .impedance.spectrum import (
    IMPEDANCE_FORMATS as IMPEDANCE_FORMATS,
    ImpedanceFormat as ImpedanceFormat,
    ImpedanceSpectrum as ImpedanceSpectrum,
    passive_spectrum as passive_spectrum,
    read_impedance as read_impedance,
)
from .recordings.channels_and_parts import join_recordings as join_recordings
from .recordings.mapping import (
    ChannelSource as ChannelSource,
    RecordingMapping as RecordingMapping,
    Selection as Selection,
    TextLayout as TextLayout,
    read_mapping as read_mapping,
)
from .recordings.reader import (
    RECORDING_FORMATS as RECORDING_FORMATS,
    RecordingFormat as RecordingFormat,
    StreamedRecordingFormat as StreamedRecordingFormat,
    instrument_mappings as instrument_mappings,
    mapping_by_name as mapping_by_name,
    read_recording as read_recording,
    recording_blocks as recording_blocks,
    recording_format_name as recording_format_name,
    write_recording as write_recording,
)
from .statistics.autocorrelation import (
    CorrelatedMean as CorrelatedMean,
    CorrelatedRegression as CorrelatedRegression,
    correlated_mean as correlated_mean,
    correlated_regression as correlated_regression,
    statistical_inefficiency as statistical_inefficiency,
)
from .statistics.log_parameter_fit import (
    ConfidenceInterval as ConfidenceInterval,
    LogParameterFit as LogParameterFit,
    confidence_intervals as confidence_intervals,
    fit_log_parameters as fit_log_parameters,
    residual_inefficiency as residual_inefficiency,
)
from .statistics.repeated_tests import (
    MeanDifference as MeanDifference,
    MeanEstimate as MeanEstimate,
    RatioEstimate as RatioEstimate,
    compare_means as compare_means,
    mean_estimate as mean_estimate,
    ratio_interval as ratio_interval,
)
from .surface_files.reader import (
    SURFACE_FORMATS as SURFACE_FORMATS,
    SurfaceFile as SurfaceFile,
    SurfaceFormat as SurfaceFormat,
    read_height_map as read_height_map,
    read_surface_file as read_surface_file,
)
from .temperature import (
    TemperatureResponse as TemperatureResponse,
    TemperatureRise as TemperatureRise,
    fit_temperature_response as fit_temperature_response,
    temperature_rise_by_stage as temperature_rise_by_stage,
)
from .vibration import (
    AmplitudePerVolt as AmplitudePerVolt,
    OperatingDeflectionShape as OperatingDeflectionShape,
    amplitude_per_volt as amplitude_per_volt,
    complex_amplitudes as complex_amplitudes,
    modal_assurance_criterion as modal_assurance_criterion,
    operating_deflection_shape as operating_deflection_shape,
)
from .wear_track import (
    WearReduction as WearReduction,
    WearTrack as WearTrack,
    measure_wear_track as measure_wear_track,
    wear_reduction_between_tracks as wear_reduction_between_tracks,
    wear_track_from_grooves as wear_track_from_grooves,
)
