"""Collects what tests/network/run measured, in OUT/results.json and OUT/results.md.

usage: results.py about OUT --command C --scenario S --split S --programs DIR
       results.py add OUT --condition C --run N --exit-code N --link OPTIONS --wall S --died NAMES
       results.py print OUT      exit code 1: a run did not complete, or the robot hit something
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import statistics
import subprocess
import sys


def read_json(path):
    """Returns the file's content; nothing if a process ended without writing it."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def commit_of(folder):
    """Describes the commit of the source tree that holds the folder; empty if none does."""
    described = subprocess.run(["git", "-C", folder, "describe", "--always", "--dirty", "--exclude", "*"],
                               capture_output=True, text=True, check=False)
    return described.stdout.strip()


def processor():
    lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{os.cpu_count()} x {names[0] if names else platform.machine()}"


def operations(health, names):
    """Number of the first of these operations that was reported."""
    return next((health[name] for name in names if health.get(name)), None)


def longest_stand(robot, complete):
    """Seconds in which the true robot did not move; nothing if it never did."""
    if robot.get("until_first_motion_s") is None:
        return None
    longest = robot["longest_stand_between_motions_s"]
    return longest if complete else max(longest, robot["stands_at_end_for_s"])


def result_of(folder, args):
    """One run as a row of results.json."""
    report = read_json(folder / "base" / "report.json")
    robot = read_json(folder / "robot.json")
    link = read_json(folder / "link.json")
    complete = report.get("stop_reason") == "complete"
    received = [timing["count"] for timing in report.get("integration", []) if timing["name"] == "integration"]
    health = robot.get("operations", {})
    directions = {}
    for direction in ("to_base", "to_robot"):
        counts = dict(link.get(direction, {}))
        if counts:
            counts["bytes_per_s"] = counts["bytes"] / link["duration_s"]
        directions[direction] = counts
    return {
        "condition": args.condition,
        "run": args.run,
        "link": args.link,
        "outcome": report.get("stop_reason", "no report"),
        "details": report.get("stop_details"),
        "complete": complete,
        "exit_code": args.exit_code,
        "died": args.died.split(),
        "wall_s": args.wall,
        "path_m": robot.get("distance_m"),
        "coverage": report.get("coverage"),
        "agreement": report.get("agreement"),
        "true_collisions": robot.get("true_collisions"),
        "least_clearance_m": robot.get("least_clearance_m"),
        "clouds_made": operations(health, ["stereo.pair", "simulator.depth"]),
        "clouds_received": received[0] if received else operations(health, ["mapper.integration"]) or 0,
        "until_first_motion_s": robot.get("until_first_motion_s"),
        "longest_stand_s": longest_stand(robot, complete),
        "messages_dropped": report.get("messages_dropped", {}).get("total"),
        "messages_rejected": report.get("messages_rejected", {}).get("total"),
        "link_s": link.get("duration_s"),
        "forwarder_cpu_s": link.get("cpu_s"),
        **directions,
    }


def median_text(values, form, absent="-"):
    """The median, and the range if there are several; values that are unknown count not at all."""
    known = sorted(value for value in values if value is not None)
    if not known:
        return absent
    text = form.format(statistics.median(known))
    return text if len(known) == 1 else f"{text} ({form.format(known[0])} to {form.format(known[-1])})"


def markdown_row(cells):
    return "| " + " | ".join(cells) + " |"


def condition_row(condition, rows):
    """All runs of one condition as one line of the table."""
    complete = sum(row["complete"] for row in rows)
    others = sorted({row["outcome"] for row in rows if not row["complete"]})
    died = sorted({name for row in rows for name in row["died"]})
    outcome = f"{complete} of {len(rows)}" + "".join(f", {other}" for other in others)
    outcome += f", died: {' '.join(died)}" if died else ""
    clouds = (median_text([row["clouds_received"] for row in rows], "{:.0f}") + " / " +
              median_text([row["clouds_made"] for row in rows], "{:.0f}"))
    kilobytes = [median_text([row[direction].get("bytes_per_s", 0.0) / 1e3 for row in rows], "{:.1f}")
                 for direction in ("to_base", "to_robot")]
    collisions = [row["true_collisions"] for row in rows]
    return markdown_row([
        condition,
        outcome,
        median_text([row["wall_s"] for row in rows], "{:.0f} s"),
        median_text([row["path_m"] for row in rows], "{:.1f} m"),
        median_text([row["coverage"] and 100.0 * row["coverage"] for row in rows], "{:.1f} %"),
        "?" if None in collisions else str(sum(collisions)),
        clouds,
        *kilobytes,
        median_text([row["longest_stand_s"] for row in rows], "{:.1f} s", "never moved"),
    ])


def topic_table(row):
    """What crossed in one run, by topic, the heaviest first."""
    counts = {}
    for column, direction in enumerate(("to_base", "to_robot")):
        for name, count in row[direction].get("by_topic", {}).items():
            counts.setdefault(name, [None, None])[column] = count
    def weight(name):
        return -sum(count["bytes"] for count in counts[name] if count)
    def cell(count):
        if not count:
            return ["", ""]
        samples = f"{count['samples'] / row['link_s']:.1f}" if count["samples"] else ""
        return [f"{count['bytes'] / row['link_s'] / 1e3:.1f}", samples]
    lines = [markdown_row(["topic", "to base kB/s", "samples/s", "to robot kB/s", "samples/s"]),
             markdown_row(["---"] * 5)]
    lines += [markdown_row([name, *cell(counts[name][0]), *cell(counts[name][1])])
              for name in sorted(counts, key=weight)]
    return lines


def markdown(results):
    about = results["about"]
    rows = results["runs"]
    lines = [f"Commit {about['commit'] or 'unknown'}, {about['date']}; {about['machine']}; scenario {about['scenario']}, "
             f"{about['split']}.", "```", about["command"], "```", "",
             "| link | complete | wall | path | coverage | collisions | clouds received / made | to base kB/s "
             "| to robot kB/s | longest stand |",
             markdown_row(["---"] * 10)]
    for condition in dict.fromkeys(row["condition"] for row in rows):
        lines.append(condition_row(condition, [row for row in rows if row["condition"] == condition]))
    if rows and rows[0]["link_s"]:
        lines += ["", f"By topic, in the first run ({rows[0]['condition']}):", "", *topic_table(rows[0])]
    return "\n".join(lines) + "\n"


def about(args):
    results = {"about": {
        "command": args.command.strip(),
        "scenario": args.scenario,
        "split": args.split,
        "commit": commit_of(args.programs),
        "date": datetime.date.today().isoformat(),
        "machine": processor(),
    }, "runs": []}
    (args.out / "results.json").write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")


def add(args):
    file = args.out / "results.json"
    results = json.loads(file.read_text(encoding="utf-8"))
    row = result_of(args.out / f"{args.condition}-{args.run}", args)
    results["runs"].append(row)
    file.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    (args.out / "results.md").write_text(markdown(results), encoding="utf-8")
    print(condition_row(f"{args.condition} {args.run}", [row]), flush=True)


def show(args):
    results = json.loads((args.out / "results.json").read_text(encoding="utf-8"))
    print(markdown(results))
    print(f"in {args.out}")
    wrong = [row for row in results["runs"]
             if not row["complete"] or row["true_collisions"] != 0 or row["died"] or row["exit_code"] != 0]
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(description="Collects what tests/network/run measured.")
    actions = parser.add_subparsers(dest="action", required=True)
    for name in ("about", "add", "print"):
        action = actions.add_parser(name)
        action.add_argument("out", type=pathlib.Path)
        if name == "about":
            for option in ("--command", "--scenario", "--split", "--programs"):
                action.add_argument(option, required=True)
        if name == "add":
            for option, kind in (("--condition", str), ("--run", int), ("--exit-code", int), ("--link", str),
                                 ("--wall", float), ("--died", str)):
                action.add_argument(option, type=kind, required=True)
    args = parser.parse_args()
    return {"about": about, "add": add, "print": show}[args.action](args)


if __name__ == "__main__":
    sys.exit(main())
