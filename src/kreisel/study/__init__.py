"""Closes the loop between simulation, estimation and evaluation."""
