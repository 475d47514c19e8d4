"""Alternates the yardsticks and `jaxmpm bench` on the same scenes and prints the ratio of their rates; called by scripts/bench-yardstick."""
import json
import os
import pathlib
import subprocess
import sys

# scene: deck, arguments of the yardstick (cells along x, steps, steps between sorts), steps of the program
SCENES = {
    "3D, single precision": ("transfer3d", "block3d.json", ["20", "60", "10"], 60),
    "2D, double precision": ("transfer2d", "block2d.json", ["50", "4000", "20"], 4000),
}


def rate(command, threads):
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads), "OMP_PROC_BIND": "true"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stderr or done.stdout}")
    return json.loads(done.stdout)


def main():
    program, yardsticks, decks, rounds = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]), int(sys.argv[4])
    for scene, (yardstick, deck, arguments, steps) in SCENES.items():
        for threads in (1, 2):
            bare, ours = [], []
            for _ in range(rounds):
                bare.append(rate([yardsticks / yardstick, *arguments], threads))
                ours.append(rate([program, "bench", decks / deck, "--steps", str(steps), "--threads", str(threads), "--json"], threads))
            a, b = (max(runs, key=lambda run: run["particle_steps_per_second"]) for runs in (bare, ours))
            if a["particles"] != b["particles"]:
                sys.exit(f"{scene}: the yardstick has {a['particles']} particles, the program {b['particles']}")
            phases = {key: value for key, value in b.items() if isinstance(value, dict)}
            print(f"{scene}, {threads} thread(s): yardstick {a['particle_steps_per_second']:.4g}, jaxmpm {b['particle_steps_per_second']:.4g} particle-steps/s, "
                  f"ratio {b['particle_steps_per_second'] / a['particle_steps_per_second']:.3f}  {json.dumps(phases)}", flush=True)


if __name__ == "__main__":
    main()
