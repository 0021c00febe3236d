#!/usr/bin/env python3
"""Runs `helio-bench frame` as a user does and checks what comes out: keys, counts and exit statuses, never times.

Usage: tests/bench/frame_test.py HELIO_BENCH
"""
import json
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = sys.argv.pop() if len(sys.argv) > 1 else ""
SIDE = 64
SMALL = ["--instances", "1000", "--size", f"{SIDE}x{SIDE}", "--frames", "2", "--warmup", "1", "--bounces", "2"]
EVERY_FRAME = {"instances", "assemble", "tlas", "path_trace", "tonemap", "exposure"}
RUN_KEYS = {"primary", "frame_ms", "passes", "path_trace_ms", "bare_trace_ms", "path_trace_over_bare", "rays", "mrays_per_s",
            "tlas_instances", "triangles_drawn", "nonfinite", "memory", "effects"}
REPORT_KEYS = {"schema", "device", "driver", "command", "date", "build", "scene", "camera", "instances", "size", "bounces",
               "mode", "frames", "warmup", "runs"}


def bench(*flags):
    return subprocess.run([PROGRAM, "frame", *flags], capture_output=True, text=True, timeout=600)


class Frame(unittest.TestCase):
    def report(self, *flags):
        done = bench(*SMALL, "--json", *flags)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)  # nothing but the document

    def check_run(self, run):
        self.assertLessEqual(RUN_KEYS, set(run))
        self.assertLessEqual(EVERY_FRAME, set(run["passes"]))
        self.assertNotIn("log_rays", run["passes"])
        for name, ms in [("frame", run["frame_ms"]), ("bare", run["bare_trace_ms"]), *run["passes"].items()]:
            self.assertGreaterEqual(ms["p95"], ms["median"], name)
            self.assertGreaterEqual(ms["median"], 0, name)
        for key in ("path_trace_ms", "bare_trace_ms", "frame_ms"):
            self.assertGreater(run[key]["median"], 0, key)
        self.assertGreater(run["path_trace_over_bare"], 0)
        self.assertGreater(run["rays"]["shadow"], 0)
        self.assertGreater(run["rays"]["bounce"], 0)
        self.assertGreater(run["mrays_per_s"], 0)
        self.assertEqual(run["nonfinite"], 0)
        self.assertGreaterEqual(run["tlas_instances"], 1000)
        memory = run["memory"]
        parts = [memory[k] for k in ("raster_bytes", "ray_tracing_bytes", "path_tracing_bytes")]
        self.assertTrue(all(bytes_ > 0 for bytes_ in parts), memory)
        self.assertEqual(memory["total_bytes"], sum(parts))
        self.assertTrue(run["effects"])

    def test_both_primaries_in_turn(self):
        with tempfile.TemporaryDirectory() as folder:
            picture = Path(folder) / "last.png"
            report = self.report("--camera", "city_at_sunset", "--out", str(picture))
            header = picture.read_bytes()[:24]
        self.assertLessEqual(REPORT_KEYS, set(report))
        self.assertEqual(report["schema"], "heliograph.bench.frame/1")
        self.assertEqual(report["size"], {"width": SIDE, "height": SIDE})
        self.assertEqual(report["camera"], "city_at_sunset")
        self.assertEqual(report["bounces"], 2)
        self.assertNotIn("frame_ms", report)
        raster, traced = report["runs"]
        for run in (raster, traced):
            self.check_run(run)
        self.assertEqual([raster["primary"], traced["primary"]], ["raster", "traced"])
        self.assertIn("primary_raster", raster["passes"])
        self.assertNotIn("primary_traced", raster["passes"])
        self.assertIn("primary_traced", traced["passes"])
        self.assertNotIn("primary_raster", traced["passes"])
        self.assertEqual(raster["rays"]["primary"], 0)
        self.assertEqual(traced["rays"]["primary"], SIDE * SIDE)
        self.assertGreater(raster["triangles_drawn"], 0)
        self.assertEqual(traced["triangles_drawn"], 0)
        self.assertEqual(header[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", header[16:24]), (SIDE, SIDE))

    def test_a_single_run_is_the_documents_own(self):
        report = self.report("--mode", "reference")
        self.assertEqual(report["mode"], "reference")
        self.assertEqual(len(report["runs"]), 1)
        self.check_run(report)
        self.assertEqual(report["passes"], report["runs"][0]["passes"])
        self.assertEqual(report["primary"], "traced")

    def test_a_runs_memory_does_not_depend_on_the_other_run(self):
        both = {run["primary"]: run["memory"] for run in self.report()["runs"]}
        for primary, memory in both.items():
            self.assertEqual(self.report("--primary", primary)["memory"], memory, primary)

    def test_tables(self):
        done = bench(*SMALL, "--primary", "traced")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(all(line == "" or line.startswith(("|", "- ")) for line in done.stdout.splitlines()), done.stdout)
        self.assertTrue(done.stdout.startswith("- command: "), done.stdout)
        for label in ("frame_ms", "- path_trace", "bare_trace_ms", "rays a pixel", "TLAS instances"):
            self.assertIn(f"| {label} ", done.stdout)

    def check_refused(self, status, said, *flags):
        done = bench(*flags)
        self.assertEqual(done.returncode, status, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertIn(said, done.stderr.splitlines()[-1])
        if status == 2:
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_wrong_usage(self):
        self.check_refused(2, "--size", "--size", "64by64")
        self.check_refused(2, "settings.width", "--size", "0x0")
        self.check_refused(2, "settings.height", "--size", "64x20000")
        self.check_refused(2, "settings.bounces", "--bounces", "99")
        self.check_refused(2, "--primary", "--mode", "reference", "--primary", "raster")
        self.check_refused(2, "--instances", "--scene", "model.glb", "--instances", "1000")
        self.check_refused(2, "--frames", "--frames", "0")
        self.check_refused(2, "--sise", "--sise", "1x1")

    def test_failures(self):
        self.check_refused(1, "tilted_city", *SMALL, "--camera", "nowhere")
        self.check_refused(1, "999", "--instances", "999")
        self.check_refused(1, "no-such-file.glb", "--scene", "no-such-file.glb")
        self.check_refused(1, "no such device here", "--device", "no such device here")


if __name__ == "__main__":
    if not PROGRAM:
        sys.exit(__doc__)
    unittest.main()
