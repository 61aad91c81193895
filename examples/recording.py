# %% [markdown]
# # A real corridor: eight sonars, 93 seconds
#
# The recording of Udacity's robotics course (MIT licence) is two tables without headers: `measurement.txt` holds a time in
# milliseconds and the ranges of eight sonars in millimetres, `poses.txt` the same times, x and y in millimetres and the yaw in
# tenths of a degree. Get them once:
#
#     git clone https://github.com/udacity/RoboND-OccupancyGridMappingAlgorithm
#
# and set `SONAR_TABLES` where they are not below this directory. Needs `pip install 'atm-py[plot]'`. Every `# %%` starts a
# cell, in VS Code, Spyder and Jupytext; `python examples/recording.py` runs them all.

# %%
import os
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import atm

TABLES = Path(os.environ.get("SONAR_TABLES", "RoboND-OccupancyGridMappingAlgorithm/Data"))

# %% [markdown]
# ## Reading the tables
#
# All eight sensors share a row's time and pose, so a row becomes eight readings. 5110 stands for "nothing came back".


# %%
def read_sonar_tables(measurements: Path, poses: Path) -> tuple[np.ndarray, ...]:
    """Readings of the two tables, in metres, radians and whole nanoseconds: t, sensor, range, x, y, yaw."""
    table = np.loadtxt(measurements, dtype=np.int64, ndmin=2)
    t_ms, range_mm = table[:, 0], table[:, 1:]
    pose_t_ms, x_mm, y_mm, yaw_tenths = np.loadtxt(poses, ndmin=2).T
    if not np.array_equal(t_ms, pose_t_ms):
        raise ValueError(f"{poses}: its times are not those of {measurements}")
    sensors = range_mm.shape[1]
    return (
        np.repeat(t_ms * 1_000_000, sensors),
        np.tile(np.arange(sensors), len(table)),
        np.where(range_mm == 5110, np.inf, range_mm / 1000).ravel(),
        np.repeat(x_mm / 1000, sensors),
        np.repeat(y_mm / 1000, sensors),
        np.repeat(np.deg2rad(yaw_tenths / 10), sensors),
    )


readings = read_sonar_tables(TABLES / "measurement.txt", TABLES / "poses.txt")
rig = atm.Rig.builtin("robond8")
print(f"{len(readings[0])} readings; nothing came back of {np.isinf(readings[2]).sum()}")

# %% [markdown]
# ## Fusing
#
# The ring repeats a sensor's last value until it has a new one, and a repeated value is drawn where the robot is by now, not where
# it was measured. `drop_held` leaves the repeats out.

# %%
as_it_is = atm.fuse(*readings, rig=rig)
echoes = atm.fuse(*readings, rig=rig, drop_held=True)
for name, found in [("as it is", as_it_is), ("without repeats", echoes)]:
    kinds, counts = np.unique(found["kind"], return_counts=True)
    print(f"{name:16}", ", ".join(f"{count} {kind}" for kind, count in zip(kinds, counts)))

# %% [markdown]
# ## Looking at it
#
# Left the centres of all cones, as a range layer marks them; right what the crossings say. The door jambs along both walls
# come out as groups of plus marks.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5), sharex=True, sharey=True)
cones = atm.fuse(*readings, rig=rig, drop_held=True, min_angle=np.pi / 2, on_two="center")
atm.plot.echoes(cones[cones["kind"] == "center"], left)
atm.plot.arcs(*readings, rig=rig, ax=right)
atm.plot.echoes(echoes, right, kinds=("median", "single"))
for axes, title in [(left, "centres of the cones"), (right, "arcs, medians and single crossings")]:
    axes.plot(readings[3], readings[4], color="tab:green", linewidth=1)
    axes.set_title(title)
plt.show()
