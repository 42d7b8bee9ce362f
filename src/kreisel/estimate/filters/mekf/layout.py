"""Turns the flat float64 arrays that the kernels of the error-state filter work on into named places."""

from kreisel.estimate.filters import ANSWER, DISTURBED, FLAGS, GYRO_BIAS, HEADING, HELD, R_NS, REST

# How a filter starts, holds and bridges is the DCM filter's, and so are the places for it.
from kreisel.estimate.filters.dcm.layout import CALM, GAP, LEVELLED, MISSING, NORTHED, RATE

__all__ = ["ANSWER", "DISTURBED", "FLAGS", "GYRO_BIAS", "HEADING", "HELD", "R_NS", "REST"]
__all__ += ["CALM", "GAP", "LEVELLED", "MISSING", "NORTHED", "RATE"]

# ---- Order of the errors, estimate less truth.
THETA = 0  # 3: attitude in N, R_est = Exp(theta) R_true
V = 3  # 2: horizontal velocity in N
U = 5  # 3: travel, the velocity that a body keeps in its own axes
B = 8  # 3: gyro bias
C = 11  # 9: gyro scale and misalignment, columns of the matrix by which a gyro reads C @ gyro too much
CONSTANTS = 12  # B and C
D = 20  # what turns the field away from north, here and now
A = 21  # 3: accelerometer bias, m/s^2
L = 24  # s, by how much samples of the accelerometer are older than those of the gyro
S = 25  # 2: horizontal way, m, that V less travel has made since SPAN began
ERRORS = 27

# ---- State after the places that all steps have.
SIGMA = 22  # 3: standard deviations of THETA
VELOCITY = 25  # 2: sum of the horizontal specific force less its corrections, m/s
SCALE = 27  # 9: C, column by column
TRAVEL = 36  # 3: m/s
TURNED = 39  # D, rad
ACCEL_BIAS = 40  # 3: A, m/s^2
LAG = 43  # L, s
MADE = 44  # 2: S, m
SPAN = 46  # s that S has been summed over
FIELD = 47  # 2: reference of the magnetic field, horizontal and up, in the magnetometer's unit
FIELD_TIME = 49  # s, how long the reference has been learned
CANDIDATE = 50  # 3: recent field in motion, horizontal and up, and its variance
STEADY = 53  # s of motion through which the candidate has stayed the same
DEVIATION = 54  # squared deviation of the field from the reference, its peaks slowly released
SPREAD = 55  # variance that D was last given
STUCK = 56  # rad, rotation since the magnetometer last read anything new
LATEST_MAG = 57  # 3
CONTRARY = 60  # rad, mean of late by which trusted fields say that the heading is off
# The memory of rest: these three in this order (see rest).
REST_TIME = 61  # s, how long the sensor has been at rest
STRETCH = 62  # 4: sums of gyro times dt and of dt over the current stretch of rest
WAITING = 66  # 4: the stretch before, whose mean is believed once the current one is complete
SURPRISE = 70  # 2: velocities that surprised, low-passed, m/s
ROAMING = 72  # squared noise of the velocity as of late, m^2/s^2/Hz
MEAN_FORCE = 73  # 3: specific force in N, low-passed, m/s^2
CLIPPED = 76  # s, for which an axis of the gyro has read the same rate
LATEST_ACCEL = 77  # 3
UNMOVED = 80  # 3: m/s^2, by which turning must have changed an axis of the accelerometer that reads the same
JUDGED = 83  # s, for which the noise of the velocity has been learned
WANDERING = 84  # the same noise as ROAMING, however large
MEAN_SQUARE = 85  # of the specific force, low-passed, m^2/s^4
NEXT_PART = 86  # s into the window, when TURN is next due
WINDOWS = 87  # how many have closed
CHANGED = 88  # m/s, by how much the velocity has changed since a start in motion; 0 once its level is found
SOUGHT = 89  # s, for which that level has been sought
MOMENTS = 90  # 6: of the specific force in N, times that time and times its square
REPEATING = 96  # 2: share of readings of a turning gyro's axes, and of the accelerometer's, that repeat
RUNS = 98  # 4: readings for which the gyro, and each axis of the accelerometer, have repeated
COVARIANCE = 102  # 27 x 27
CORRECTION = COVARIANCE + ERRORS**2  # 27: errors found in the latest window

# How the latest window moved the errors, for whoever looks back.
CHANGE = CORRECTION + ERRORS  # TURN of the window, then what follows
CHANGE_FORCE = CHANGE + 3 * CONSTANTS  # s, for which the force was summed
CHANGE_LENGTH = CHANGE_FORCE + 1  # s, all of it
CHANGE_KEPT = CHANGE_LENGTH + 1  # 3: share that is kept of U, of D and of S
CHANGE_LAG = CHANGE_KEPT + 3  # 2: what a lag of one second pushes by, m/s
EXCESS = CHANGE_LAG + 2  # 1: what the variance of the tilt is more than P says
OBSERVED = EXCESS + 1  # how many observations the window made, of those below
OBSERVATIONS = (
    OBSERVED + 1
)  # 6 times: row of the observation, its covariance with all errors, surprise, variance
OBSERVATION = 2 * ERRORS + 2
MOST = 6
LOG_END = OBSERVATIONS + MOST * OBSERVATION
LOG = LOG_END - COVARIANCE

NOTHING = -1.0  # in place of CHANGE_FORCE: nothing was known before this window

# Sums over the current window, zero at its start.
SUMS = LOG_END
# The first six in this order for rest, and TURN before SUMMED for linearise.
LENGTH = SUMS  # s
GYRO_SUM = SUMS + 1  # 3: times dt
GYRO_SQUARES = SUMS + 4
ACCEL_SUM = SUMS + 5  # 3: times dt
ACCEL_SQUARES = SUMS + 8
ACCEL_TIME = SUMS + 9  # s, of accelerometer samples that count
FORCE_SUM = SUMS + 10  # 3: specific force in N, times dt
LAG_SUM = SUMS + 13  # 2: horizontal part of rate x force, times dt
MAG_SUM = SUMS + 15  # 3: field in N
MAG_COUNT = SUMS + 18
TURN = SUMS + 19  # 3 x 12: what an error of each of the constants turns the attitude by
SUMMED = TURN + 3 * CONSTANTS  # 4: LENGTH and GYRO_SUM that TURN already holds
SUMS_END = SUMMED + 4

MEAN_TIME = SUMS_END  # s of MEAN_FORCE, no more than it remembers
DUE = MEAN_TIME + 1  # 1 where a window has closed or a second filter runs
# How well a contest between two filters has gone since it began.
SCORE = DUE + 1  # m^2/s, sum of squared surprises of the velocity times dt
SCORED = SCORE + 1  # s that it was summed over
FIELD_SUM = SCORE + 2  # 3: sum of the field in N times dt
FIELD_SUMMED = SCORE + 5  # s that it was summed over
ONE = FIELD_SUMMED + 1

# ---- Behind the first filter's state that of a second one, and since when that one runs.
RIVAL = ONE
AGE = 2 * ONE  # s, 0 where there is none
STATE = 2 * ONE + 1

# ---- Parameters; the first three are those of every step of the DCM filter.
START_NORTH = 0  # 1 where the first attitude wants a magnetometer sample
DECLINATION = 1  # 2: cosine and sine of how far magnetic north lies east of true north
HOLD = 3  # s, longest gap of the gyro that is bridged by its latest sample
DOF = 4  # 9, 6 or 0 (gyro alone)
CONING = 5  # 1/12 where a gyro sample is the mean of a rate whose axis turns, else 0
WINDOW = 6  # s
GYRO_NOISE = 7  # rad/s/sqrt(Hz)
RATE_NOISE = 8  # 1/sqrt(Hz), of the rate
BIAS_DRIFT = 9  # rad/s/sqrt(s)
SCALE_DRIFT = 10  # 1/sqrt(s)
VELOCITY_NOISE = 11  # 2: least and most, m/s/sqrt(Hz)
TRAVEL_SPREAD = 13  # m/s
TRAVEL_TIME = 14  # s
ACCEL_SPREAD = 15  # m/s^2
FIELD_SPREAD = 16  # of the norm of the field
FIELD_TIME_CONSTANT = 17  # s
FIELD_NOISE = 18  # 1/sqrt(Hz), of the norm of the field
FIELD_RELEASE = 19  # s
FIELD_MEMORY = 20  # s
TAIL = 21  # degrees of freedom of the heading's surprises
REST_GYRO = 22  # rad/s
REST_ACCEL = 23  # m/s^2
SPAN_LENGTH = 24  # s
FIRST_SIGMA = 25  # 27: deviation of every error before any sample
PARAMETERS = FIRST_SIGMA + ERRORS
