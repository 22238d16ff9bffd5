"""Fails unless a report tells of a complete exploration without a collision. usage: check_report.py report.json"""

import json
import sys

with open(sys.argv[1], encoding="utf-8") as file:
    report = json.load(file)
expected = {"stop_reason": "complete", "true_collisions": 0}
for field, value in expected.items():
    if report.get(field) != value:
        sys.exit(f"FAILED: {field} is {report.get(field)!r}, not {value!r}")
print(f"passed: {report['stop_reason']}, {report['distance_m']:.1f} m, {report['duration_s']:.0f} s, "
      f"agreement {report['agreement']}")
