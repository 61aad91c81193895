"""What several tests start from: the repository, the sample drive, and the command of the same package."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import hypothesis
import numpy as np
import pytest

os.environ.setdefault("MPLBACKEND", "Agg")
# The machine may be busy with other tests, and what is slow here is slow because of that; nothing is left in the tree.
hypothesis.settings.register_profile("quiet", deadline=None, print_blob=True, database=None)
hypothesis.settings.load_profile("quiet")

ROOT = Path(__file__).resolve().parents[3]
Readings = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


@pytest.fixture(scope="session")
def root() -> Path:
    """The repository's root."""
    return ROOT


@pytest.fixture(scope="session")
def doorway() -> Readings:
    """The sample: a 16-sensor ring drives past an opening. Times in whole nanoseconds, sensors as integers."""
    table = np.genfromtxt(ROOT / "examples" / "doorway.csv", delimiter=",", names=True)
    # The sample's times are multiples of a millisecond.
    t = np.round(table["t"] * 1000).astype(np.int64) * 1_000_000
    return (t, table["sensor"].astype(np.int64), *(table[name].copy() for name in ("range", "x", "y", "yaw")))


@pytest.fixture(scope="session")
def sonar_tables() -> Path:
    """The recording: loudly skipped where it is missing, a failure where tests run unattended."""
    folder = Path(os.environ.get("ATM_TEST_DATA", ROOT / ".." / "shared" / "data")) / "udacity-sonar8"
    if not (folder / "measurement.txt").exists():
        if os.environ.get("CI"):
            pytest.fail(f"the recording is not in {folder}; ATM_TEST_DATA says where it is")
        pytest.skip(f"the recording is not in {folder}; ATM_TEST_DATA says where it is")
    return folder


@pytest.fixture(scope="session")
def command() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs ``python -m atm`` and hands back what it said."""

    def run(*arguments: object, status: int = 0) -> subprocess.CompletedProcess[str]:
        line = [sys.executable, "-m", "atm", *map(str, arguments)]
        done = subprocess.run(line, capture_output=True, text=True, timeout=60, check=False)
        assert done.returncode == status, f"{line}: {done.returncode}\n{done.stderr}"
        return done

    return run
