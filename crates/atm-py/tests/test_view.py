"""The page that replays a drive, from Python."""

import html
import pathlib
import re

import atm
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
DOORWAY = ROOT / "examples" / "doorway.csv"


def test_the_page_is_written_and_shown_in_a_frame(tmp_path: pathlib.Path) -> None:
    replay = atm.view(DOORWAY, rig="nomad200", output=tmp_path / "drive.html", world="doorway", set={"opening": "36in"})
    assert replay.path == tmp_path / "drive.html"
    assert replay.path.read_text(encoding="utf-8") == replay.html
    assert len(replay.html) <= 400_000
    shown = replay._repr_html_()
    page = re.fullmatch(r'<iframe title="[^"]*" style="[^"]*" srcdoc="([^"]*)"></iframe>', shown)
    assert page is not None and html.unescape(page[1]) == replay.html


def test_the_page_says_the_call_that_made_it() -> None:
    replay = atm.view(DOORWAY, rig="nomad200", methods=["atm"], history=5)
    said = re.search(r'type="application/json">(.*?)</script>', replay.html, re.DOTALL)
    assert said is not None
    assert "history=5" in said[1] and "methods=['atm']" in said[1]


def test_errors_are_the_commands(tmp_path: pathlib.Path) -> None:
    with pytest.raises(OSError, match="missing.csv"):
        atm.view(tmp_path / "missing.csv", rig="nomad200")
    with pytest.raises(ValueError, match="methods"):
        atm.view(DOORWAY, rig="nomad200", methods=["mean"])
    with pytest.raises(ValueError, match="rig"):
        atm.view(DOORWAY)


def test_records_that_can_not_be_used_are_warned_of(tmp_path: pathlib.Path) -> None:
    log = tmp_path / "drive.csv"
    log.write_text("t,sensor,range,x,y,yaw\n0,0,2.5,0,0,0\nx,0,2.5,0,0,0\n0.1,0,2.4,0.1,0,0\n")
    with pytest.warns(UserWarning, match="1 records"):
        atm.view(log, rig="nomad200")
