"""Turns a trajectory into inertial sensor data, and inertial sensor data back into attitude.

Frames
    N   navigation frame: x east, y true north, z up; inertial, unless an Environment turns it with the Earth
    I   inertial axes
    B   body: x forward, y left, z up
    S   sensor axes of an IMU mounted on the body

Symbols (adjacent letters cancel: ``v_N = R_NB @ v_B``)
    p_NB, v_NB, a_NB    (n, 3)      position, velocity, acceleration of B in N: m, m/s, m/s^2
    R_NB                (n, 3, 3)   maps B components to N components; its columns are the body axes in N
    omega_NB_B          (n, 3)      angular rate of B relative to N, in B axes: rad/s
    alpha_NB_B          (n, 3)      time derivative of omega_NB_B: rad/s^2
    omega_IN_N          (3,)        rate at which N turns, the Earth's or 0: rad/s
    p_BS, R_BS                      lever arm from the body origin to the sensor in B: m; sensor axes in B
    gyro                (n, 3)      omega_NS_S, right-handed: rad/s; omega_IS_S where N turns
    accel               (n, 3)      specific force R_SN (a_N - g_N): m/s^2; +g up at rest
    mag_uT              (n, 3)      magnetic field in S: microtesla
    phi                 (n, 3)      Euler angles (phi_x, phi_y, phi_z): R_NB = Rz(phi_z) Ry(phi_y) Rx(phi_x)

Units are SI and radians; a name in another unit wears it (``heading_deg``, ``mag_uT``).
Time is float64 seconds after ``t0_ns``, an integer epoch in nanoseconds.
"""

from __future__ import annotations

# Type checkers take it for true. Loading `typing` would take longer than all else up to the first line of the
# command line, which answers to Ctrl-C only from there on.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from kreisel.data.attitude import AttitudeHistory as AttitudeHistory
    from kreisel.data.attitude import Reference as Reference
    from kreisel.data.calibration import Calibration as Calibration
    from kreisel.data.environment import Environment as Environment
    from kreisel.data.increments import ImuIncrements as ImuIncrements
    from kreisel.data.motion import Motion as Motion
    from kreisel.data.motion import Mount as Mount
    from kreisel.data.motion import Note as Note
    from kreisel.data.motion_definition import MotionDefinition as MotionDefinition
    from kreisel.data.noise import NoiseModel as NoiseModel
    from kreisel.data.recording import ImuRecording as ImuRecording
    from kreisel.data.segment import Segment as Segment
    from kreisel.data.smoothing import Smoothing as Smoothing
    from kreisel.data.temperature import TemperatureHistory as TemperatureHistory
    from kreisel.data.trajectory import Poses as Poses
    from kreisel.data.trajectory import Trajectory as Trajectory
    from kreisel.data.trial import Trial as Trial
    from kreisel.data.waypoint import Waypoint as Waypoint
    from kreisel.estimate.batch import run_all as run_all
    from kreisel.estimate.batch import run_batch as run_batch
    from kreisel.estimate.filters.dcm import DcmFilter as DcmFilter
    from kreisel.estimate.filters.mekf import MekfFilter as MekfFilter
    from kreisel.estimate.long import run_long as run_long
    from kreisel.estimate.run import run as run
    from kreisel.estimate.smooth import smooth as smooth
    from kreisel.estimate.smooth import smooth_all as smooth_all
    from kreisel.estimate.strapdown import integrate as integrate
    from kreisel.estimate.stream import Stream as Stream
    from kreisel.evaluate.align import align as align
    from kreisel.evaluate.align.alignment import Alignment as Alignment
    from kreisel.evaluate.allan import AllanFit as AllanFit
    from kreisel.evaluate.allan import allan as allan
    from kreisel.evaluate.attitude_errors import AttitudeErrors as AttitudeErrors
    from kreisel.evaluate.attitude_errors import attitude_errors as attitude_errors
    from kreisel.evaluate.calibrate import calibrate_accel as calibrate_accel
    from kreisel.evaluate.calibrate import calibrate_gyro as calibrate_gyro
    from kreisel.evaluate.calibrate import calibrate_mag as calibrate_mag
    from kreisel.evaluate.motion_errors import MotionErrors as MotionErrors
    from kreisel.evaluate.motion_errors import motion_errors as motion_errors
    from kreisel.files.blocks import read_blocks as read_blocks
    from kreisel.files.blocks import write_blocks as write_blocks
    from kreisel.files.doors import read as read
    from kreisel.files.doors import write as write
    from kreisel.files.kalibr import KalibrImu as KalibrImu
    from kreisel.files.kalibr import read_kalibr as read_kalibr
    from kreisel.files.kalibr import write_kalibr as write_kalibr
    from kreisel.files.profiles import read_profile as read_profile
    from kreisel.files.waypoints import read_waypoints as read_waypoints
    from kreisel.simulate.clock import Clock as Clock
    from kreisel.simulate.clock import Sampling as Sampling
    from kreisel.simulate.disturbances.dipole import Dipole as Dipole
    from kreisel.simulate.disturbances.drift import FieldDrift as FieldDrift
    from kreisel.simulate.disturbances.step import FieldStep as FieldStep
    from kreisel.simulate.effects.bandwidth import Bandwidth as Bandwidth
    from kreisel.simulate.effects.bias_instability import BiasInstability as BiasInstability
    from kreisel.simulate.effects.bias_random_walk import BiasRandomWalk as BiasRandomWalk
    from kreisel.simulate.effects.g_sensitivity import GSensitivity as GSensitivity
    from kreisel.simulate.effects.gauss_markov import GaussMarkov as GaussMarkov
    from kreisel.simulate.effects.hard_soft_iron import HardSoftIron as HardSoftIron
    from kreisel.simulate.effects.increment_quantisation import (
        IncrementQuantisation as IncrementQuantisation,
    )
    from kreisel.simulate.effects.misalignment import Misalignment as Misalignment
    from kreisel.simulate.effects.nonlinearity import Nonlinearity as Nonlinearity
    from kreisel.simulate.effects.quantisation import Quantisation as Quantisation
    from kreisel.simulate.effects.range import Range as Range
    from kreisel.simulate.effects.scale_factor import ScaleFactor as ScaleFactor
    from kreisel.simulate.effects.temperature_bias import TemperatureBias as TemperatureBias
    from kreisel.simulate.effects.temperature_scale import TemperatureScale as TemperatureScale
    from kreisel.simulate.effects.turn_on_bias import TurnOnBias as TurnOnBias
    from kreisel.simulate.effects.vibration_lines import VibrationLines as VibrationLines
    from kreisel.simulate.effects.vibration_noise import VibrationNoise as VibrationNoise
    from kreisel.simulate.effects.white_noise import WhiteNoise as WhiteNoise
    from kreisel.simulate.imu import Imu as Imu
    from kreisel.simulate.recorded import Recorded as Recorded
    from kreisel.simulate.trajectories.circle import circle as circle
    from kreisel.simulate.trajectories.coning import coning as coning
    from kreisel.simulate.trajectories.expressions import expressions as expressions
    from kreisel.simulate.trajectories.functions import FunctionTrajectory as FunctionTrajectory
    from kreisel.simulate.trajectories.gnss_ins_sim import CommandedMotion as CommandedMotion
    from kreisel.simulate.trajectories.helix import helix as helix
    from kreisel.simulate.trajectories.line import line as line
    from kreisel.simulate.trajectories.lissajous import lissajous as lissajous
    from kreisel.simulate.trajectories.lying_eight import figure_eight as figure_eight
    from kreisel.simulate.trajectories.lying_eight import lying_eight as lying_eight
    from kreisel.simulate.trajectories.profile import MotionProfile as MotionProfile
    from kreisel.simulate.trajectories.profile import profile as profile
    from kreisel.simulate.trajectories.rest import rest as rest
    from kreisel.simulate.trajectories.rounded_rectangle import rounded_rectangle as rounded_rectangle
    from kreisel.simulate.trajectories.sampled import SampledTrajectory as SampledTrajectory
    from kreisel.simulate.trajectories.waypoints import WaypointTrajectory as WaypointTrajectory
    from kreisel.simulate.trajectories.waypoints import waypoints as waypoints
    from kreisel.study.engine import run_blocks as run_blocks
    from kreisel.study.ensemble.ensemble import Ensemble as Ensemble
    from kreisel.study.monte_carlo import monte_carlo as monte_carlo
    from kreisel.study.round_trip import round_trip as round_trip
    from kreisel.study.scenario import Scenario as Scenario
    from kreisel.study.sweep import sweep as sweep
    from kreisel.study.tune import tune as tune

__version__ = "0.1.0"

# Public name -> module. Loaded at first use, so that `import kreisel` costs milliseconds.
_HOMES = {
    "align": "kreisel.evaluate.align",
    "Alignment": "kreisel.evaluate.align.alignment",
    "allan": "kreisel.evaluate.allan",
    "AllanFit": "kreisel.evaluate.allan",
    "attitude_errors": "kreisel.evaluate.attitude_errors",
    "AttitudeErrors": "kreisel.evaluate.attitude_errors",
    "AttitudeHistory": "kreisel.data.attitude",
    "Bandwidth": "kreisel.simulate.effects.bandwidth",
    "BiasInstability": "kreisel.simulate.effects.bias_instability",
    "BiasRandomWalk": "kreisel.simulate.effects.bias_random_walk",
    "calibrate_accel": "kreisel.evaluate.calibrate",
    "calibrate_gyro": "kreisel.evaluate.calibrate",
    "calibrate_mag": "kreisel.evaluate.calibrate",
    "Calibration": "kreisel.data.calibration",
    "circle": "kreisel.simulate.trajectories.circle",
    "Clock": "kreisel.simulate.clock",
    "CommandedMotion": "kreisel.simulate.trajectories.gnss_ins_sim",
    "coning": "kreisel.simulate.trajectories.coning",
    "DcmFilter": "kreisel.estimate.filters.dcm",
    "Dipole": "kreisel.simulate.disturbances.dipole",
    "Ensemble": "kreisel.study.ensemble.ensemble",
    "Environment": "kreisel.data.environment",
    "expressions": "kreisel.simulate.trajectories.expressions",
    "FieldDrift": "kreisel.simulate.disturbances.drift",
    "FieldStep": "kreisel.simulate.disturbances.step",
    "figure_eight": "kreisel.simulate.trajectories.lying_eight",
    "FunctionTrajectory": "kreisel.simulate.trajectories.functions",
    "GaussMarkov": "kreisel.simulate.effects.gauss_markov",
    "GSensitivity": "kreisel.simulate.effects.g_sensitivity",
    "HardSoftIron": "kreisel.simulate.effects.hard_soft_iron",
    "helix": "kreisel.simulate.trajectories.helix",
    "Imu": "kreisel.simulate.imu",
    "ImuIncrements": "kreisel.data.increments",
    "ImuRecording": "kreisel.data.recording",
    "IncrementQuantisation": "kreisel.simulate.effects.increment_quantisation",
    "integrate": "kreisel.estimate.strapdown",
    "KalibrImu": "kreisel.files.kalibr",
    "line": "kreisel.simulate.trajectories.line",
    "lissajous": "kreisel.simulate.trajectories.lissajous",
    "lying_eight": "kreisel.simulate.trajectories.lying_eight",
    "MekfFilter": "kreisel.estimate.filters.mekf",
    "Misalignment": "kreisel.simulate.effects.misalignment",
    "monte_carlo": "kreisel.study.monte_carlo",
    "Motion": "kreisel.data.motion",
    "motion_errors": "kreisel.evaluate.motion_errors",
    "MotionDefinition": "kreisel.data.motion_definition",
    "MotionErrors": "kreisel.evaluate.motion_errors",
    "MotionProfile": "kreisel.simulate.trajectories.profile",
    "Mount": "kreisel.data.motion",
    "NoiseModel": "kreisel.data.noise",
    "Nonlinearity": "kreisel.simulate.effects.nonlinearity",
    "Note": "kreisel.data.motion",
    "Poses": "kreisel.data.trajectory",
    "profile": "kreisel.simulate.trajectories.profile",
    "Quantisation": "kreisel.simulate.effects.quantisation",
    "Range": "kreisel.simulate.effects.range",
    "read": "kreisel.files.doors",
    "read_blocks": "kreisel.files.blocks",
    "read_kalibr": "kreisel.files.kalibr",
    "read_profile": "kreisel.files.profiles",
    "read_waypoints": "kreisel.files.waypoints",
    "Recorded": "kreisel.simulate.recorded",
    "Reference": "kreisel.data.attitude",
    "rest": "kreisel.simulate.trajectories.rest",
    "round_trip": "kreisel.study.round_trip",
    "rounded_rectangle": "kreisel.simulate.trajectories.rounded_rectangle",
    "run": "kreisel.estimate.run",
    "run_all": "kreisel.estimate.batch",
    "run_batch": "kreisel.estimate.batch",
    "run_long": "kreisel.estimate.long",
    "run_blocks": "kreisel.study.engine",
    "smooth": "kreisel.estimate.smooth",
    "smooth_all": "kreisel.estimate.smooth",
    "SampledTrajectory": "kreisel.simulate.trajectories.sampled",
    "Sampling": "kreisel.simulate.clock",
    "ScaleFactor": "kreisel.simulate.effects.scale_factor",
    "Scenario": "kreisel.study.scenario",
    "Segment": "kreisel.data.segment",
    "Smoothing": "kreisel.data.smoothing",
    "Stream": "kreisel.estimate.stream",
    "TemperatureBias": "kreisel.simulate.effects.temperature_bias",
    "sweep": "kreisel.study.sweep",
    "TemperatureHistory": "kreisel.data.temperature",
    "TemperatureScale": "kreisel.simulate.effects.temperature_scale",
    "Trajectory": "kreisel.data.trajectory",
    "Trial": "kreisel.data.trial",
    "tune": "kreisel.study.tune",
    "TurnOnBias": "kreisel.simulate.effects.turn_on_bias",
    "VibrationLines": "kreisel.simulate.effects.vibration_lines",
    "VibrationNoise": "kreisel.simulate.effects.vibration_noise",
    "Waypoint": "kreisel.data.waypoint",
    "waypoints": "kreisel.simulate.trajectories.waypoints",
    "WaypointTrajectory": "kreisel.simulate.trajectories.waypoints",
    "WhiteNoise": "kreisel.simulate.effects.white_noise",
    "write": "kreisel.files.doors",
    "write_blocks": "kreisel.files.blocks",
    "write_kalibr": "kreisel.files.kalibr",
}

__all__ = ["__version__", *sorted(_HOMES)]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        from importlib import import_module

        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'kreisel' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
