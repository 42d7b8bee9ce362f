"""Closes the loop between what is simulated, estimated and evaluated: scenarios, runs and benchmarks."""
