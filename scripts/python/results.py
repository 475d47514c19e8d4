"""Reads a results.h5 of jaxmpm (layout: docs/results.md)."""
import json
import pathlib

import h5py
import numpy as np


class Frame:
    """One output frame: `time` in s, `step`, and by body its fields as arrays in the order of ids."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        with h5py.File(self.path, "r") as file:
            self.time = float(file.attrs["time"])
            self.step = int(file.attrs["step"])
            self.bodies = sorted(name for name in file if isinstance(file[name], h5py.Group))

    def field(self, name, body=None):
        """Field of one body, or of all bodies one after the other; None where no body has it."""
        with h5py.File(self.path, "r") as file:
            parts = [file[b][name][...] for b in ([body] if body else self.bodies) if name in file[b]]
        return np.concatenate(parts) if parts else None

    def fields(self):
        """Names of the fields that at least one body carries."""
        with h5py.File(self.path, "r") as file:
            return sorted({name for body in self.bodies for name in file[body]})


class Results:
    """A run's results: `frames` in order, the `deck` with every default filled in, gauges by name."""

    def __init__(self, path):
        path = pathlib.Path(path)
        self.path = path / "results.h5" if path.is_dir() else path
        self.directory = self.path.parent
        with h5py.File(self.path, "r") as file:
            self.attributes = dict(file.attrs)
            self.deck = json.loads(self.attributes["deck_resolved"])
            self.gauge_names = sorted(file["gauges"]) if "gauges" in file else []
            links = [file["frames"].get(name, getlink=True) for name in sorted(file["frames"])]
        self.frames = [Frame(self.directory / link.filename) for link in links]

    @property
    def dimension(self):
        return len(self.deck["domain"]["min"])

    def gauge(self, name, masked=True):
        """(time, value) of a gauge; times at which it had no value are left out when `masked`."""
        with h5py.File(self.path, "r") as file:
            group = file["gauges"][name]
            time, value = group["time"][...], group["value"][...]
            valid = group["valid"][...].astype(bool) if "valid" in group else np.ones(len(time), bool)
        if masked and valid.ndim == 1:
            return time[valid], value[valid]
        return time, value

    def gauge_datasets(self, name):
        with h5py.File(self.path, "r") as file:
            return sorted(file["gauges"][name])

    def gauge_components(self, name):
        with h5py.File(self.path, "r") as file:
            group = file["gauges"][name]
            names = group["value"].attrs.get("components", group.attrs.get("components", []))
        if isinstance(names, (str, bytes)):
            names = (names.decode() if isinstance(names, bytes) else names).replace(",", " ").split()
        return [n.decode() if isinstance(n, bytes) else str(n) for n in names]

    def frame_at(self, time):
        """The frame nearest to a time."""
        return min(self.frames, key=lambda frame: abs(frame.time - time))

    def run(self):
        """run.json: particles, steps, seconds, rate, memory."""
        return json.loads((self.directory / "run.json").read_text())
