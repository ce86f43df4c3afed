#!/usr/bin/env python3
"""Run time against error: this project's program and Blender's Cycles on the same scenes, on the same core, in turn.

    tests/benchmarks/cycles/compare.py [--csx600 PROGRAM] [--core N] [--samples 16,64,256] [SCENE...]

For each scene and number of samples, both render it natively with one thread, Cycles, this, Cycles, this, and the
mean over the turns is taken of MSE and of CPU seconds. C = MSE x CPU seconds. Each is compared with a reference of its
own, because their models of metal and varnish are not the same; the table says how far the references' means are apart.
The light's pixels do not count. README.md says what was found.
"""

import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
SCENES = ["cornell_box", "glossy", "glass"]
SIDE = 48  # pixels, the size of the shipped references


def run(command):
    finished = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if finished.returncode != 0:
        sys.exit(f"compare.py: {command[0]} failed:\n{finished.stdout[-2000:]}{finished.stderr[-2000:]}")
    return finished.stdout


class Comparison:
    def __init__(self, csx600, core, folder):
        self.csx600 = csx600
        self.on_core = ["taskset", "-c", str(core)]
        self.folder = folder

    def cycles(self, scene, seed, samples, output):
        """CPU seconds."""
        out = run([*self.on_core, "blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python",
                   HERE / "render_in_cycles.py", "--", scene, SIDE, SIDE, seed, samples, output])
        return float(re.search(r"^cpu_seconds (\S+)$", out, re.MULTILINE)[1])

    def this(self, scene, seed, samples, output):
        """CPU seconds."""
        statistics = self.folder / "statistics.json"
        run([*self.on_core, self.csx600, "render", scene, "--native", "--size", f"{SIDE}x{SIDE}", "--seed", seed,
             "--samples", samples, "--exr", output, "--stats", statistics])
        return json.loads(statistics.read_text())["simulator"]["cpu_seconds"]

    def error(self, scene, image, reference):
        """MSE without the reference's own, and biases of the mean of R, G, B in percent."""
        out = run([self.csx600, "bench", "image", image, reference, "--scene", scene])
        rmse = float(re.search(r"^RMSE +(\S+)$", out, re.MULTILINE)[1])
        bias = re.search(r"^mean bias R, G, B, % +(\S+) (\S+) (\S+)$", out, re.MULTILINE)
        return rmse * rmse, [float(bias[i]) for i in (1, 2, 3)]

    def cycles_reference(self, scene, samples):
        """An image, and what its noise adds to an MSE: half the difference of two such images."""
        images = [self.folder / f"{scene.name}_reference{seed}.exr" for seed in (1001, 1002)]
        for seed, image in zip((1001, 1002), images):
            self.cycles(scene, seed, samples, image)
        return images[0], 0.5 * self.error(scene, images[1], images[0])[0]

    def compare(self, scene, all_samples, turns):
        reference = scene / "reference.exr"
        cycles_reference, noise = self.cycles_reference(scene, 16 * max(all_samples))
        bias = self.error(scene, cycles_reference, reference)[1]
        print(f"{scene.name}: mean of Cycles over this, R, G, B: {bias[0]:+.2f} {bias[1]:+.2f} {bias[2]:+.2f} %")
        print(f"{'samples':>8} {'Cycles: s':>10} {'RMSE':>10} {'C':>10} {'this: s':>10} {'RMSE':>10} {'C':>10} {'ratio of C':>11}")
        for samples in all_samples:
            sums = {"cycles": [0, 0], "this": [0, 0]}
            for turn in range(turns):
                for name, render, truth, extra in (("cycles", self.cycles, cycles_reference, noise),
                                                   ("this", self.this, reference, 0)):
                    image = self.folder / f"{name}.exr"
                    sums[name][0] += render(scene, turn + 1, samples, image) / turns
                    sums[name][1] += (self.error(scene, image, truth)[0] - extra) / turns
            row = f"{samples:8d}"
            for seconds, mse in sums.values():
                row += f" {seconds:10.3f} {max(mse, 0) ** 0.5:10.6f} {seconds * mse:10.3e}"
            theirs, ours = (seconds * mse for seconds, mse in sums.values())
            print(f"{row} {ours / theirs:11.2f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--csx600", default=ROOT / "build/release/csx600", type=pathlib.Path)
    parser.add_argument("--core", default=0, type=int, help="the core that both run on")
    parser.add_argument("--samples", default="16,64,256", help="powers of two")
    parser.add_argument("--turns", default=4, type=int, help="how often each renders each picture, with other seeds")
    parser.add_argument("scenes", nargs="*", default=SCENES, metavar="SCENE")
    arguments = parser.parse_args()
    if shutil.which("blender") is None:
        sys.exit("compare.py: found no program blender; install Debian's package blender")
    with tempfile.TemporaryDirectory() as folder:
        comparison = Comparison(arguments.csx600.resolve(), arguments.core, pathlib.Path(folder))
        for name in arguments.scenes:
            comparison.compare(ROOT / "scenes" / name, [int(n) for n in arguments.samples.split(",")], arguments.turns)


main()
