#!/usr/bin/env python3
"""Figures, verdicts and the table of tools/evaluation/targets.py."""
import os
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tools/evaluation"))
import targets  # noqa: E402


def hit(score, range_mm=1000, translation=1.0, rotation=0.1):
    return {"hit": True, "score": score, "range_mm": range_mm, "translation_mm": translation, "lateral_mm": 0.5,
            "rotation_deg": rotation}


def miss(range_mm=1000):
    return {"hit": False, "range_mm": range_mm}


def alarm(score, z_mm=1000):
    return {"score": score, "t_mm": [0, 0, z_mm]}


def run(instances, alarms, negative_frames=0, fp_per_negative_frame=None, nees=None):
    return {"instances": instances, "false_positives": alarms, "frames": 4, "negative_frames": negative_frames,
            "fp_per_negative_frame": fp_per_negative_frame, "total": {"nees": nees or {"n": 0}},
            "per_frame": [{"cpu_s": 0.010}, {"cpu_s": 0.030}, {"cpu_s": 0.020}]}


def target(data, measure):
    return next(t for t in targets.TARGETS[data] if t.measure == measure)


class Figures(unittest.TestCase):
    def test_of_one_run(self):
        f = targets.figures([run([hit(0.9, translation=2), hit(0.8, translation=4), miss()], [alarm(0.6)])])
        self.assertAlmostEqual(f["recall"], 2 / 3)
        self.assertAlmostEqual(f["precision"], 2 / 3)
        self.assertEqual(f["translation, mm"], 3)
        self.assertEqual(f["frame, CPU ms"], 20)
        self.assertIsNone(f["NEES 95 % coverage"])

    def test_pools_runs_and_leaves_other_ranges_out(self):
        runs = [run([hit(0.9), miss(2500)], [alarm(0.7, 3000)], nees={"n": 1, "coverage": {"95": 1.0}}),
                run([hit(0.9, 500)], [], nees={"n": 3, "coverage": {"95": 1 / 3}})]
        f = targets.figures(runs, targets.SUITE_RANGE_MM)
        self.assertEqual((f["instances"], f["hits"], f["false"], f["frames"]), (2, 2, 0, 8))
        self.assertAlmostEqual(f["NEES 95 % coverage"], 0.5)

    def test_at_one_metre_means_near_it(self):
        f = targets.figures([run([hit(0.9, 1000, translation=1), hit(0.9, 1900, translation=9)], [])])
        self.assertEqual(f["translation at 1 m, mm"], 1)

    def test_of_nothing_says_nothing(self):
        f = targets.figures([run([], [])])
        for measure in ("recall", "precision", "translation, mm", "calibration error"):
            self.assertIsNone(f[measure])

    def test_calibration_error_is_the_weighted_gap(self):
        scored = [(0.95, True), (1.0, True), (0.91, False), (0.52, True), (0.0, False)]
        expected = (3 * (2.86 / 3 - 2 / 3) + (1 - 0.52)) / 5
        self.assertAlmostEqual(targets.calibration_error(scored), expected)

    def test_object_free_frames(self):
        f = targets.object_free_figures([run([], [], 200, 0.005), run([], [], 300, 0.0)])
        self.assertEqual((f["frames"], f["false"]), (500, 1))
        self.assertAlmostEqual(f["false alarms per frame"], 1 / 500)


    def test_misses_by_cause_leave_hidden_objects_out(self):
        rows = [{"visib_fract": "0.9", "cause": "rejected"}, {"visib_fract": "0.3", "cause": "rejected"},
                {"visib_fract": "0.4", "cause": "no lines"}, {"visib_fract": "1.0", "cause": "found"}]
        causes = targets.miss_causes(rows)
        self.assertEqual((causes["rejected"], causes["no lines"], sum(causes.values())), (1, 1, 2))


class Verdicts(unittest.TestCase):
    def test_of_a_share(self):
        recall = target("kitchen-sample", "recall")
        for value, expected in ((0.96, "goal"), (0.95, "goal"), (0.7, "must"), (0.64, "missed"), (None, "nothing measured")):
            self.assertEqual(targets.verdict(recall, {"recall": value}), expected)

    def test_of_an_error(self):
        error = target("kitchen-sample", "translation, mm")
        for value, expected in ((1.5, "goal"), (3, "must"), (4.1, "missed")):
            self.assertEqual(targets.verdict(error, {"translation, mm": value}), expected)

    def test_of_a_band(self):
        nees = target("kitchen-sample", "NEES 95 % coverage")
        for value, expected in ((0.91, "missed"), (0.95, "goal"), (0.99, "missed")):
            self.assertEqual(targets.verdict(nees, {"NEES 95 % coverage": value}), expected)

    def test_no_false_alarm_in_few_frames_proves_nothing(self):
        rate = target("object-free scenes", "false alarms per frame")
        key = "false alarms per frame"
        self.assertEqual(targets.verdict(rate, {key: 0.0, "frames": 2}), "too few frames to tell (2)")
        self.assertEqual(targets.verdict(rate, {key: 0.0, "frames": 3000}), "goal")
        self.assertEqual(targets.verdict(rate, {key: 0.5, "frames": 2}), "missed")


class Table(unittest.TestCase):
    def test_has_every_row_and_says_why_one_is_empty(self):
        values = targets.figures([run([hit(0.9)], [])])
        rows = targets.table({"kitchen-sample": values}, {"pcl": {"kitchen-sample": values}},
                             {"simulated suite": "not rendered"})
        self.assertEqual(len(rows), sum(len(t) for t in targets.TARGETS.values()))
        self.assertEqual({r[5] for r in rows if r[0] == "simulated suite"}, {"not rendered"})
        recall = next(r for r in rows if r[:2] == ["kitchen-sample", "recall"])
        self.assertEqual(recall[4:], ["1 (1 of 1)", "goal", "–", "1 (1 of 1)"])

    def test_keeps_the_columns_of_peers_that_were_not_measured(self):
        values = targets.figures([run([hit(0.9)], [])])
        peers = {"ppf": {"kitchen-sample": values}, "pcl": {"kitchen-sample": values}}
        note = targets.peer_note(targets.PEERS[0], "`peer_ppf` at abc")
        document = targets.put_between_marks("", note + "\n\n" + targets.as_markdown(targets.table({}, peers, {})))
        kept = targets.kept_columns(document)
        self.assertEqual(kept["ppf"].note, note)
        self.assertIn("earlier", kept["pcl"].note)
        worse = targets.figures([run([hit(0.9), miss()], [])])
        rows = targets.table({}, {"pcl": {"teabox-stereo": worse}}, {}, kept)
        recall = {r[0]: r[6:] for r in rows if r[1] == "recall"}
        self.assertEqual(recall["kitchen-sample"], ["1 (1 of 1)", "–"])  # measured anew: no cell of before beside it
        self.assertEqual(recall["teabox-stereo"], ["–", "0.5 (1 of 2)"])

    def test_keeps_the_column_of_a_table_with_one_peer(self):
        table = ("| data | measure | must | goal | Wirepose | verdict | OpenCV PPF + ICP |\n|---|---|---|---|---|---|---|\n"
                 "| teabox-stereo | recall | 1 | 1 | 1 (8 of 8) | goal | 0.5 (4 of 8) |")
        kept = targets.kept_columns(targets.put_between_marks("", table))
        self.assertEqual(kept["ppf"].cells, {("teabox-stereo", "recall"): "0.5 (4 of 8)"})
        self.assertEqual(list(kept), ["ppf"])

    def test_keeps_nothing_of_a_document_without_a_table(self):
        self.assertEqual(targets.kept_columns("| data | measure | OpenCV PPF + ICP |"), {})

    def test_takes_the_place_of_the_old_one(self):
        once = targets.put_between_marks("# Results\n\ntext\n", "first")
        twice = targets.put_between_marks(once + "\n## After\n", "second")
        self.assertIn("second", twice)
        self.assertNotIn("first", twice)
        self.assertTrue(twice.endswith("## After\n") and twice.startswith("# Results\n\ntext\n"))

    def test_refuses_a_broken_mark(self):
        with self.assertRaises(ValueError):
            targets.put_between_marks(targets.BEGIN + " lost the end", "text")


if __name__ == "__main__":
    unittest.main()
