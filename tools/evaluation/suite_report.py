#!/usr/bin/env python3
"""Evaluates the recognizer on the simulated suite and writes the table of docs/results.md.

Runs `wirepose eval` on every data set of a folder that `wirepose sim suite` made and puts a table by scenario and
visibility bin between the markers <!-- suite:begin --> and <!-- suite:end --> of the results file. Plain Python.
Usage: suite_report.py SUITE_FOLDER --wirepose PROGRAM [--results docs/results.md] [--keep]
"""
import argparse
import json
import pathlib
import subprocess
import sys

BEGIN, END = "<!-- suite:begin -->", "<!-- suite:end -->"
BINS = ["0.4-0.6", "0.6-0.8", "0.8-1.0"]


def metrics_of(folder, wirepose, keep):
    """The metrics of one data set; `keep` uses those of an earlier run."""
    path = folder / "metrics.json"
    if not (keep and path.exists()):
        command = [str(wirepose), "eval", str(folder), "--out", str(folder / "results.csv"), "--json", str(path)]
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            sys.exit(f"{folder}: {done.stderr.strip()}")
    return json.loads(path.read_text())


def text(value, digits=2):
    return "" if value is None else f"{value:.{digits}f}"


def row(name, metrics):
    total = metrics["total"]
    cells = [name, str(metrics["frames"]), str(total["instances"]), str(total["true_positives"]), str(total["false_positives"]),
             text(total["recall"])]
    for name_of_bin in BINS:
        count = total["recall_by_visibility"][name_of_bin]
        cells.append(f"{text(count['recall'])} ({count['n']})" if count["n"] else "")
    cells += [text(total["precision"]), text(total["median_translation_mm"], 1), text(total["median_rotation_deg"])]
    return "| " + " | ".join(cells) + " |"


def sum_row(all_metrics):
    totals = [m["total"] for m in all_metrics]
    instances, hits, false = (sum(t[k] for t in totals) for k in ("instances", "true_positives", "false_positives"))
    cells = ["all", str(sum(m["frames"] for m in all_metrics)), str(instances), str(hits), str(false),
             text(hits / instances if instances else None)]
    for name_of_bin in BINS:
        counts = [t["recall_by_visibility"][name_of_bin] for t in totals]
        n = sum(c["n"] for c in counts)
        found = sum(c["n"] * (c["recall"] or 0) for c in counts)
        cells.append(f"{text(found / n)} ({n})" if n else "")
    cells += [text(hits / (hits + false) if hits + false else None), "", ""]
    return "| " + " | ".join(cells) + " |"


def table(suite, wirepose, keep):
    folders = sorted(f.parent for f in suite.glob("*/calib.yaml"))
    if not folders:
        sys.exit(f"{suite}: no data set in it; make them with 'wirepose sim suite --out {suite}'")
    rows, all_metrics = [], []
    for folder in folders:
        metrics = metrics_of(folder, wirepose, keep)
        all_metrics.append(metrics)
        rows.append(row(folder.name, metrics))
        print(rows[-1], flush=True)
    head = ["scenario", "frames", "instances", "hits", "false", "recall"] + [f"visible {b}" for b in BINS]
    head += ["precision", "median mm", "median deg"]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)] + rows + [sum_row(all_metrics)]
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("suite", type=pathlib.Path, help="folder that `wirepose sim suite` made")
    parser.add_argument("--wirepose", type=pathlib.Path, default="build/host-release/bin/wirepose")
    parser.add_argument("--results", type=pathlib.Path, default="docs/results.md")
    parser.add_argument("--keep", action="store_true", help="do not evaluate again what has metrics.json")
    arguments = parser.parse_args()
    results = arguments.results.read_text()
    if results.count(BEGIN) != 1 or results.count(END) != 1:
        sys.exit(f"{arguments.results}: needs the markers {BEGIN} and {END} once each")
    before, rest = results.split(BEGIN)
    after = rest.split(END)[1]
    filled = table(arguments.suite, arguments.wirepose, arguments.keep)
    arguments.results.write_text(f"{before}{BEGIN}\n{filled}\n{END}{after}")


if __name__ == "__main__":
    main()
