"""Fails unless a run's folder reports a complete exploration without a collision and holds its map.

usage: check_run.py FOLDER
"""

import json
import pathlib
import sys

folder = pathlib.Path(sys.argv[1])
report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
expected = {"stop_reason": "complete", "true_collisions": 0}
wrong = [f"{field} is {report.get(field)!r}, not {value!r}"
         for field, value in expected.items() if report.get(field) != value]
wrong += [f"{name} is missing" for name in ("map.ot", "map.bt", "map.ply", "trajectory.tum", "report.png")
          if not (folder / name).is_file()]
if wrong:
    sys.exit("FAILED: " + "; ".join(wrong))
print(f"passed: {report['stop_reason']}, {report['distance_m']:.1f} m, {report['duration_s']:.0f} s, "
      f"agreement {report['agreement']}")
