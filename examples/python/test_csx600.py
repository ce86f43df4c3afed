"""Tests of the package against files that the program writes. $CSX600 names the program."""

import json
import os
import subprocess
import tempfile
import unittest

import csx600
import explore

SWEEP = f"""
scene = "{explore.SCENE}"
size = "8x6"
samples = 1
[constraint]
few = "chip.pes < 100"
[derived]
cycles_a_ray = {{ expression = "simulated_cycles / rays", unit = "cycles/ray" }}
[[axis]]
chip.pes = [64, 32, 128]
[[axis]]
pio.setup_cycles = [0, 900]
"""


class PackageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        cls.run_file = os.path.join(cls.directory.name, "run.json")
        explore.csx600_program("render", explore.SCENE, "--size", "8x6", "--samples", "1", "--stats", cls.run_file)
        sweep_file = os.path.join(cls.directory.name, "s.toml")
        with open(sweep_file, "w", encoding="utf-8") as file:
            file.write(SWEEP)
        cls.sweep_directory = os.path.join(cls.directory.name, "out")
        explore.csx600_program("sweep", sweep_file, "-o", cls.sweep_directory)

    @classmethod
    def tearDownClass(cls):
        cls.directory.cleanup()

    def write(self, name, text):
        path = os.path.join(self.directory.name, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def test_a_run_has_every_counter_under_its_key(self):
        with open(self.run_file, encoding="utf-8") as file:
            contents = json.load(file)
        run = csx600.read_run(self.run_file)
        self.assertEqual(run["chip.pio.busy_cycles"], contents["chip"]["pio"]["busy_cycles"])
        causes = run.below("chip.control_unit.cycles_by_cause")
        self.assertEqual(causes, contents["chip"]["control_unit"]["cycles_by_cause"])
        self.assertEqual(sum(causes.values()), run["simulated_cycles"])
        cycles = [kernel["cycles"] for kernel in run.kernels().values()]
        self.assertEqual(cycles, sorted(cycles, reverse=True))
        name = next(iter(run.kernels()))
        self.assertEqual(run[f"chip.pe_array.kernels.{name}.cycles"], cycles[0])
        self.assertNotIn("chip.pio.busy", run)
        with self.assertRaisesRegex(KeyError, "chip.pio.busy.*stats --describe"):
            run["chip.pio.busy"]

    def test_a_sweep_has_points_series_and_a_front(self):
        sweep = csx600.read_sweep(self.sweep_directory)
        self.assertEqual([point.status for point in sweep.points], ["done"] * 4 + ["excluded"] * 2)
        self.assertEqual(sweep.columns["cycles_a_ray"].unit, "cycles/ray")
        self.assertEqual(sweep.columns["cycles_a_ray"].section, "derived")
        series = sweep.series("chip.pes", "simulated_cycles", pio__setup_cycles=900)
        self.assertEqual([pes for pes, _ in series], [32, 64])
        point = sweep.where(chip__pes=64, pio__setup_cycles=900)[0]
        self.assertEqual(series[1][1], point["simulated_cycles"])
        self.assertAlmostEqual(point["cycles_a_ray"], point["simulated_cycles"] / point["rays"])
        self.assertEqual(point["firmware.traversal"], "brute_force")
        front = sweep.pareto(gain="rays_per_second", cost="chip.pes")
        self.assertEqual([point["pio.setup_cycles"] for point in front], [0] * len(front))
        with self.assertRaisesRegex(KeyError, "found on no axis"):
            sweep.where(chip__pse=64)
        with self.assertRaisesRegex(KeyError, "excluded"):
            sweep.points[5]["rays"]

    def test_other_files_are_refused_by_name(self):
        for text, found in (("{", "not JSON"), ("[]", "None"), ('{"format": "x"}', "'x'")):
            path = self.write("other.json", text)
            with self.assertRaisesRegex(ValueError, f"other.json: .*{found}"):
                csx600.read_run(path)
        self.write("sweep.json", '{"format": "csx600-statistics-2"}')
        with self.assertRaisesRegex(ValueError, "sweep.json: found format"):
            csx600.read_sweep(self.directory.name)

    def test_the_example_says_what_it_found(self):
        script = os.path.join(os.path.dirname(explore.__file__), "explore.py")
        out = subprocess.run(["python3", script, self.directory.name], check=True, capture_output=True, text=True).stdout
        self.assertIn("6 of 8 points", out)
        self.assertIn("busiest kernel: intersect", out)


if __name__ == "__main__":
    unittest.main()
