"""Survey a reef, and plot it: the map of where the robot went, and what it covered and inspected over time."""

import sys
from pathlib import Path

import coral

out = Path(sys.argv[1] if len(sys.argv) > 1 else "build/examples")
out.mkdir(parents=True, exist_ok=True)
result = coral.run_mission("s1", cfg={"time_limit_s": 20, "latency": "fixed:2"})
print(result)
print(f"{result.trajectory.num_rows} ticks, {result.events_of('goal').num_rows} goals")

result.plot().savefig(out / "survey.png")
print(f"plot: {out / 'survey.png'}")
