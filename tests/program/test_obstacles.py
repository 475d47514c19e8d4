"""Obstacles in whole runs: what is held stays outside, from every side, and pushes back with its weight."""
import unittest

from harness import ProgramTest, small_deck
from results import Results


class Obstacles(ProgramTest):
    def obstacle_deck(self, obstacle, water, **changes):
        deck = small_deck(
            domain={"min": [0, 0], "max": [1.2, 0.8], "cell_size": 0.05}, time={"end": 0.5}, output={"interval": 0.1, "fields": ["velocity"]},
            bodies=[{"name": "water", "material": "water", "shape": {"box": water}}], obstacles=[{"name": "wall", "shape": obstacle}], gauges={})
        deck.update(changes)
        return deck

    def places(self, deck, out="out"):
        self.run_deck(self.write(deck), out, "--overwrite")
        return Results(self.scratch / out).frames[-1].field("position")

    def test_a_tank_cut_as_one_obstacle_holds_its_water(self):
        tank = {"difference": [{"box": {"min": [0.2, 0.1], "max": [1.0, 0.7]}}, {"box": {"min": [0.35, 0.25], "max": [0.85, 0.9]}}]}
        x = self.places(self.obstacle_deck(tank, {"min": [0.35, 0.25], "max": [0.85, 0.55]}))
        self.assertGreater(x[:, 1].min(), 0.25 - 0.01)
        self.assertGreater(x[:, 0].min(), 0.35 - 0.01)
        self.assertLess(x[:, 0].max(), 0.85 + 0.01)

    def test_a_floor_from_wall_to_wall_is_one(self):
        for floor in ({"box": {"min": [0, 0], "max": [1.2, 0.1]}}, {"union": [{"box": {"min": [0, 0], "max": [0.5, 0.1]}}, {"box": {"min": [0.5, 0], "max": [1.2, 0.1]}}]}):
            x = self.places(self.obstacle_deck(floor, {"min": [0, 0.1], "max": [1.2, 0.4]}))
            self.assertGreater(x[:, 1].min(), 0.1, floor)

    def test_a_thin_wall_holds_from_either_side(self):
        for low, high in ((0.59, 0.61), (0.55, 0.6), (0.57, 0.65)):
            ends = {}
            for side, water in (("left", [0, low]), ("right", [high, 1.2])):
                wall = {"box": {"min": [low, 0], "max": [high, 0.8]}}
                x = self.places(self.obstacle_deck(wall, {"min": [water[0], 0], "max": [water[1], 0.4]}))
                ends[side] = x[:, 0].max() - low if side == "left" else high - x[:, 0].min()
            self.assertLess(max(ends.values()), 0.05, (low, high, ends))

    def test_still_water_lifts_a_box_by_its_weight_in_water(self):
        for points in ([[0.5, 0.2], [0.7, 0.2], [0.7, 0.4], [0.5, 0.4]], [[0.7, 0.4], [0.5, 0.4], [0.5, 0.2], [0.7, 0.2]]):
            deck = self.obstacle_deck({"polygon": {"points": points}}, {"min": [0, 0], "max": [1.2, 0.6]}, gauges={"lift": {"kind": "force", "obstacle": "wall"}})
            deck["bodies"][0]["initial_stress"] = {"kind": "hydrostatic", "surface": {"point": [0, 0.6]}}
            self.places(deck)
            lift = Results(self.scratch / "out").gauge("lift")[1][1:].mean(axis=0)
            self.assertAlmostEqual(lift[1] / (1000 * 9.81 * 0.04), 1, delta=0.02)
            self.assertAlmostEqual(lift[0] / (1000 * 9.81 * 0.04), 0, delta=0.02)


if __name__ == "__main__":
    unittest.main()
