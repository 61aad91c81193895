"""What is written can be run: the tour, the docstrings, the example on the recording."""

from __future__ import annotations

import doctest
import inspect
import os
import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import atm
import atm.plot

os.environ.setdefault("MPLBACKEND", "Agg")


def blocks(path: Path) -> list[tuple[int, str]]:
    """The ```python blocks of a document, each with its first line's number."""
    text = path.read_text()
    return [
        (text.count("\n", 0, match.start(1)) + 1, match.group(1))
        for match in re.finditer(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    ]


def test_every_block_of_the_tour_runs(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for needed in ("pandas", "polars", "pyarrow", "matplotlib"):
        pytest.importorskip(needed)
    tour = root / "docs" / "python.md"
    (tmp_path / "examples").mkdir()
    shutil.copy(root / "examples" / "doorway.csv", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    found = blocks(tour)
    assert len(found) >= 10
    names: dict[str, Any] = {"__name__": "tour"}
    for line, block in found:
        # Padded, so that a traceback has the document's own line numbers.
        exec(compile("\n" * (line - 1) + block, str(tour), "exec"), names)
    assert (tmp_path / "doorway.png").stat().st_size > 10_000


def public_objects() -> list[tuple[str, Any]]:
    """Everything public, with the members of its classes."""
    found = []
    for module in (atm, atm.plot):
        names = getattr(module, "__all__", None) or [name for name in vars(module) if not name.startswith("_")]
        for name in names:
            value = getattr(module, name)
            if inspect.ismodule(value):
                continue
            found.append((f"{module.__name__}.{name}", value))
            if inspect.isclass(value):
                found += [
                    (f"{module.__name__}.{name}.{member}", inspect.getattr_static(value, member))
                    for member in vars(value)
                    if not member.startswith("_")
                ]
    return found


def test_everything_public_is_described() -> None:
    found = public_objects()
    names = {name for name, _ in found}
    needed = "Rig Sensor Fuser Echo fuse crossings fuse_file fuse_table plan Rig.ring Rig.load Fuser.push".split()
    assert {f"atm.{name}" for name in needed} <= names
    bare = [name for name, value in found if not (getattr(value, "__doc__", None) or "").strip() and name != "atm.__version__"]
    assert bare == []


@pytest.mark.parametrize("name", ["fuse", "crossings", "fuse_file", "fuse_table", "plan"])
def test_docstrings_name_every_parameter(name: str) -> None:
    function = getattr(atm, name)
    description = inspect.getdoc(function) or ""
    for section in ("Parameters", "Returns", "Raises"):
        assert f"{section}\n---" in description, section
    for parameter in inspect.signature(function).parameters:
        assert re.search(rf"\b{parameter}\b", description), parameter


def test_docstring_examples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    parser, runner, tried = doctest.DocTestParser(), doctest.DocTestRunner(optionflags=doctest.ELLIPSIS), 0
    said: list[str] = []
    objects = [("atm", atm), ("atm.plot", atm.plot), *public_objects()]
    for name, value in objects:
        description = inspect.cleandoc(getattr(value, "__doc__", None) or "")
        names = {"atm": atm, **(vars(atm.plot) if name.startswith("atm.plot") else {})}
        test = parser.get_doctest(description, names, name, None, 0)
        if test.examples:
            tried += 1
            runner.run(test, out=said.append)
    assert runner.summarize(verbose=False).failed == 0, "".join(said)
    assert tried >= 4


def test_example_on_the_recording(root: Path, sonar_tables: Path, tmp_path: Path, capsys: Any, monkeypatch: Any) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    monkeypatch.setenv("SONAR_TABLES", str(sonar_tables))
    monkeypatch.chdir(tmp_path)
    import matplotlib.pyplot as plt

    # Agg can't show; that it was asked to is all the same here.
    monkeypatch.setattr(plt, "show", lambda: None)
    names = runpy.run_path(str(root / "examples" / "recording.py"))
    said = capsys.readouterr().out
    assert "3304 readings; nothing came back of 1068" in said
    # docs/logs.md says the same of the command.
    assert "827 center, 64 median, 77 single" in said
    names["figure"].savefig(tmp_path / "recording.png", dpi=100)
    plt.close("all")
    assert list(tmp_path.iterdir()) == [tmp_path / "recording.png"]


USE = """
import numpy as np
import atm
import atm.plot

rig = atm.Rig.ring(count=16, radius=0.2286, field_of_view=0.39, min_range=0.15, max_range=6.4)
columns = (np.zeros(3), np.zeros(3), [0.0, 1.0, 2.0], np.zeros(3))
echoes = atm.fuse(
    np.zeros(3), ["0", "1", "2"], *columns, rig=rig, history=10, min_angle=0.5, range_resolution=0.0254, emit="settled"
)
x: float = float(echoes["x"][0])
fuser = atm.Fuser(rig, history=10)
found: list[atm.Echo] = fuser.push(0.0, "0", 1.0, 0.0, 0.0, 0.0)
name: str = found[0].kind
at: float = found[0].x
counts = atm.fuse_file("drive.csv", rig="robot.toml", output="echoes.csv")
plan = atm.plan(distance=2.54, improvement=10)
atm.plot.echoes(echoes, None).set_title("echoes")
"""


@pytest.fixture(scope="module")
def type_cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What mypy knows of numpy, found out once."""
    return tmp_path_factory.mktemp("mypy")


CHECKS = [["mypy", "--strict", "-p", "atm"], ["mypy", "--strict", "use.py"], ["mypy.stubtest", "atm"]]


@pytest.mark.parametrize("arguments", CHECKS, ids=["package", "use", "stub"])
def test_types(arguments: list[str], tmp_path: Path, type_cache: Path) -> None:
    """The installed package's own types, a use of it, and whether its stub tells the truth."""
    pytest.importorskip("mypy")
    (tmp_path / "use.py").write_text(USE)
    environment = {**os.environ, "MYPY_CACHE_DIR": str(type_cache)}
    line = [sys.executable, "-m", *arguments]
    done = subprocess.run(line, capture_output=True, text=True, cwd=tmp_path, env=environment, timeout=120, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
