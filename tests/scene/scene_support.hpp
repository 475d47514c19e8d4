#pragma once
// Small decks, as structs, for the tests of the scene.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.hpp"
#include "scene/geometry.hpp"
#include "scene/model.hpp"

namespace jaxmpm::testing {

/// A deck with one body of water in an empty box.
inline deck::Deck water_deck(deck::Numbers min, deck::Numbers max, double cell_size, deck::Shape shape) {
  deck::Deck deck;
  deck.domain = {std::move(min), std::move(max), cell_size};
  deck.gravity.assign(deck.domain.min.size(), 0.0);
  deck.gravity.back() = -9.81;
  deck.materials["water"] = deck::Newtonian{1000, 35, 0, std::nullopt};
  deck.materials["sand"] = deck::DruckerPrager{2650, 19.8, 0.7e6, std::nullopt, 0.3};
  deck::Body body;
  body.name = "pool";
  body.material = "water";
  body.shape = std::move(shape);
  deck.bodies.push_back(body);
  return deck;
}

inline deck::Shape box(deck::Numbers min, deck::Numbers max) { return {deck::Box{std::move(min), std::move(max)}}; }

/// Frame of a cube of `cells` cells of 1 m, from the origin.
inline Frame unit_frame(int dim, int cells) {
  deck::Deck deck;
  deck.domain = {deck::Numbers(dim, 0.0), deck::Numbers(dim, cells), 1.0};
  return make_frame(deck);
}

inline std::size_t particle_count(const Model& model) {
  std::size_t count = 0;
  for (const Body& body : model.bodies) count += body.initial.id.size();
  return count;
}

/// Pointer of the first problem of the DeckError that building this deck throws; empty if it throws none.
inline std::string problem_pointer(const deck::Deck& deck, std::string* message = nullptr) {
  try {
    build_model(deck);
  } catch (const DeckError& error) {
    if (message) *message = error.what();
    return error.problems.at(0).pointer;
  }
  return "";
}

/// A file of this process alone (tests run side by side) that is removed again.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& contents)
      : path_((std::filesystem::temp_directory_path() / ("jaxmpm_test_scene_" + std::to_string(getpid()) + "_" + name)).string()) {
    std::ofstream(path_, std::ios::binary) << contents;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace jaxmpm::testing
