"""One file per kind of trajectory; each turns a description of a path into a Trajectory.

A plug-in is a module with a function ``example() -> Trajectory`` that builds one with sensible values;
the contract tests sample it. Its public class or function carries the module's idea as its name.
"""

from __future__ import annotations

from typing import Protocol

from kreisel.data.trajectory import Trajectory


class TrajectoryPlugin(Protocol):
    """What a module in this folder offers beside its public names."""

    def example(self) -> Trajectory:
        """A trajectory made with sensible values."""
        ...
