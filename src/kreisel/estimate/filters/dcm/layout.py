"""Turns the flat float64 arrays that the kernels of the DCM filter work on into named places."""

from kreisel.estimate.filters import ANSWER, DISTURBED, FLAGS, GYRO_BIAS, HEADING, HELD, R_NS, REST

# ---- State of every step: the answer as all filters have it (R_NS, GYRO_BIAS, FLAGS, HEADING), then this.
__all__ = ["ANSWER", "DISTURBED", "FLAGS", "GYRO_BIAS", "HEADING", "HELD", "R_NS", "REST"]
LEVELLED = 14  # 1 once an accelerometer sample (or a given attitude) has set the inclination
NORTHED = 15  # 1 once a magnetometer sample (or a given attitude) has set the heading
CALM = 16  # flags that last: REST + DISTURBED as of the latest window, HELD until levelled
RATE = 17  # 3: latest good gyro sample, which bridges short gaps, rad/s
GAP = 20  # s, how long the gyro has been missing
MISSING = (
    21  # rad^2, variance of the attitude that missing samples of the gyro have made since the window began
)
PUBLISHED_STATE = 22

# ---- State of the default step.
# Order of the errors: attitude in N, horizontal velocity, travel, then what is constant: bias, columns of the matrix C
# by which a gyro reads C @ gyro too much.
THETA = 0
V = 3
U = 5  # velocity in body axes
B = 8
C = 11
ERRORS = 20
CONSTANTS = 12  # the last so many of them

VELOCITY = 22  # 2: sum of the horizontal specific force less its corrections, m/s
SCALE = 24  # 9: C, column by column
TRAVEL = 33  # 3: velocity that the body keeps in its own axes, m/s
COVARIANCE = 36  # 20 x 20
CORRECTION = 436  # 20: errors found in this window
COLUMN = 456  # 20: scratch
FIELD = 476  # 2: reference of the magnetic field, horizontal and up, in the magnetometer's unit
FIELD_TIME = 478  # s, how long the reference has been learned
CANDIDATE = 479  # 3: recent field in motion, horizontal and up, and its variance
STEADY = 482  # s of motion through which the candidate has stayed the same
DEVIATION = 483  # squared deviation of the field from the reference, its peaks slowly released
STUCK = 484  # rad, rotation since the magnetometer last read anything new
LATEST_MAG = 485  # 3
# The memory of rest: these three in this order (see rest).
REST_TIME = 488  # s, how long the sensor has been at rest
STRETCH = 489  # 4: sums of gyro times dt and of dt over the current stretch of rest
WAITING = 493  # 4: the stretch before, whose mean is believed once the current one is complete
NEXT_PART = 497  # s into the window, when TURN is next due
# Sums over the current window, zero at its start.
SUMS = 498
# The first six in this order for rest, and TURN before SUMMED for linearise.
LENGTH = 498  # s
GYRO_SUM = 499  # 3: times dt
GYRO_SQUARES = 502
ACCEL_SUM = 503  # 3: times dt
ACCEL_SQUARES = 506
ACCEL_TIME = 507  # s, of accelerometer samples that count
FORCE_SUM = 508  # 2: horizontal specific force times dt
MAG_SUM = 510  # 3: field in N
MAG_COUNT = 513
TURN = 514  # 3 x 12: what an error of each of the constants turns the attitude by
SUMMED = 550  # 4: LENGTH and GYRO_SUM that TURN already holds
SUMS_END = 554
STATE = 554

# ---- Parameters of every step.
START_NORTH = 0  # 1 where the first attitude wants a magnetometer sample
DECLINATION = 1  # 2: cosine and sine of how far magnetic north lies east of true north
HOLD = 3  # s, longest gap of the gyro that is bridged by its latest sample

# ---- Parameters of the published step.
WEIGHT_GYRO = 4
WEIGHT_ACCEL = 5
WEIGHT_MAG = 6
OBSERVED = 7  # 1: a weight counts only around the axes that its sensor observes
EXACT = 8  # 1: the axes are rotated by Exp(dtheta) instead of moved by dtheta x r
RATE_HZ = 9  # > 0: the weights are those of this sampling rate; others keep its time constants
PUBLISHED_PARAMETERS = 10

# ---- Parameters of the default step.
DOF = 4  # 9, 6 or 0 (gyro alone)
CONING = 5  # 1/12 where a gyro sample is the mean of a rate whose axis turns, else 0
WINDOW = 6  # s
GYRO_NOISE = 7  # rad/s/sqrt(Hz)
RATE_NOISE = 8  # 1/sqrt(Hz), of the rate
BIAS_DRIFT = 9  # rad/s/sqrt(s)
SCALE_DRIFT = 10  # 1/sqrt(s)
VELOCITY_NOISE = 11  # m/s/sqrt(Hz)
HEADING_NOISE = 12  # rad/sqrt(Hz)
FIELD_SPREAD = 13  # of the norm of the field
FIELD_RELEASE = 14  # s
FIELD_MEMORY = 15  # s
REST_GYRO = 16  # rad/s
REST_ACCEL = 17  # m/s^2
TRAVEL_SPREAD = 18  # m/s
TRAVEL_TIME = 19  # s
TILT_TIME = 20  # s, over which a tilt's errors are one
PARAMETERS = 21
