"""`atm.fuse_file`, the command, and `atm.plan`: what the command line does, from Python."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import sysconfig
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import atm

SUMMARY = {
    "readings",
    "no_echo",
    "echoes",
    "written",
    "ignored_pairs",
    "skipped",
    "dropped",
    "clock_resets",
    "input_damaged",
}


def test_writes_what_the_command_writes(root: Path, command: Callable[..., Any], tmp_path: Path) -> None:
    log = root / "examples" / "doorway.csv"
    theirs, summary, ours = tmp_path / "theirs.csv", tmp_path / "summary.json", tmp_path / "ours.csv"
    command("fuse", log, "--rig", "nomad200", "--summary", summary, "-o", theirs)
    counts = atm.fuse_file(log, rig="nomad200", output=ours)
    assert ours.read_bytes() == theirs.read_bytes()
    assert counts == json.loads(summary.read_text())
    assert set(counts) >= SUMMARY
    assert counts["echoes"]["median"] == 253
    assert counts["input_damaged"] is False


def test_strings_and_rigs_as_arguments(root: Path, tmp_path: Path) -> None:
    log, out = str(root / "examples" / "doorway.csv"), str(tmp_path / "out.csv")
    first = atm.fuse_file(log, rig=atm.Rig.builtin("nomad200"), output=out)
    assert first == atm.fuse_file(log, rig=root / "rig" / "nomad200.toml", output=out)
    assert first["written"] == len(Path(out).read_text().splitlines()) - 1


def test_options_are_those_of_the_command(root: Path, command: Callable[..., Any], tmp_path: Path) -> None:
    log, theirs, ours = root / "examples" / "doorway.csv", tmp_path / "theirs.csv", tmp_path / "ours.csv"
    arguments = ["--emit", "latest", "--history", "5", "--keep", "median,single", "--on-two", "mean", "--min-step", "0.1"]
    command("fuse", log, "--rig", "nomad200", *arguments, "-o", theirs)
    atm.fuse_file(
        log,
        rig="nomad200",
        output=ours,
        emit="latest",
        history=5,
        keep=["median", "single"],
        on_two="mean",
        min_step=0.1,
    )
    assert ours.read_bytes() == theirs.read_bytes()


def test_poses_from_a_second_file(sonar_tables: Path, command: Callable[..., Any], tmp_path: Path) -> None:
    log, poses = sonar_tables / "measurement.txt", sonar_tables / "poses.txt"
    theirs, ours = tmp_path / "theirs.csv", tmp_path / "ours.csv"
    command("fuse", log, "--rig", "robond8", "--poses", poses, "--drop-held", "-o", theirs)
    counts = atm.fuse_file(log, rig="robond8", poses=poses, output=ours, drop_held=True)
    assert ours.read_bytes() == theirs.read_bytes()
    assert (counts["readings"], counts["skipped"]["held"]) == (1089, 2215)


def flawed(path: Path) -> Path:
    path.write_text("t,sensor,range,x,y,yaw\n0,0,1,0,0,0\n1,99,1,0,0,0\n2,0,one,0,0,0\n3,1,1,0,0,0\n")
    return path


def test_unusable_records_are_counted(tmp_path: Path) -> None:
    counts = atm.fuse_file(flawed(tmp_path / "log.csv"), rig="nomad200", output=tmp_path / "out.csv")
    assert counts["readings"] == 2
    assert sum(counts["dropped"].values()) == 2


@pytest.fixture(scope="module")
def long_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log of many batches."""
    n = 100_000
    k = np.arange(n)
    rows = np.stack([k / 1000, k % 16, np.full(n, 1.5), k * 1e-5, k * 0, k * 0], axis=1)
    log = tmp_path_factory.mktemp("long") / "log.csv"
    np.savetxt(log, rows, delimiter=",", header="t,sensor,range,x,y,yaw", comments="", fmt="%.6g")
    return log


def test_progress_is_told(long_log: Path, tmp_path: Path) -> None:
    """How many bytes were read, and of how many; the last word is that all were."""
    told: list[Any] = []
    out = tmp_path / "out.csv"
    atm.fuse_file(long_log, rig="nomad200", output=out, history=40, progress=lambda *said: told.append(said))
    done, length = zip(*told)
    assert len(told) > 1
    assert list(done) == sorted(done)
    assert set(length) == {long_log.stat().st_size}
    assert done[-1] == length[-1]


def test_a_progress_that_raises_stops_it(long_log: Path, tmp_path: Path) -> None:
    class Enough(Exception):
        pass

    def raises(*_: Any) -> None:
        raise Enough

    out = tmp_path / "out.csv"
    with pytest.raises(Enough):
        atm.fuse_file(long_log, rig="nomad200", output=out, history=40, progress=raises)
    assert not out.exists()


def test_a_missing_column_is_named(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("t,sensor,range,x,y\n0,0,1,0,0\n")
    with pytest.raises(ValueError, match="yaw"):
        atm.fuse_file(log, rig="nomad200", output=tmp_path / "out.csv")
    assert not (tmp_path / "out.csv").exists()


def test_the_words_are_the_commands(command: Callable[..., Any], tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("t,sensor,range,x,y\n0,0,1,0,0\n")
    said = command("fuse", log, "--rig", "nomad200", status=1).stderr
    with pytest.raises(ValueError) as caught:
        atm.fuse_file(log, rig="nomad200", output=tmp_path / "out.csv")
    assert str(caught.value).splitlines()[0] in said


def test_exit_statuses(command: Callable[..., Any], tmp_path: Path) -> None:
    command("fuse", tmp_path / "none.csv", "--rig", "nomad200", status=1)
    command("fuse", "--history", "0", tmp_path / "none.csv", status=2)
    command("fuse", flawed(tmp_path / "log.csv"), "--rig", "nomad200", status=3)
    assert "fuse" in command("--help").stdout


def test_console_script(root: Path) -> None:
    script = shutil.which("atm", path=sysconfig.get_path("scripts"))
    assert script, "the wheel brings no command `atm`"
    line = [script, "plan", "--distance", "100in", "--min-angle", "30deg", "--json"]
    done = subprocess.run(line, capture_output=True, text=True, timeout=60, check=True)
    assert json.loads(done.stdout)["improvement"] == pytest.approx(10.52, abs=0.005)


def test_early_end_of_the_reader_is_no_error(root: Path) -> None:
    import sys

    line = f"{sys.executable} -m atm fuse {root / 'examples' / 'doorway.csv'} --rig nomad200 --quiet | head -n 1"
    done = subprocess.run(["bash", "-o", "pipefail", "-c", line], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("t,sensor,")


def test_plan_of_the_paper() -> None:
    """Section IV-B: 30 degrees and 1 in give 3.73 in, 10.5 times better at 100 in."""
    inch = 0.0254
    plan = atm.plan(distance=100 * inch, min_angle=math.radians(30), range_resolution=inch)
    assert plan["interval_m"] / inch == pytest.approx(3.732, abs=5e-4)
    assert plan["improvement"] == pytest.approx(10.52, abs=5e-3)
    assert plan["close_range_m"] / inch == pytest.approx(9.50, abs=5e-3)
    assert plan["travel_m"] / inch == pytest.approx(51.76, abs=5e-3)
    assert plan["readings"] is None


def test_plan_both_ways_and_readings() -> None:
    inch = 0.0254
    plan = atm.plan(distance=2.54, improvement=10)
    assert math.degrees(plan["min_angle_rad"]) == pytest.approx(28.57, abs=5e-3)
    plan = atm.plan(distance=100 * inch, min_angle=math.radians(30), speed=5 * inch, rate=1.0)
    assert plan["readings"] == 12


def test_plan_is_that_of_the_command(command: Callable[..., Any]) -> None:
    said = command("plan", "--distance", "2.54", "--improvement", "10", "--speed", "0.2", "--rate", "4", "--json").stdout
    assert atm.plan(distance=2.54, improvement=10, speed=0.2, rate=4) == json.loads(said)
