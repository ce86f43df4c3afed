#!/usr/bin/env python3
"""What limits the chip, and what would help: a run and a sweep, read and asked a few questions.

Usage, from the project's root, with the program `csx600` in the PATH or named by $CSX600:

    examples/python/explore.py            # makes the run and the sweep in a temporary directory; a second
    examples/python/explore.py DIRECTORY  # keeps them there

Each part below stands for a cell of a notebook.
"""

import os
import subprocess
import sys
import tempfile

import csx600

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCENE = os.path.join(ROOT, "scenes", "cornell_box")
PROGRAM = os.environ.get("CSX600", "csx600")

SWEEP = f"""
scene = "{SCENE}"
size = "32x32"
samples = 4

[constraint]
sram = "chip.pes * poly.sram_bytes <= 1200000"

[derived]
nanojoules_a_ray = {{ expression = "chip.energy.joules / rays * 1e9", unit = "nJ" }}

[[axis]]
chip.pes = [48, 96, 192, 384]
[[axis]]
pio.per_pe_cycles = [4, 16]
"""


def csx600_program(*arguments):
    subprocess.run([PROGRAM, *arguments], check=True, stdout=subprocess.DEVNULL)


def show_run(run):
    """One run: where do the cycles go?"""
    cycles = run["simulated_cycles"]
    print(f"{cycles} cycles, {run['simulated_seconds'] * 1e3:.1f} ms, {run['chip.energy.watts']:.1f} W")
    for cause, count in sorted(run.below("chip.control_unit.cycles_by_cause").items(), key=lambda item: -item[1])[:4]:
        print(f"  {cause:20} {count / cycles:6.1%}")
    name, kernel = next(iter(run.kernels().items()))
    print(f"  busiest kernel: {name}, SIMD efficiency {kernel['simd_efficiency']:.1%}")


def show_sweep(sweep):
    """A sweep: do more PEs pay, and for how long?"""
    gain = sweep.columns["rays_per_second"]
    print(f"{len(sweep.done())} of {len(sweep.points)} points; {gain.name} [{gain.unit}]: {gain.meaning}")
    for cost in (16, 4):
        print(f"  a PE's turn of {cost} cycles:")
        for pes, rays in sweep.series("chip.pes", "rays_per_second", pio__per_pe_cycles=cost):
            print(f"    {pes:4} PEs {rays / 1e6:6.2f} million rays/s")
    print("  best for their energy:")
    for point in sweep.pareto(gain="rays_per_second", cost="nanojoules_a_ray"):
        print(f"    {point}: {point['rays_per_second'] / 1e6:.2f} million rays/s, {point['nanojoules_a_ray']:.0f} nJ a ray")


def main():
    with tempfile.TemporaryDirectory() as temporary:
        directory = sys.argv[1] if len(sys.argv) > 1 else temporary
        os.makedirs(directory, exist_ok=True)
        run_file = os.path.join(directory, "run.json")
        csx600_program("render", SCENE, "--size", "32x32", "--samples", "4", "--stats", run_file)
        show_run(csx600.read_run(run_file))
        sweep_file = os.path.join(directory, "width.toml")
        with open(sweep_file, "w", encoding="utf-8") as file:
            file.write(SWEEP)
        output = os.path.join(directory, "width.sweep")
        csx600_program("sweep", sweep_file, "-o", output)
        show_sweep(csx600.read_sweep(output))


if __name__ == "__main__":
    main()
