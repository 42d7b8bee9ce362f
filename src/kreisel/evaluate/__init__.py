"""Truth and estimate in, errors out; recordings in, what is wrong with a sensor out."""
