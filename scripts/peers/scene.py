"""What the peer programs share: the scene of block2d.json or block3d.json as plain arrays, the command line, and the figures they print.

A peer is one file with a class Peer(scene, threads): run(steps) advances, state() returns positions, velocities and densities as arrays (N, dim)
and (N). All peers take the step of the yardstick: APIC with quadratic splines (Jiang et al. 2015), forces with the moving-least-squares
gradient (Hu et al. 2018), p = c²(ρ − ρ0), density updated by the trace of the velocity gradient.
"""
import argparse
import json
import os
import pathlib
import re
import time

HERE = pathlib.Path(__file__).resolve().parent


class Scene:
    """Numbers and first state of a deck with one block of fluid and a fixed step. `nodes`: grid nodes along each axis."""

    def __init__(self, dim):
        import numpy as np

        deck = json.loads(re.sub(r"//.*", "", (HERE / f"block{dim}d.json").read_text()))
        body, method, fluid = deck["bodies"][0], deck["method"], deck["materials"]["water"]
        self.dim, self.dx, self.dt = dim, deck["domain"]["cell_size"], deck["time"]["step"]
        self.type = {"f32": np.float32, "f64": np.float64}[method["precision"]]
        self.density, self.sound_speed, self.gravity = fluid["density"], fluid["sound_speed"], deck["gravity"][-1]
        self.nodes = [round(length / self.dx) + 1 for length in deck["domain"]["max"]]
        low, high = body["shape"]["box"]["min"], body["shape"]["box"]["max"]
        places = [a + (np.arange(2 * round((b - a) / self.dx)) + 0.5) * self.dx / 2 for a, b in zip(low, high)]
        self.position = _by_cell(np.meshgrid(*places, indexing="ij"))
        names = dict(zip("xyz", self.position.T))
        self.velocity = np.stack([eval(v, {"__builtins__": {}}, names) for v in body["velocity"]], axis=1)  # our own deck's expressions
        self.count = len(self.position)
        self.mass = self.density * (self.dx / 2) ** dim


def _by_cell(grid):
    """Points of a lattice with two a cell along each axis, (N, dim), those of a cell behind each other: neighbours in space are neighbours in memory."""
    import numpy as np

    dim = len(grid)
    shape = [length for n in grid[0].shape for length in (n // 2, 2)]
    order = [2 * a for a in range(dim)] + [2 * a + 1 for a in range(dim)]
    return np.stack([np.transpose(g.reshape(shape), order).ravel() for g in grid], axis=1)


def figures(position, velocity, density):
    """Means and spreads by which two programs' states are compared."""
    return {
        "mean_position": position.mean(axis=0).tolist(),
        "spread": position.std(axis=0).tolist(),
        "mean_velocity": velocity.mean(axis=0).tolist(),
        "velocity_spread": velocity.std(axis=0).tolist(),
        "mean_density": float(density.mean()),
        "density_spread": float(density.std()),
    }


def time_gradient(peer, steps):
    """Seconds of a gradient, once it is compiled."""
    take = peer.gradient(steps)
    take()
    began = time.perf_counter()
    take()
    return time.perf_counter() - began


def main(name, load):
    """Command line of a peer. `load` imports the peer's library, once threads are limited, and returns (Peer, version)."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--dim", type=int, choices=(2, 3), required=True)
    parser.add_argument("--steps", type=int, required=True, help="steps that are timed")
    parser.add_argument("--check-steps", type=int, required=True, help="steps from the start after which the state is described")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--gradient", action="store_true", help="time the gradient of as many steps, too")
    options = parser.parse_args()
    # Libraries start a thread for each processor they may use, whatever else they are told.
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: options.threads])
    peer_class, version = load(options.threads)
    scene = Scene(options.dim)
    began = time.perf_counter()
    peer = peer_class(scene, options.threads)
    peer.run(options.check_steps)
    preparation = time.perf_counter() - began
    described = figures(*peer.state())
    peer.run(options.steps)  # every shape is compiled, every page touched
    cpu, began = time.process_time(), time.perf_counter()
    peer.run(options.steps)
    seconds, cpu = time.perf_counter() - began, time.process_time() - cpu
    gradient = time_gradient(peer, options.steps) if options.gradient else None
    print(json.dumps({"peer": name, "gradient_seconds": gradient, "version": version, "particles": scene.count, "steps": options.steps, "threads": options.threads, "seconds": seconds,
                      "cpu_seconds": cpu, "preparation_seconds": preparation, "state": described}))
