"""Names of the places in the flat float64 arrays that the kernels of the DCM filter work on."""

# ---- state that every step of this filter keeps: first what is read after each sample, then what is not
R = 0  # 9 places: R_NS row by row, that is east, north and up in sensor axes
BIAS = 9  # 3: gyro bias in sensor axes, rad/s
FLAGS = 12  # REST + DISTURBED + HELD of the latest sample
ANSWER = 13
LEVELLED = 13  # 1 once an accelerometer sample (or a given attitude) has set the inclination
NORTHED = 14  # 1 once a magnetometer sample (or a given attitude) has set the heading
RATE = 15  # 3: latest finite gyro sample, which bridges short gaps, rad/s
GAP = 18  # how long the gyro has been missing, s
COMMON_STATE = 19

# ---- bits of FLAGS
REST = 1
DISTURBED = 2
HELD = 4

# ---- parameters that every step of this filter shares
START_NORTH = 0  # 1 where the first attitude needs a magnetometer sample
DECLINATION = 1  # 2 places: cosine and sine of how far magnetic north lies east of true north
HOLD = 3  # s, longest gap of the gyro that is bridged by its latest sample
COMMON_PARAMETERS = 4
