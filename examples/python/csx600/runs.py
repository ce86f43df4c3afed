"""Statistics of one run: the file of `csx600 render --stats FILE.json` and of `csx600 run --stats FILE.json`."""

import json

FORMAT = "csx600-statistics-"


def _entries(value):
    if isinstance(value, dict):
        return value.items()
    if isinstance(value, list):
        named = all(isinstance(entry, dict) and "name" in entry for entry in value)
        return ((entry["name"] if named else str(place), entry) for place, entry in enumerate(value))
    return ()


def flatten(value, path=""):
    """Every number, text and flag below `value`, by the names that lead to it, joined by dots.

    An entry of a list goes by its own name if it has one, like kernels: "chip.pe_array.kernels.intersect.cycles".
    """
    if not isinstance(value, (dict, list)):
        return {path: value}
    flat = {}
    for name, entry in _entries(value):
        flat.update(flatten(entry, f"{path}.{name}" if path else name))
    return flat


class Run:
    """The statistics of a run. run["chip.pio.busy_cycles"] is a counter; `run.json` is the whole file."""

    def __init__(self, contents):
        self.json = contents
        self._flat = flatten(contents)

    def __getitem__(self, key):
        if key not in self._flat:
            raise KeyError(f"{key}: the run has no such counter; `csx600 stats --describe` lists them")
        return self._flat[key]

    def __contains__(self, key):
        return key in self._flat

    def get(self, key, default=None):
        return self._flat.get(key, default)

    def keys(self):
        return self._flat.keys()

    def below(self, prefix):
        """{name: value} of everything below a key: below("chip.control_unit.cycles_by_cause")."""
        start = prefix + "."
        return {key[len(start) :]: value for key, value in self._flat.items() if key.startswith(start)}

    def kernels(self):
        """{name: {counter: value}} of the kernels that ran, the one that took most cycles first."""
        kernels = self.json.get("chip", {}).get("pe_array", {}).get("kernels", [])
        return {kernel["name"]: kernel for kernel in sorted(kernels, key=lambda kernel: -kernel["cycles"])}


def read_json(path, file_format, writer):
    """The JSON of a file that `writer` wrote in a version of `file_format`. Raises ValueError, a line that names the file."""
    with open(path, encoding="utf-8") as file:
        try:
            contents = json.load(file)
        except json.JSONDecodeError as error:
            raise ValueError(f"{path}: not JSON: {error}") from None
    found = contents.get("format") if isinstance(contents, dict) else None
    if not str(found).startswith(file_format):
        raise ValueError(f"{path}: found format {found!r}; allowed: {file_format}..., which {writer} writes")
    return contents


def read_run(path):
    """Raises ValueError, a line that names the file, if it is not the statistics of a run."""
    return Run(read_json(path, FORMAT, "csx600 render --stats"))
