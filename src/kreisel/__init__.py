"""Trajectories to inertial sensor data, and inertial sensor data back to attitude."""
