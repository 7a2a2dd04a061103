"""Survey a reef and plot how much of it was covered over time, and the way of the robot."""

import sys
from pathlib import Path

from matplotlib import pyplot

import coral

out = Path(sys.argv[1] if len(sys.argv) > 1 else "build/examples")
out.mkdir(parents=True, exist_ok=True)
result = coral.run_mission("s1", cfg={"time_limit_s": 20, "latency": "fixed:2"})
print(result)

rows = result.trajectory
figure, (over_time, seen_from_above) = pyplot.subplots(1, 2, figsize=(9, 4), layout="constrained")
over_time.plot(rows["t"], rows["coverage"])
over_time.set(xlabel="simulated time (s)", ylabel="coverage", ylim=(0, 1))
seen_from_above.plot(rows["x"], rows["y"])
seen_from_above.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
figure.savefig(out / "survey.png")
print(f"plot: {out / 'survey.png'}")
