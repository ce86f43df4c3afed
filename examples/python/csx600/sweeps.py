"""A sweep: the directory that `csx600 sweep` fills."""

import csv
import os

from csx600.runs import read_json

FORMAT = "csx600-sweep-"


class Column:
    """Name, section (input, chosen, result, derived, status), unit and meaning of a column."""

    def __init__(self, name, section, unit, meaning):
        self.name = name
        self.section = section
        self.unit = unit
        self.meaning = meaning

    def __repr__(self):
        return f"{self.name} [{self.unit or '-'}]: {self.meaning}"


class Point:
    """One combination of the axes' values. point["chip.pes"] is an input, point["rays_per_second"] a result."""

    def __init__(self, contents):
        self.inputs = contents["inputs"]
        self.status = contents["status"]
        self.error = contents.get("error", "")
        self.chosen = contents.get("chosen", {})
        self.results = contents.get("results", {})

    def __getitem__(self, key):
        for values in (self.inputs, self.chosen, self.results):
            if key in values:
                return values[key]
        raise KeyError(f"{key}: found neither among the inputs nor among the results of a point that is {self.status}")

    def get(self, key, default=None):
        try:
            return self[key]
        except KeyError:
            return default

    def __repr__(self):
        return ", ".join(f"{key}={value}" for key, value in self.inputs.items()) + f": {self.status}"


class Sweep:
    """Points in the order of the sweep, and what their columns mean."""

    def __init__(self, contents, columns):
        self.keys = contents["keys"]
        self.axes = contents["axes"]
        self.base = contents["base"]
        self.points = [Point(point) for point in contents["points"]]
        self.columns = {column.name: column for column in columns}

    def done(self):
        """The points that ran and meet every constraint of the sweep."""
        return [point for point in self.points if point.status == "done"]

    def where(self, **values):
        """Points with these inputs; "__" stands for a dot: where(chip__pes=96, firmware__n=1)."""
        wanted = {name.replace("__", "."): value for name, value in values.items()}
        unknown = [key for key in wanted if key not in self.keys]
        if unknown:
            raise KeyError(f"{unknown[0]}: found on no axis; allowed: {', '.join(self.keys)}")
        return [point for point in self.done() if all(point.inputs[key] == value for key, value in wanted.items())]

    def series(self, x, y, **values):
        """[(x, y)] in the order of x, for a plot; `values` as where() takes them."""
        return sorted((point[x], point[y]) for point in self.where(**values))

    def pareto(self, gain, cost):
        """The points for which no other has more gain at no more cost, from the cheapest up."""
        front = []
        for point in sorted(self.done(), key=lambda point: (point[cost], -point[gain])):
            if not front or point[gain] > front[-1][gain]:
                front.append(point)
        return front


def _read_columns(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [Column(row["column"], row["section"], row["unit"], row["meaning"]) for row in csv.DictReader(file)]


def read_sweep(directory):
    """Raises ValueError, a line that names the file, if the directory holds no finished or stopped sweep."""
    contents = read_json(os.path.join(directory, "sweep.json"), FORMAT, "csx600 sweep")
    return Sweep(contents, _read_columns(os.path.join(directory, "columns.csv")))
