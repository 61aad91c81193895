"""Peak memory and time of `atm fuse` on a recording of 2 GB, most of it images that nobody asked for, and on one a tenth as long.

    python benches/large_recording.py target/release/atm [gigabytes]

Needs what `scripts/test-python` installs (target/python/environment). From a file and from a pipe, in chunks and without, compressed
and not. Says nothing about what is right: the tests do.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "crates" / "atm-py" / "tests"))

from mcap.writer import CompressionType, Writer  # noqa: E402
from recordings import BARE, SECOND, START, Drive, Ros, Said, usual  # noqa: E402
from rosbags.typesys import Stores  # noqa: E402

IMAGE = 4 << 20


def write(path: Path, size: int, options: dict[str, Any]) -> None:
    """A drive of so many bytes: an image for each tenth of a second, of which each compresses by a half."""
    ros, image = Ros(Stores.ROS2_HUMBLE), os.urandom(IMAGE // 2) + bytes(IMAGE // 2)
    drive = Drive.of(size / IMAGE / 10)
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=1 << 20, **options)
        writer.start("ros2", "bench")
        schemas: dict[str, int] = {}
        channels: dict[str, int] = {}
        camera = writer.register_schema("sensor_msgs/msg/Image", "ros2msg", b"uint8[] data")
        camera = writer.register_channel("/camera", "cdr", camera)
        shown = START

        def put(said: Said) -> None:
            if said.topic not in channels:
                name, encoding, text = ros.schema(said.type)
                if said.type not in schemas:
                    schemas[said.type] = writer.register_schema(name, encoding, text)
                channels[said.topic] = writer.register_channel(said.topic, "cdr", schemas[said.type])
            writer.add_message(channels[said.topic], said.log, ros.message(said), said.log)

        for said in usual(drive):
            put(said)
            while shown < said.log:
                writer.add_message(camera, shown, image, shown)
                shown += SECOND // 10
        writer.finish()


def peak(process: subprocess.Popen[bytes]) -> float:
    """The most memory that a running process has had so far, in MiB; 0 when it has ended."""
    try:
        status = Path(f"/proc/{process.pid}/status").read_text()
    except OSError:
        return 0.0
    found = re.search(r"VmHWM:\s*(\d+) kB", status)
    return int(found[1]) / 1024 if found else 0.0


def run(command: list[str], stdin: Path | None) -> tuple[float, float]:
    """Seconds and MiB of a run; what the command takes in its last hundredth of a second is not seen."""
    begin, most = time.perf_counter(), 0.0
    source = None if stdin is None else subprocess.Popen(["cat", str(stdin)], stdout=subprocess.PIPE)
    silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    child = subprocess.Popen(command, stdin=source.stdout if source else subprocess.DEVNULL, **silent)
    while child.poll() is None:
        most = max(most, peak(child))
        time.sleep(0.01)
    assert child.returncode == 0, command
    return time.perf_counter() - begin, most


def main() -> None:
    atm, size = str(Path(sys.argv[1]).resolve()), float(sys.argv[2]) if len(sys.argv) > 2 else 2.0
    layouts = {
        "no chunks": BARE,
        "chunks": {"compression": CompressionType.NONE},
        "zstd": {"compression": CompressionType.ZSTD},
    }
    with tempfile.TemporaryDirectory() as folder:
        for name, options in layouts.items():
            for share in (0.1, 1.0):
                log = Path(folder, "drive.mcap")
                write(log, int(size * share * 2**30), options)
                length = log.stat().st_size / 2**20
                ways = {"file": ([atm, "fuse", str(log)], None), "pipe": ([atm, "fuse", "-"], log)}
                ways["passthrough"] = ([atm, "fuse", str(log), "--passthrough", "-o", f"{folder}/out.mcap"], None)
                for way, (command, stdin) in ways.items():
                    seconds, memory = run(command, stdin)
                    print(f"{name:10} {length:6.0f} MiB  {way:12} {memory:6.1f} MiB  {seconds:6.2f} s", flush=True)


if __name__ == "__main__":
    main()
