#!/usr/bin/env python3
"""Runs `helio-bench accuracy` as a user does and checks what comes out: keys, files, sums and exit statuses, never times.

Usage: tests/bench/accuracy_test.py HELIO_BENCH
"""
import csv
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = sys.argv.pop() if len(sys.argv) > 1 else ""
SMALL = ["--instances", "1000", "--size", "32x18", "--runs", "2", "--reference-spp", "8", "--reference-bounces", "3"]
POINT_KEYS = {"axis", "name", "frame_ms", "relmse", "bias", "variance", "ssim", "flip", "flicker", "memory_bytes",
              "history_bytes", "recovery", "ssim_along", "passes"}


def bench(*flags, frames=2):
    return subprocess.run([PROGRAM, "accuracy", *SMALL, "--frames", str(frames), *flags], capture_output=True, text=True,
                          timeout=600)


class Accuracy(unittest.TestCase):
    def test_prices_each_setting_of_the_axes_asked_for(self):
        with tempfile.TemporaryDirectory() as folder:
            done = bench("--axis", "denoiser", "--axis", "bounces", "--out", folder, "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            report = json.loads(done.stdout)  # nothing but the document
            self.assertEqual(report, json.loads(Path(folder, "accuracy.json").read_text()))
            points = report["points"]
            self.assertEqual([(p["axis"], p["name"]) for p in points],
                             [("denoiser", n) for n in ("none", "average", "svgf", "asvgf", "reblur")] + [("bounces", n) for n in "01235"])
            for point in points:
                self.assertLessEqual(POINT_KEYS, set(point))
                self.assertGreater(point["relmse"], 0)
                self.assertAlmostEqual(point["relmse"], point["bias"] + point["variance"], places=9)
                self.assertLessEqual(point["ssim"], 1)
                self.assertTrue(0 <= point["flip"] <= 1)
                self.assertEqual(len(point["recovery"]), 2)
                self.assertAlmostEqual(point["recovery"][-1], point["relmse"], places=9)
                self.assertEqual(len(point["ssim_along"]), 2)
                self.assertEqual(point["ssim_along"][-1], point["ssim"])
            none, _, svgf, asvgf, reblur = points[:5]
            self.assertIn("reblur_stabilise", reblur["passes"])
            self.assertIn("asvgf_gradient", asvgf["passes"])
            self.assertIsNone(report["reference_flicker"])
            self.assertEqual(none["history_bytes"], 0)
            self.assertGreater(svgf["history_bytes"], 0)
            self.assertIn("svgf_atrous", svgf["passes"])
            self.assertNotIn("motion", none["passes"])
            # Against 8 samples of 32 x 18 pixels the reference's own noise decides what is near it (tests/denoise has truths).
            self.assertLess(svgf["variance"], none["variance"])
            self.assertGreater(report["reference"]["noise"], 0)
            with open(Path(folder, "accuracy.csv")) as file:
                self.assertEqual(len(list(csv.DictReader(file))), len(points))
            page = Path(folder, "accuracy.html").read_text()
            self.assertIn("From none to average", page)
            self.assertEqual(page.count("data:image/png;base64"), 2 + 2 * len(points))

    def test_a_flight_ends_where_the_reference_looks_from(self):
        with tempfile.TemporaryDirectory() as folder:
            done = bench("--axis", "roulette", "--motion", "fly", "--out", folder, "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            report = json.loads(done.stdout)
            self.assertGreater(report["reference_flicker"], 0)
            for point in report["points"]:
                # One noisy sample a pixel changes more from frame to frame than the references do.
                self.assertGreater(point["flicker"], report["reference_flicker"])
                self.assertEqual(len(point["recovery"]), 2)
                self.assertEqual(len(point["ssim_along"]), 2)

    def test_after_a_jump_the_first_frame_is_the_worst(self):
        with tempfile.TemporaryDirectory() as folder:
            done = bench("--axis", "taa", "--motion", "jump", "--out", folder, "--json", frames=8)
            self.assertEqual(done.returncode, 0, done.stderr)
            report = json.loads(done.stdout)
            self.assertEqual(report["motion"], "jump")
            off, on, svgf, svgf_taa, asvgf_taa = report["points"]
            self.assertIn("taa", on["passes"])
            self.assertNotIn("taa", off["passes"])
            for point in (svgf_taa, asvgf_taa):
                self.assertLess(point["recovery"][-1], point["recovery"][0])
                self.assertGreater(point["ssim_along"][-1], point["ssim_along"][0])

    def test_refuses_what_it_does_not_know(self):
        done = bench("--axis", "wishes")
        self.assertEqual(done.returncode, 1)
        self.assertIn('there is no axis "wishes"', done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
