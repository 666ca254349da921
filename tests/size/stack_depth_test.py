#!/usr/bin/env python3
"""scripts/stack-depth finds what it looks for: call graphs with one fault each. Usage: stack_depth_test.py SCRIPT"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = sys.argv.pop(1)
ENTRIES = ["_ZN8wirepose10Recognizer9ConfigureE", "_ZN8wirepose10Recognizer8AddModelE", "_ZN8wirepose10ParseModelE"]
PROCESS = "_ZN8wirepose10Recognizer7ProcessE"


def node(name, size=100, kind="static"):
    return f'node: {{ title: "{name}" label: "{name}\\nfile.cpp:1:1\\n{size} bytes ({kind})\\n0 dynamic objects" }}'


def edge(caller, callee, place="file.cpp:1:1"):
    return f'edge: {{ sourcename: "{caller}" targetname: "{callee}" label: "{place}" }}'


def run(*lines, options=()):
    with tempfile.TemporaryDirectory() as folder:
        text = [node(name, 10) for name in ENTRIES] + [node(PROCESS)] + list(lines)
        (pathlib.Path(folder) / "core.ci").write_text("\n".join(text))
        return subprocess.run([SCRIPT, folder, *options], capture_output=True, text=True)


class StackDepth(unittest.TestCase):
    def test_adds_the_deepest_chain(self):
        result = run(node("a", 50), node("b", 7), edge(PROCESS, "a"), edge("a", "b"), edge(PROCESS, "b"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("Recognizer::Process: 157 bytes", result.stdout)

    def test_limit(self):
        self.assertEqual(run(options=("--limit", "100")).returncode, 0)
        self.assertIn("more than 99", run(options=("--limit", "99")).stderr)

    def refused(self, reason, *lines):
        result = run(*lines)
        self.assertEqual(result.returncode, 1)
        self.assertIn(reason, result.stderr)

    def test_recursion(self):
        self.refused("calls itself", node("a"), node("b"), edge(PROCESS, "a"), edge("a", "b"), edge("b", "a"))

    def test_frame_without_bound(self):
        self.refused("without bound", node("a", 16, "dynamic"), edge(PROCESS, "a"))

    def test_unknown_callee(self):
        self.refused("nothing is known", edge(PROCESS, "somebody"))

    def test_call_through_a_pointer(self):
        self.refused("through a pointer", edge(PROCESS, "__indirect_call"))

    def test_missing_entry(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(subprocess.run([SCRIPT, folder], capture_output=True).returncode, 1)


unittest.main()
