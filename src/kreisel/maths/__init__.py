"""Arrays in, arrays out: rotations, kinematics, exact and numeric derivatives."""
