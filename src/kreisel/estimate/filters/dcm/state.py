"""Names of the places in the flat float64 arrays that the kernels of the DCM filter work on."""

# ---- state of every step of this filter: first the answer, read after each sample, then what is not
R = 0  # 9 places: R_NS row by row, that is east, north and up in sensor axes
BIAS = 9  # 3: gyro bias in sensor axes, rad/s
FLAGS = 12  # REST + DISTURBED + HELD of the latest sample
HEADING = 13  # rad, by what magnetometer samples have turned the answer about up
ANSWER = 14
LEVELLED = 14  # 1 once an accelerometer sample (or a given attitude) has set the inclination
NORTHED = 15  # 1 once a magnetometer sample (or a given attitude) has set the heading
CALM = 16  # flags that last: REST + DISTURBED as of the latest window, HELD until levelled
RATE = 17  # 3: latest good gyro sample, which bridges short gaps, rad/s
GAP = 20  # s, how long the gyro has been missing
MISSING = 21  # s, the same since the window began
COMMON = 22

# ---- state of the default step
# Errors in the order of their covariance: attitude in N, horizontal velocity, bias, columns of the scale matrix.
V, B, C = 3, 5, 8
ERRORS = 17

VELOCITY = 22  # 2: sum of the horizontal specific force less its corrections, m/s
SCALE = 24  # 9: C column by column; the gyro reads C @ gyro + bias too much
COVARIANCE = 33  # 17 x 17
CORRECTION = 322  # 17: errors found in this window
COLUMN = 339  # 17: scratch
FIELD = 356  # 2: reference of the magnetic field, horizontal and up, in the magnetometer's unit
FIELD_TIME = 358  # s, how long the reference has been learned
CANDIDATE = 359  # 3: recent field in motion, horizontal and up, and its variance
DEVIATION = 362  # squared deviation of the field from the reference, its peaks slowly released
REST_TIME = 363  # s, how long the sensor has been at rest
STRETCH = 364  # 4: sums of gyro times dt and of dt over the current stretch of rest
WAITING = 368  # 4: the stretch before, whose mean is believed once the current one is complete
STUCK = 372  # rad, rotation since the magnetometer last read anything new
LATEST_MAG = 373  # 3
NEXT_PART = 376  # s into the window, when the sums of TURN_BY are next due
# Sums over the current window, zero at its start.
SUMS = 377
LENGTH = 377  # s
GYRO_SUM = 378  # 3: times dt
GYRO_SQUARES = 381
ACCEL_SUM = 382  # 3: times dt
ACCEL_SQUARES = 385
ACCEL_TIME = 386  # s, of accelerometer samples that count
FORCE_SUM = 387  # 3: specific force in N times dt
MAG_SUM = 390  # 3: field in N
MAG_COUNT = 393
TURN_BY_BIAS = 394  # 3 x 3: -sum of R dt, what a bias error turns the attitude by
TURN_BY_SCALE = 403  # 3 (columns of C) x 3 x 3: -sum of gyro[k] R dt
SUMMED = 430  # 4: LENGTH and GYRO_SUM that these two already hold
SUMS_END = 434
STEADY = 434  # s of motion through which the candidate has stayed the same
SIZE = 435

# ---- bits of FLAGS
REST = 1
DISTURBED = 2
HELD = 4

# ---- parameters of every step of this filter
START_NORTH = 0  # 1 where the first attitude wants a magnetometer sample
DECLINATION = 1  # 2 places: cosine and sine of how far magnetic north lies east of true north
HOLD = 3  # s, longest gap of the gyro that is bridged by its latest sample
COMMON_PARAMETERS = 4
