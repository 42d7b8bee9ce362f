"""Names of the places in the flat float64 arrays that the kernels of the DCM filter work on."""

# ---- state of every step of this filter: first the answer, read after each sample, then what is not
R = 0  # 9 places: R_NS row by row, that is east, north and up in sensor axes
BIAS = 9  # 3: gyro bias in sensor axes, rad/s
FLAGS = 12  # REST + DISTURBED + HELD of the latest sample
HEADING = 13  # rad, what magnetometer samples have turned the answer by, about up
ANSWER = 14
LEVELLED = 14  # 1 once an accelerometer sample (or a given attitude) has set the inclination
NORTHED = 15  # 1 once a magnetometer sample (or a given attitude) has set the heading
RATE = 16  # 3: latest good gyro sample, which bridges short gaps, rad/s
GAP = 19  # s, how long the gyro has been missing
COMMON_STATE = 20

# ---- state of the default step
# Errors in the order of the covariance: attitude in N, horizontal velocity, bias, and the matrix C below.
THETA, V, B, C = 0, 3, 5, 8
ERRORS = 17

VELOCITY = 20  # 2: sum of the horizontal specific force less its corrections, m/s
SCALE = 22  # 9: C, by which C @ gyro + bias is what the gyro reads too much
COVARIANCE = 31  # 17 x 17
FIELD = 320  # 2: reference of the magnetic field, horizontal and up, unit of the magnetometer
FIELD_TIME = 322  # s, how long the reference has been learned
CANDIDATE = 323  # 3: latest field in motion, horizontal, up, and its variance
DEVIATION = 326  # peak, slowly released, of the squared deviation of the field from the reference
REST_TIME = 327  # s, how long the sensor has been at rest
STRETCH = 328  # 4: sums of gyro times dt and of dt over the current stretch of rest
STUCK = 332  # rad, rotation since the magnetometer last read anything new
LATEST_MAG = 333  # 3
# Sums over the current window, set to zero at its end.
SUMS = 336
LENGTH = 336  # s
GYRO_SUM = 337  # 3, times dt
GYRO_SQUARES = 340
ACCEL_SUM = 341  # 3, times dt
ACCEL_SQUARES = 344
ACCEL_TIME = 345  # s, of accelerometer samples that count
FORCE_SUM = 346  # 3: specific force in N, times dt
MAG_SUM = 349  # 3: field in N
MAG_COUNT = 352
MISSING = 353  # s, without a gyro
TURN_BY_BIAS = 354  # 3 x 3: -sum of R dt
TURN_BY_SCALE = 363  # 3 x 9: -sum of R (x) gyro dt
SUBTIME = 390  # s, since the two were last summed
SUBTURN = 391  # 3: gyro times dt since then
SUMS_END = 394
CALM = 394  # REST + DISTURBED as of the latest window
CORRECTION = 395  # 17: errors found in this window
COLUMN = 412  # 17: scratch
WAITING = 429  # 4: the stretch before, whose mean is believed once the current one is complete
SIZE = 433

# ---- bits of FLAGS
REST = 1
DISTURBED = 2
HELD = 4

# ---- parameters of every step of this filter
START_NORTH = 0  # 1 where the first attitude wants a magnetometer sample
DECLINATION = 1  # 2 places: cosine and sine of how far magnetic north lies east of true north
HOLD = 3  # s, longest gap of the gyro that is bridged by its latest sample
COMMON_PARAMETERS = 4
