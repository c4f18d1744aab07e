"""Warp starts without its message about a missing CUDA driver, and prints all other messages."""

import os
import subprocess
import sys

import pytest
import warp

from urbanverse_mjx.simulation import warp_start


@pytest.mark.extended
def test_the_engines_package_is_quiet_about_cuda() -> None:
    code = "import urbanverse_mjx.simulation, warp; warp.init()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "CUDA" not in done.stdout + done.stderr


def test_whatever_else_warp_says_is_passed_on(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    text = f"first\n{warp_start.NO_DRIVER}. GPU execution will not be available.\nlast\n"
    monkeypatch.setattr(warp, "init", lambda: os.write(2, text.encode()))
    monkeypatch.setattr(warp_start, "has_cuda_driver", lambda: False)
    warp_start.start_warp()
    os.write(2, b"after\n")
    assert capfd.readouterr().err == "first\nlast\nafter\n"
    monkeypatch.setattr(warp_start, "has_cuda_driver", lambda: True)
    warp_start.start_warp()
    assert capfd.readouterr().err == text, "where there is a driver its troubles are told"
