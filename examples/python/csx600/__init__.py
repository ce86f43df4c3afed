"""Reads what the program csx600 writes: statistics of runs, and sweeps.

Standard library only. Files are read as they are, and nothing is converted but numbers.

    run = csx600.read_run("full.json")
    run["chip.pio.busy_cycles"] / run["simulated_cycles"]
    sweep = csx600.read_sweep("n_by_pio_cost.sweep")
    best = max(sweep.done(), key=lambda point: point["rays_per_second"])
"""

from csx600.runs import Run, read_run
from csx600.sweeps import Column, Point, Sweep, read_sweep

__all__ = ["Column", "Point", "Run", "Sweep", "read_run", "read_sweep"]
