"""Runs variants of a scene with one thread, measures what they cost, and keeps them: a run that is there is not made again."""
import json
import os
import shutil
import subprocess
import sys

from bench_runs import environment
from charts_scene import ROOT
from results import Results
from support import command_line, complete

UNSTABLE = 3  # exit code
ENOUGH, MOST = 0.5, 3  # a run is timed again until its steps have taken so many seconds, so many times at most; the smallest time counts


class Runs:
    """The runs of one scene, in a folder of its own."""

    def __init__(self, program, out, scene):
        self.program, self.out, self.scene = program, out, scene
        out.mkdir(parents=True, exist_ok=True)

    def get(self, variant):
        """(cost, results) of a variant; results are None where the run failed: the cost then says why."""
        target = self.out / variant.name
        cost = self._kept(target)
        if cost is None:
            cost = self._measure(variant, target)
            (target / "cost.json").write_text(json.dumps(cost) + "\n", encoding="utf-8")
            said = cost.get("failed") or f"{cost['particles']} particles, {cost['steps']} steps, {cost['cpu_seconds']:.3g} s"
            print(f"  {variant.name}: {said}", flush=True)
        return cost, None if "failed" in cost else Results(target)

    def _kept(self, target):
        path = target / "cost.json"
        if not path.is_file():
            return None
        cost = json.loads(path.read_text(encoding="utf-8"))
        return cost if "failed" in cost or complete(target) else None

    def _measure(self, variant, target):
        command = [*command_line(self.program, self.scene.deck, target, self.scene.assignments(variant)), "--overwrite"]
        times = []
        while len(times) < MOST and sum(cpu for cpu, _ in times) < ENOUGH:
            shutil.rmtree(target, ignore_errors=True)
            target.mkdir()
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, env=environment(1))
            if done.returncode == UNSTABLE:
                return {"failed": done.stdout.strip().splitlines()[0]}
            if done.returncode:
                sys.exit(f"  {variant.name}: exit {done.returncode}\n{done.stdout}")
            summary = json.loads((target / "run.json").read_text(encoding="utf-8"))
            times.append((summary["cpu_seconds"], summary["seconds"]))
        for path in target.glob("checkpoint*"):
            path.unlink()
        cpu, wall = min(times)
        kept = {key: summary[key] for key in ("particles", "steps", "git_commit")}
        return {**kept, "particle_steps": kept["particles"] * kept["steps"], "cpu_seconds": cpu, "seconds": wall}


def program():
    return os.environ.get("JAXMPM", str(ROOT / "build" / "jaxmpm"))
