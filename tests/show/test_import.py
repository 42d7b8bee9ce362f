"""What importing costs."""

from __future__ import annotations

import subprocess
import sys

import pytest

import kreisel.show


def test_importing_show_loads_no_plotting_library() -> None:
    code = "import sys, kreisel.show; print(*(m for m in ('matplotlib', 'PIL') if m in sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""


def test_every_public_name_is_there_and_no_other() -> None:
    for name in kreisel.show.__all__:
        assert callable(getattr(kreisel.show, name)) and name in dir(kreisel.show)
    with pytest.raises(AttributeError, match="plot_everything"):
        kreisel.show.plot_everything  # noqa: B018
