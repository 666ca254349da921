"""What the recognizer is meant to reach, and whether measured figures reach it. Used by scripts/evaluate.

Figures come from the JSON of `wirepose eval --json` or of the peers' programs, which have the same form.
"""
import statistics
from dataclasses import dataclass

BINS = 10
BEGIN, END = "<!-- targets: written by scripts/evaluate -->", "<!-- end of targets -->"


@dataclass(frozen=True)
class Target:
    """One row: `must` and `goal` are bounds in the measure's own unit; `low` is the lower end of a band, if it is one."""
    measure: str
    must: float
    goal: float
    higher_is_better: bool = False
    low: float = None


@dataclass(frozen=True)
class Peer:
    """A public recognizer with its own column, run on PEER_SETS by a program that is built where `package` is installed."""
    name: str
    column: str
    what: str
    package: str

    @property
    def program(self):
        return f"peer_{self.name}"


PEERS = [Peer("ppf", "OpenCV PPF + ICP", "OpenCV's surface_matching", "libopencv-contrib-dev"),
         Peer("pcl", "PCL FPFH + ICP", "PCL's SampleConsensusPrerejective", "libpcl-dev")]


def higher(measure, must, goal):
    return Target(measure, must, goal, higher_is_better=True)


HONEST = [Target("calibration error", 0.05, 0.05), Target("NEES 95 % coverage", 0.98, 0.98, low=0.92)]
TARGETS = {
    "simulated suite": [higher("recall", 0.85, 0.98), higher("precision", 0.95, 0.995),
                        Target("translation at 1 m, mm", 2, 1), Target("rotation at 1 m, deg", 0.4, 0.15), *HONEST,
                        Target("frame, CPU ms", 20, 5)],
    "kitchen-sample": [higher("recall", 0.65, 0.95), higher("precision", 0.90, 0.99),
                       Target("translation, mm", 4, 1.5), Target("rotation, deg", 0.6, 0.25), *HONEST,
                       Target("frame, CPU ms", 20, 5)],
    "teabox-stereo": [higher("recall", 1, 1), higher("precision", 1, 1),
                      Target("lateral, mm", 3, 3), Target("rotation, deg", 1.5, 1.5), Target("frame, CPU ms", 20, 5)],
    "picture-cube-rgbd": [higher("recall", 1, 1), higher("precision", 1, 1),
                          Target("translation, mm", 3, 1.5), Target("rotation, deg", 1.5, 0.7),
                          Target("frame, CPU ms", 20, 5)],
    "object-free scenes": [Target("false alarms per frame", 1 / 300, 1 / 3000)],
}
PEER_SETS = ["kitchen-sample", "teabox-stereo"]
SUITE_RANGE_MM = (400, 2000)  # the suite's targets hold for objects in this range
NEAR_1M_MM = (800, 1200)      # "at 1 m"


def within(value_mm, bounds_mm):
    return bounds_mm is None or bounds_mm[0] <= value_mm <= bounds_mm[1]


def median(values):
    return statistics.median(values) if values else None


def share(part, whole):
    return part / whole if whole else None


def calibration_error(scored):
    """Expected calibration error of (score, right) pairs in ten bins, as tools/evaluation/score_curves.h defines it."""
    bins = [[] for _ in range(BINS)]
    for score, right in scored:
        bins[min(BINS - 1, max(0, int(score * BINS)))].append((score, right))
    gap = sum(abs(sum(s for s, _ in b) - sum(r for _, r in b)) for b in bins)
    return share(gap, len(scored))


def figures(runs, range_mm=None):
    """Figures by measure, of one or several runs pooled; None where nothing can be said. Of objects in `range_mm`."""
    instances = [i for run in runs for i in run["instances"] if within(i["range_mm"], range_mm)]
    alarms = [f for run in runs for f in run["false_positives"]
              if within(sum(x * x for x in f["t_mm"]) ** 0.5, range_mm)]
    hits = [i for i in instances if i["hit"]]
    near = [i for i in hits if within(i["range_mm"], NEAR_1M_MM)]
    nees = [run["total"].get("nees", {}) for run in runs]
    nees_hits = sum(n.get("n", 0) for n in nees)
    covered = sum(n["n"] * n["coverage"]["95"] for n in nees if n.get("n"))
    times = [f["cpu_s"] * 1000 for run in runs for f in run.get("per_frame", [])]
    scored = [(h["score"], True) for h in hits] + [(a["score"], False) for a in alarms]
    return {
        "instances": len(instances), "hits": len(hits), "false": len(alarms),
        "frames": sum(run["frames"] for run in runs),
        "recall": share(len(hits), len(instances)),
        "precision": share(len(hits), len(hits) + len(alarms)),
        "translation, mm": median([h["translation_mm"] for h in hits]),
        "rotation, deg": median([h["rotation_deg"] for h in hits]),
        "lateral, mm": median([h["lateral_mm"] for h in hits]),
        "translation at 1 m, mm": median([h["translation_mm"] for h in near]),
        "rotation at 1 m, deg": median([h["rotation_deg"] for h in near]),
        "calibration error": calibration_error(scored),
        "NEES 95 % coverage": share(covered, nees_hits),
        "frame, CPU ms": median(times),
    }


def object_free_figures(runs):
    """Of the frames without any object."""
    frames = sum(run["negative_frames"] for run in runs)
    false = sum(round((run["fp_per_negative_frame"] or 0) * run["negative_frames"]) for run in runs)
    return {"frames": frames, "false": false, "false alarms per frame": share(false, frames)}


def verdict(target, values):
    """'goal', 'must' (reached, but not the goal), 'missed', or why nothing can be said."""
    figure = values.get(target.measure)
    if figure is None:
        return "nothing measured"
    if target.measure == "false alarms per frame" and figure == 0 and values["frames"] < 1 / target.must:
        return f"too few frames to tell ({values['frames']})"
    if target.low is not None:
        return "goal" if target.low <= figure <= target.goal else "missed"
    reaches = (lambda bound: figure >= bound) if target.higher_is_better else (lambda bound: figure <= bound)
    return "goal" if reaches(target.goal) else "must" if reaches(target.must) else "missed"


def number(value):
    """Three significant digits, or more where they are there."""
    if value is None:
        return "–"
    return f"{value:.3g}" if abs(value) < 100 else f"{value:.0f}"


def bounds(target):
    if target.low is not None:
        return f"{number(target.low)}–{number(target.must)}", f"{number(target.low)}–{number(target.goal)}"
    if target.measure == "false alarms per frame":
        return f"1 in {round(1 / target.must)}", f"1 in {round(1 / target.goal)}"
    return number(target.must), number(target.goal)


def shown(target, values):
    """The figure, with its counts where it is a share of few."""
    value = values.get(target.measure)
    if value is None:
        return "–"
    counts = {"recall": ("hits", "instances"), "false alarms per frame": ("false", "frames")}.get(target.measure)
    if target.measure == "precision":
        return f"{number(value)} ({values['false']} false)"
    return number(value) + (f" ({values[counts[0]]} of {values[counts[1]]})" if counts else "")


CAUSES = ["no lines", "no hypothesis", "ranked out", "wrong pose", "rejected"]  # as `wirepose eval --trace` names them


def miss_causes(trace_rows, min_visible=0.4):
    """Misses by cause from the rows (dicts) of a trace file: the stage that lost each true object that counts."""
    counted = [row["cause"] for row in trace_rows if float(row["visib_fract"]) >= min_visible]
    return {cause: counted.count(cause) for cause in CAUSES}


def causes_markdown(causes_by_data):
    lines = ["| misses by the stage that lost them | " + " | ".join(CAUSES) + " |", "|" + "---|" * (len(CAUSES) + 1)]
    for data, causes in causes_by_data.items():
        lines.append(f"| {data} | " + " | ".join(str(causes[c]) for c in CAUSES) + " |")
    return "\n".join(lines)


HEADING = ["data", "measure", "must", "goal", "Wirepose", "verdict", *[p.column for p in PEERS]]


def table(measured, peers, absent, kept=None):
    """Rows of text. `measured`: figures by data set; `peers`: the same by peer's name; `absent`: why a data set was not
    measured; `kept`: KeptColumn by peer's name, for peers that were not measured."""
    rows = []
    for data, targets in TARGETS.items():
        for target in targets:
            values = measured.get(data)
            ours = shown(target, values) if values else "–"
            said = verdict(target, values) if values else absent.get(data, "not measured")
            theirs = [peer_cell(p, data, target, peers, kept or {}) for p in PEERS]
            rows.append([data, target.measure, *bounds(target), ours, said, *theirs])
    return rows


def peer_cell(peer, data, target, peers, kept):
    if peer.name not in peers:
        return kept[peer.name].cells.get((data, target.measure), "–") if peer.name in kept else "–"
    # A peer's score claims no probability and its pose no covariance.
    return shown(target, peers[peer.name][data]) if data in peers[peer.name] and target not in HONEST else "–"


@dataclass(frozen=True)
class KeptColumn:
    """A peer's column of an earlier table: cells by (data, measure), and the line that says what they are."""
    cells: dict
    note: str


def peer_note(peer, text):
    """The line of the document that says what a peer's column is."""
    return f"- {peer.column}: {text}"


def kept_columns(document):
    """KeptColumn by peer's name: the peers' columns of the table that `document` has between the marks."""
    lines = document.partition(BEGIN)[2].partition(END)[0].splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
    heading = next((row for row in rows if row[:2] == HEADING[:2]), [])
    kept = {}
    for peer in PEERS:
        if peer.column not in heading:
            continue
        k = heading.index(peer.column)
        cells = {(row[0], row[1]): row[k] for row in rows if len(row) == len(heading) and row[0] in TARGETS}
        note = next((line for line in lines if line.startswith(peer_note(peer, ""))),
                    peer_note(peer, f"`{peer.program}`, kept from an earlier table."))
        kept[peer.name] = KeptColumn(cells, note)
    return kept


def as_markdown(rows):
    lines = ["| " + " | ".join(row) + " |" for row in [HEADING, *rows]]
    lines.insert(1, "|" + "---|" * len(HEADING))
    return "\n".join(lines)


def as_text(rows):
    widths = [max(len(row[k]) for row in [HEADING, *rows]) for k in range(len(HEADING))]
    return "\n".join("  ".join(cell.ljust(w) for cell, w in zip(row, widths)).rstrip() for row in [HEADING, *rows])


def put_between_marks(document, text):
    """`document` with what stands between the marks replaced; the marks are added at its end when it has none."""
    block = f"{BEGIN}\n{text}\n{END}"
    if BEGIN not in document:
        return document.rstrip("\n") + f"\n\n## Targets\n\n{block}\n"
    head, rest = document.split(BEGIN, 1)
    if END not in rest:
        raise ValueError(f"'{BEGIN}' has no '{END}' after it; restore the mark")
    return head + block + rest.split(END, 1)[1]
