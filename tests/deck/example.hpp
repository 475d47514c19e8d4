#pragma once
// Decks for the tests, written to a folder of their own that goes away with the test.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.hpp"
#include "deck/deck.hpp"

namespace jaxmpm::test {

/// A folder for one test.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "jaxmpm_deck_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string directory(const std::string& name) const { return (path_ / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    const std::filesystem::path at = path_ / name;
    std::ofstream(at, std::ios::binary) << text;
    return at.string();
  }

 private:
  std::filesystem::path path_;
};

/// A small 2D deck: required keys only.
inline const char* const small_deck = R"({
  "jaxmpm": 1,
  "domain": { "min": [0, 0], "max": [1, 0.5], "cell_size": 0.1 },  // ten by five cells
  "gravity": [0, -9.81],
  "time": { "end": 0.1 },
  "materials": { "water": { "model": "newtonian", "density": 1000, "sound_speed": 20 } },
  "bodies": [ { "name": "pool", "material": "water", "shape": { "box": { "min": [0, 0], "max": [0.5, 0.3] } } } ],
  "output": { "interval": 0.05 }
}
)";

/// A 3D deck in which every optional key that can stand beside the others is given.
inline const char* const full_deck = R"({
  "$schema": "deck.schema.json",
  "jaxmpm": 1,
  "title": "Everything",
  "domain": { "min": [0, 0, 0], "max": [1, 0.5, 0.4], "cell_size": 0.05 },
  "gravity": [0, 0, -9.81],
  "time": { "end": 1, "step": "auto", "cfl": 0.3 },
  "method": { "transfer": "flip", "flip_fraction": 0.95, "basis": "cubic", "gradient": "mls", "precision": "f32" },
  "parameters": { "u0": 0.5 },
  "materials": {
    "water": { "model": "newtonian", "density": 1000, "sound_speed": 35, "viscosity": 1e-3, "tension_limit": 0 },
    "sand": { "model": "drucker_prager", "density": 1600, "friction_angle": 30, "bulk_modulus": 1e6, "poisson_ratio": 0.3,
              "dilation_angle": 5, "cohesion": 100, "tension_cutoff": 50 },
    "rubber": { "model": "neo_hookean", "density": 1100, "youngs_modulus": 1e5, "poisson_ratio": 0.4 },
    "steel": { "model": "linear_elastic", "density": 7800, "youngs_modulus": 1e7, "poisson_ratio": 0.3 }
  },
  "bodies": [
    { "name": "pool", "material": "water", "particles_per_cell": 27, "velocity": ["u0 * z", 0, 0], "initial_stress": "hydrostatic",
      "shape": { "difference": [ { "box": { "min": [0, 0, 0], "max": [0.2, 0.5, 0.2] } }, { "sphere": { "center": [0, 0, 0], "radius": 0.1 } } ] } },
    { "name": "heap", "material": "sand", "spacing": 0.02, "initial_stress": { "k0": 0.4, "surface": { "point": [0, 0, 0.1] } },
      "jitter": { "fraction": 0.5, "seed": 7 },
      "shape": { "layer": { "height_map": { "file": "g.asc", "offset": [1, 2, 3], "vertical_scale": 2 }, "thickness": 0.1,
                            "area": [[0.3, 0], [0.5, 0], [0.5, 0.5]] } } },
    { "name": "ball", "material": "rubber", "initial_stress": { "kind": "geostatic", "surface": { "point": [0, 0, 0.1] } },
      "velocity": [0, { "mlp": { "inputs": ["x", "z"], "hidden": [8, 8], "activation": "tanh", "seed": 3, "input_center": [0.5, 0.1], "input_scale": [1, 2], "output_scale": 0.1 } }, -1],
      "shape": { "union": [ { "sphere": { "center": [0.7, 0.2, 0.2], "radius": 0.1 } }, { "mesh": { "file": "b.stl", "scale": 0.1 } } ] } },
    { "name": "rod", "material": "steel", "velocity": { "particles": { "file": "v.csv" } },
      "shape": { "layer": { "height_map": { "file": "g.asc" }, "thickness": 0.1, "area": { "file": "a.csv" } } } }
  ],
  "walls": { "x_min": { "kind": "no_slip" }, "y_max": { "kind": "friction", "coefficient": 0.3 },
             "z_min": { "kind": "friction", "segments": [ { "to": 0.4, "coefficient": 0.5 }, { "to": 1.0, "coefficient": 0.1 } ] } },
  "obstacles": [ { "name": "tower", "shape": { "cylinder": { "from": [0.5, 0.3, 0], "to": [0.5, 0.3, 0.4], "radius": 0.02 } }, "kind": "friction", "coefficient": 0.2 },
                 { "name": "ground", "shape": { "height_map": { "file": "g.asc" } } } ],
  "gauges": {
    "front": { "kind": "front", "body": "pool", "axis": "x", "direction": "-", "depth": 0.01, "connected": true, "smooth": 0.02 },
    "spread": { "kind": "front", "body": "heap", "axis": "radius", "center": [0.5, 0.2], "quantile": 0.99 },
    "mean": { "kind": "region_mean", "field": "pressure", "min": [0, 0, 0], "max": [0.1, 0.1, 0.1] },
    "level": { "kind": "height", "at": [0.25, 0.25] },
    "probe": { "kind": "pressure", "at": [0.25, 0.25, 0.1] },
    "load": { "kind": "force", "obstacle": "tower" },
    "push": { "kind": "force", "wall": "x_max" },
    "energy": { "kind": "energy" },
    "momentum": { "kind": "momentum" },
    "some": { "kind": "particles", "ids": [1, 5], "fields": ["position", "stress"] }
  },
  "output": { "interval": 0.02, "directory": "out/all", "gauge_interval": 0.001, "formats": ["hdf5"], "fields": ["velocity"], "checkpoint_interval_minutes": 5 },
  "inverse": {
    "unknowns": [ { "path": "/walls/z_min/segments/*/coefficient", "start": [0.1, 0.2], "bounds": [0, 1], "transform": "logit", "prior": { "mean": 0.3, "deviation": 0.1 } },
                  { "path": "/bodies/2/velocity/1/mlp", "prior": { "mean": 0, "deviation": 1 } },
                  { "path": "/materials/*/density", "start": 1200, "share": true, "transform": "log" } ],
    "observations": [
      { "kind": "particles", "body": "pool", "field": "position", "file": "t.h5", "select": { "random": 500, "seed": 1 }, "from_time": 0, "to_time": 0.7, "every": 0.1, "average": 0.2 },
      { "kind": "gauge", "gauge": "front", "file": "g.csv", "weight": 2, "noise": { "deviation": 0.1, "seed": 2 }, "mask": "good" },
      { "kind": "profile", "body": "heap", "file": "p.csv", "time": 0.5, "mask": { "box": { "min": [0, 0, 0], "max": [1, 1, 1] } } } ],
    "optimizer": { "method": "lbfgs", "iterations": 30, "memory": 5, "tolerance": 1e-4 },
    "memory": "2 GiB", "disk": "10 GiB" }
}
)";

}  // namespace jaxmpm::test
