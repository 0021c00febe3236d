#!/usr/bin/env python3
"""Runs the benchmarks of light path guided culling as a user does, small, and checks what comes out: keys and counts,
never times.

Usage: tests/bench/lipac_test.py HELIO_BENCH
"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = sys.argv.pop() if len(sys.argv) > 1 else ""
SMALL = ["--instances", "1000", "--animated", "100", "--size", "64x36", "--json"]


def bench(name, *flags):
    with tempfile.TemporaryDirectory() as folder:
        plot = Path(folder) / "plot.svg"
        done = subprocess.run([PROGRAM, name, *SMALL, "--plot", str(plot), *flags], capture_output=True, text=True, timeout=600)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        svg = plot.read_text()
    assert svg.startswith("<svg") and svg.rstrip().endswith("</svg>") and "<polyline" in svg, "the plot"
    report = json.loads(done.stdout)  # nothing but the document
    assert report["schema"] == f"heliograph.bench.{name}/1", report["schema"]
    return report


class Lipac(unittest.TestCase):
    def test_jump(self):
        report = bench("jump", "--empty", "10", "--frames", "4", "--settle", "20")
        arrivals = {(a["name"], a["mitigation"]): a for a in report["arrivals"]}
        self.assertEqual(set(arrivals), {("jump", True), ("jump", False), ("attach", True), ("attach", False)})
        for arrival in arrivals.values():
            self.assertEqual(len(arrival["frames"]), 4)
            self.assertGreater(arrival["carriers"], 0)
        on, off = arrivals["jump", True]["frames"][0], arrivals["jump", False]["frames"][0]
        self.assertGreaterEqual(on["share"], 0.95)
        self.assertLess(off["share"], on["share"])
        self.assertGreater(on["opened_hitboxes"], 0)
        self.assertEqual(off["opened_hitboxes"], 0)

    def test_jump_into_a_mirror(self):
        report = bench("jump", "--to", "mirror", "--mitigation", "on", "--empty", "2", "--frames", "2", "--settle", "2")
        self.assertEqual(report["to"], "mirror")
        self.assertEqual(len(report["arrivals"]), 2)

    def test_viewers(self):
        for spread in ("near", "far"):
            report = bench("viewers", "--viewers", "1,2", "--spread", spread, "--warmup", "6", "--frames", "2", "--samples", "8")
            one, two = report["runs"]
            self.assertEqual([one["viewers"], two["viewers"]], [1, 2])
            for run in (one, two):
                self.assertGreater(run["shared"]["active"], 0)
                self.assertGreater(run["shared"]["rt_memory_bytes"], 0)
            self.assertLess(two["shared"]["rt_memory_bytes"], two["separate"]["rt_memory_bytes"])

    def test_rest(self):
        report = bench("rest", "--warmup", "20", "--frames", "20")
        runs = {run["rules"]: run for run in report["runs"]}
        self.assertEqual(set(runs), {"lipac", "lipac_literal"})
        for run in runs.values():
            self.assertLessEqual(run["went_back"], run["changed"])

    def test_thresholds(self):
        report = bench("thresholds", "--thresholds", "30,30000", "--warmup", "24", "--frames", "2", "--samples", "8")
        full, low, high = report["runs"]
        self.assertEqual(full["relative_mse"], 0)
        self.assertGreater(full["tlas_entries"], low["active"])
        self.assertGreater(low["active"], high["active"])
        self.assertGreater(high["relative_mse"], 0)

    def test_ablation(self):
        report = bench("ablation", "--warmup", "6", "--frames", "2", "--samples", "8")
        runs = {run["combination"]: run for run in report["runs"]}
        self.assertEqual(set(runs), {"none", "L", "L+S", "R", "R+L", "R+L+S"})
        for name, run in runs.items():
            self.assertGreater(run["path_trace_ms"], 0, name)
            self.assertEqual(run["shadow_ms"] > 0, "S" in name, name)
            if "L" in name:
                self.assertLess(run["rt_memory_bytes"], runs["none"]["rt_memory_bytes"], name)
            else:
                self.assertEqual(run["relative_mse"], 0, name)
        # So few instances leave little to miss: some path of some combination does.
        self.assertGreater(max(run["relative_mse"] for run in runs.values()), 0)

    def test_fly(self):
        report = bench("fly", "--warmup", "4", "--frames", "12")
        for key in ("commands_ms", "sight_ms", "upload_ms", "blas_ms", "frame_ms", "opened", "shown", "active"):
            self.assertEqual(len(report["series"][key]), 12, key)
        self.assertGreater(sum(report["series"]["opened"]), 0)


if __name__ == "__main__":
    unittest.main()
