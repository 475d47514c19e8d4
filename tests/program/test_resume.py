"""Stopping and going on: signals, wall time, kill -9 at any moment, damaged and foreign checkpoints."""
import json
import pathlib
import random
import signal
import time
import unittest

from harness import DECK, DONE, INPUTS, IO, STOPPED, ProgramTest, coarse_decks, small_deck, stop


class Resume(ProgramTest):
    def long_deck(self, **changes):
        """Long enough to be stopped on the way: some tenths of a second on one core."""
        deck = small_deck(time={"end": 0.4}, domain={"min": [0, 0], "max": [1.0, 0.5], "cell_size": 0.0125})
        deck["output"] = {"interval": 0.02, "gauge_interval": 0.004, "checkpoint_interval_minutes": 0.002}
        deck.update(changes)
        return self.write(deck)

    def seconds(self, deck, out):
        """Wall time of a whole run, s: what the moments to stop at are chosen from, so that they fall within the run on any machine."""
        begun = time.monotonic()
        self.run_deck(deck, out)
        return time.monotonic() - begun

    def begin(self, deck, out, *more):
        """With two threads, as frames and checkpoints are then written beside the steps."""
        return self.start("run", deck, "-o", out, "--threads", "2", *more)

    def wait_for(self, path, process):
        end = time.monotonic() + 60
        while not (self.scratch / path).exists() and process.poll() is None and time.monotonic() < end:
            time.sleep(0.005)

    def test_signals_stop_with_a_checkpoint(self):
        deck = self.long_deck()
        self.run_deck(deck, "whole")
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1):
            out = f"out{number}"
            process = self.begin(deck, out)
            self.wait_for(f"{out}/frames/000002.h5", process)
            code, said = stop(process, number)
            self.assertEqual(code, STOPPED, said)
            self.assertIn("--resume", said)
            self.assertTrue((self.scratch / out / "checkpoint.h5").exists())
            self.assertEqual(json.loads((self.scratch / out / "run.json").read_text())["outcome"], "stopped")
            self.run_deck(deck, out, "--resume", "auto")
            self.assertSameResults("whole", out)

    def test_wall_time(self):
        deck = self.long_deck()
        minutes = f"{self.seconds(deck, 'whole') / 60 / 4:.7f}"
        self.run_deck(deck, "out", "--max-walltime", minutes, code=STOPPED)
        for _ in range(200):
            done = self.call("run", deck, "-o", "out", "--threads", "1", "--resume", "auto", "--max-walltime", minutes)
            if done.returncode == DONE:
                break
            self.assertEqual(done.returncode, STOPPED, done.stderr)
        self.assertSameResults("whole", "out")

    def test_kill_at_any_moment(self):
        deck = self.long_deck()
        whole = self.seconds(deck, "whole")
        rng = random.Random(1)
        kills = 0
        for _ in range(60):
            process = self.begin(deck, "out", "--resume", "auto")
            try:
                process.communicate(timeout=rng.uniform(0.1, 0.6) * whole)
            except Exception:
                process.kill()
                process.communicate()
                kills += 1
            if (self.scratch / "out").exists():
                self.assertNoHalfFiles("out")
            if process.returncode == DONE:
                break
        self.run_deck(deck, "out", "--resume", "auto")
        self.assertGreater(kills, 1)
        self.assertSameResults("whole", "out")
        self.assertFalse([path for path in (self.scratch / "out").rglob("*.tmp")])

    def test_a_later_end_continues_as_if_the_earlier_had_never_been(self):
        for step in ("auto", 4e-4):
            deck = self.long_deck(time={"end": 0.21, "step": step})
            self.run_deck(deck, f"whole{step}")
            self.run_deck(deck, f"out{step}", "--set", "/time/end=0.07")
            self.run_deck(deck, f"out{step}", "--resume", "auto")
            self.assertSameResults(f"whole{step}", f"out{step}")
            self.run_deck(deck, f"out{step}", "--resume", "auto")  # done already: again the same
            self.assertSameResults(f"whole{step}", f"out{step}")
            said = self.run_deck(deck, f"out{step}", "--resume", "auto", "--set", "/time/end=0.05", code=DECK)
            self.assertIn("/time/end", said)

    def test_a_checkpoint_file_into_another_directory_brings_its_frames(self):
        deck = self.long_deck(time={"end": 0.1})
        self.run_deck(deck, "whole")
        self.run_deck(deck, "first", "--set", "/time/end=0.05")
        self.run_deck(deck, "second", "--resume", "first/checkpoint.h5")
        self.assertSameResults("whole", "second")
        self.run_deck(deck, "second", "--resume", "first/checkpoint.h5", code=IO)

    def test_frames_that_are_not_beside_the_checkpoint_are_told_of(self):
        deck = self.long_deck(time={"end": 0.06})
        self.run_deck(deck, "first", "--set", "/time/end=0.04")
        (self.scratch / "alone").mkdir()
        (self.scratch / "first/checkpoint.h5").rename(self.scratch / "alone/checkpoint.h5")
        said = self.run_deck(deck, "second", "--resume", "alone/checkpoint.h5")
        self.assertRegex(said, r"([1-9]) of the \1 frames before the checkpoint are in neither")
        self.assertNotIn("frames before the checkpoint", self.run_deck(deck, "whole"))

    def test_nothing_to_resume_starts_at_the_beginning(self):
        deck = self.long_deck(time={"end": 0.05})
        self.assertIn("no checkpoint", self.run_deck(deck, "out", "--resume", "auto"))
        self.run_deck(deck, "out2", "--resume", "missing.h5", code=IO)

    def test_another_deck_is_refused_with_the_difference(self):
        deck = self.long_deck(time={"end": 0.05})
        self.run_deck(deck, "out")
        said = self.run_deck(deck, "out", "--resume", "auto", "--set", "/materials/water/viscosity=0.1", "--set", "/gravity/1=-5", code=DECK)
        self.assertIn("/materials/water/viscosity", said)
        self.assertIn("/gravity/1", said)
        self.run_deck(deck, "out", "--resume", "auto", "--set", "/time/end=0.06", "--set", "/output/interval=0.01", "--set", '/output/formats=["hdf5"]')

    def test_damaged_checkpoints(self):
        deck = self.long_deck(time={"end": 0.1})
        self.run_deck(deck, "whole")
        self.run_deck(deck, "out", "--set", "/time/end=0.05")
        self.run_deck(deck, "out", "--resume", "auto")
        out = self.scratch / "out"
        self.assertTrue((out / "checkpoint.previous.h5").exists())
        for name in ("checkpoint.h5", "checkpoint.previous.h5"):
            content = bytearray((out / name).read_bytes())
            middle = len(content) // 2
            content[middle:middle + 64] = bytes(64 * [0x5A])
            (out / name).write_bytes(content)
            if name == "checkpoint.h5":
                said = self.run_deck(deck, "out", "--resume", str(out / name), code=IO)
                self.assertIn("damaged", said)
                self.run_deck(deck, "out", "--resume", "auto", "--set", "/output/checkpoint_interval_minutes=1000", "--max-walltime", "1000")
                self.assertSameResults("whole", "out")
                # The damaged one is now the previous: damage the new one too.
                (out / name).write_bytes(content[:len(content) // 2])
        said = self.run_deck(deck, "out", "--resume", "auto", code=IO)
        self.assertIn("--overwrite", said)
        (out / "checkpoint.h5").write_text("no checkpoint")
        self.run_deck(deck, "out", "--resume", str(out / "checkpoint.h5"), code=IO)

    def test_scenes_of_every_material_resume(self):
        for name in ("aluminium_bars.json", "elastic_block.json", "dam_break_friction.json", "granular_column_a2.json"):
            arguments = coarse_decks()[name]
            stem = pathlib.Path(name).stem
            self.run_deck(INPUTS / name, f"{stem}-whole", *arguments)
            self.run_deck(INPUTS / name, f"{stem}-out", *arguments, "--set", "/time/end=0.02")
            self.run_deck(INPUTS / name, f"{stem}-out", *arguments, "--resume", "auto")
            self.assertSameResults(f"{stem}-whole", f"{stem}-out")


if __name__ == "__main__":
    unittest.main()
