#!/usr/bin/env python3
"""What scripts/evaluate makes of peers that run, that are missing, and that are left out, and of scenes without objects;
with programs that only pretend."""
import contextlib
import importlib.machinery
import importlib.util
import io
import json
import os
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

sys.dont_write_bytecode = True
SCRIPT = Path(__file__).resolve().parent.parent.parent / "scripts/evaluate"
loader = importlib.machinery.SourceFileLoader("evaluate", str(SCRIPT))
evaluate = importlib.util.module_from_spec(importlib.util.spec_from_loader("evaluate", loader))
loader.exec_module(evaluate)


def metrics(hits, misses):
    """What a program writes with --json."""
    hit = {"hit": True, "score": 0.9, "range_mm": 1000, "translation_mm": 1, "lateral_mm": 1, "rotation_deg": 1}
    return {"instances": [hit] * hits + [{"hit": False, "range_mm": 1000}] * misses, "false_positives": [], "frames": 1,
            "negative_frames": 0, "fp_per_negative_frame": None, "total": {}, "per_frame": [{"cpu_s": 1}]}


class PeersAndScenes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.document = self.folder / "results.md"
        self.document.write_text("# Results\n")
        (self.folder / "data/teabox-stereo").mkdir(parents=True)
        (self.folder / "bin").mkdir()
        self.pretend("wirepose", metrics(1, 0))

    def pretend(self, program, result):
        """A program that writes `result` to its --json and an empty trace to its --trace."""
        file = self.folder / "bin" / program
        file.write_text(f"#!{sys.executable}\nimport sys\n"
                        f"options = dict(zip(sys.argv, sys.argv[1:]))\n"
                        f"open(options['--json'], 'w').write({json.dumps(result)!r})\n"
                        f"open(options.get('--trace', '/dev/null'), 'w').write('cause,visib_fract')\n")
        file.chmod(0o755)

    def run_script(self, *options):
        """Its exit status, output and errors, with the document of this test in the place of docs/results.md."""
        argv = ["evaluate", "--bin", str(self.folder / "bin"), "--data", str(self.folder / "data"),
                "--out", str(self.folder / "out"), *options]
        out, err = io.StringIO(), io.StringIO()
        with mock.patch.object(sys, "argv", argv), mock.patch.object(evaluate, "DOCUMENT", self.document), \
                mock.patch.dict(os.environ, {"WIREPOSE_SCORE": "/nowhere"}), \
                contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            status = evaluate.main()
        return status, out.getvalue(), err.getvalue()

    def recall(self):
        """The peers' cells in the document."""
        row = next(r for r in self.document.read_text().splitlines() if r.startswith("| teabox-stereo | recall"))
        return [cell.strip() for cell in row.strip("|").split("|")][6:]

    def test_have_a_column_each(self):
        self.pretend("peer_ppf", metrics(1, 1))
        self.pretend("peer_pcl", metrics(1, 3))
        status, _, err = self.run_script()
        self.assertEqual((status, err), (0, ""))
        self.assertEqual(self.recall(), ["0.5 (1 of 2)", "0.25 (1 of 4)"])
        self.assertRegex(self.document.read_text(), r"- PCL FPFH \+ ICP: `peer_pcl` at ")

    def test_missing_is_one_line_with_the_package(self):
        self.pretend("peer_ppf", metrics(1, 1))
        status, _, err = self.run_script()
        self.assertEqual((status, len(err.splitlines())), (0, 1))
        self.assertRegex(err, "peer_pcl .* libpcl-dev")
        self.assertEqual(self.recall(), ["0.5 (1 of 2)", "–"])

    def test_left_out_keep_columns_and_notes(self):
        self.pretend("peer_ppf", metrics(1, 1))
        self.pretend("peer_pcl", metrics(1, 3))
        self.run_script("--peer-frames", "2")
        before = self.document.read_text()
        self.pretend("wirepose", metrics(0, 1))
        self.assertEqual(self.run_script("--no-peer")[0], 0)
        self.assertEqual(self.recall(), ["0.5 (1 of 2)", "0.25 (1 of 4)"])
        notes = [line for line in before.splitlines() if line.startswith("- ")]
        self.assertEqual([n for n in notes if n in self.document.read_text()], notes)
        self.assertEqual(len(notes), 2)

    def test_reused_need_no_program(self):
        self.pretend("peer_ppf", metrics(1, 1))
        self.pretend("peer_pcl", metrics(1, 3))
        self.run_script("--peer-frames", "2")
        for peer in ("peer_ppf", "peer_pcl"):
            (self.folder / "bin" / peer).unlink()
        self.document.write_text("# Results\n")
        status, _, err = self.run_script("--reuse-peer")
        self.assertEqual((status, err), (0, ""))
        self.assertEqual(self.recall(), ["0.5 (1 of 2)", "0.25 (1 of 4)"])
        self.assertIn("first 2 frames", self.document.read_text())  # what the reused run was

    def test_scenes_without_objects_are_counted_by_themselves(self):
        (self.folder / "free/kitchens").mkdir(parents=True)
        (self.folder / "free/kitchens/calib.yaml").write_text("")
        self.pretend("wirepose", metrics(1, 1) | {"negative_frames": 50, "fp_per_negative_frame": 0.02})
        status, _, err = self.run_script("--no-peer", "--object-free", str(self.folder / "free"))
        self.assertEqual((status, err), (0, ""))
        text = self.document.read_text()
        self.assertRegex(text, r"\| object-free scenes \| false alarms per frame .*2 of 100")  # and those beside tea boxes
        self.assertRegex(text, r"\| teabox-stereo \| recall .*1 of 2")


if __name__ == "__main__":
    unittest.main()
