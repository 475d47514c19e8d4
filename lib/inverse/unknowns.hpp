#pragma once
// The unknowns of a deck as variables that an optimiser moves, and back. A number x of the deck is x = u, x = exp u (log) or
// x = a + (b − a)/(1 + exp −u) (logit within the bounds a, b) of its variable u.
#include <array>
#include <map>
#include <optional>
#include <string>

#include "deck/inverse.hpp"
#include "inverse/search_space.hpp"
#include "scene/model.hpp"

namespace jaxmpm {

/// Values by JSON pointer: a number has one, a network one for each of its weights (Mlp::weights()), the velocities of a body's particles
/// (/bodies/B/velocity/particles) dim for each particle, in the order of ids.
using Values = std::map<std::string, std::vector<double>>;

/// Variables one after another that stand for one number (of all pointers that share it), one network or one body's velocities.
struct VariableBlock {
  std::size_t unknown;                // index in /inverse/unknowns
  std::vector<std::string> pointers;  // that have these values
  std::size_t first, count;           // variables
};

class Unknowns {
 public:
  /// Of a deck with /inverse, in its order. Throws DeckError when there is none, or velocities of a file are outside of their bounds;
  /// IoError when that file cannot be read.
  explicit Unknowns(const deck::Deck& deck);
  const SearchSpace& space() const { return space_; }
  std::size_t size() const { return space_.size(); }
  const std::vector<VariableBlock>& blocks() const { return blocks_; }
  const std::vector<std::string>& pointers() const { return pointers_; }
  /// What a variable is called in tables: its pointer, the path where several share it, with the number of the value for a list.
  std::string label(std::size_t variable) const;

  /// The deck's number that a variable stands for.
  double number(std::size_t variable, double u) const;
  /// Bounds of that number, −∞ and ∞ where there are none.
  std::array<double, 2> bounds(std::size_t variable) const { return {law(variable).lower, law(variable).upper}; }
  /// The deck's numbers.
  Values values(const Variables& u) const;
  /// dx/du of each variable: what an error of the variable is multiplied with to be one of the number.
  Variables slopes(const Variables& u) const;
  /// Gradient by the variables from that by the deck's numbers: chain rule, and the sum over those that share one.
  Variables gradient(const Variables& u, const Values& by_pointer) const;

  /// Gaussian priors: residuals (x − mean)/deviation of the variables that have one, in their order; the loss is half their sum of squares.
  Variables prior_residuals(const Variables& u) const;
  /// Variable of each prior residual.
  const std::vector<std::size_t>& prior_variables() const { return prior_variables_; }
  /// Adds the gradient of the priors' loss by the variables.
  void add_prior_gradient(const Variables& u, Variables& gradient) const;

 private:
  struct Law {
    deck::Transform transform;
    double lower, upper;  // of the number
    std::optional<deck::Prior> prior;
  };
  double prior_residual(std::size_t variable, double u) const;
  void add_block(std::size_t index, std::vector<std::string> pointers, const Variables& start);
  const Law& law(std::size_t variable) const { return laws_[unknown_of_[variable]]; }
  double slope(std::size_t variable, double u) const;

  std::vector<Law> laws_;  // of each of /inverse/unknowns
  std::vector<std::string> paths_;
  std::vector<VariableBlock> blocks_;
  std::vector<std::string> pointers_;
  std::vector<std::size_t> unknown_of_;  // of each variable
  std::vector<std::size_t> prior_variables_;
  SearchSpace space_;
};

/// What makes `--set` give a deck these values; velocities of particles, which a deck knows as a file only, are left out.
std::vector<std::string> assignments(const Values& values);

/// Throws DeckError where an unknown's bounds reach to numbers that its own key does not allow: the search would end there.
void check_bounds(const deck::Deck& deck, const Unknowns& unknowns);

/// The deck with these values, read and checked anew, and without /inverse, which asks where a search starts and is done with. Throws
/// DeckError for values that the deck does not allow.
deck::Deck with_values(const deck::Deck& deck, const Values& values);

/// The model of a deck that has these values (with_values), the velocities of particles among them.
Model build_model(const deck::Deck& deck, const Values& values);

/// Index of the body whose particles' velocities are at a pointer (deck::is_particle_velocities).
std::size_t body_of(const std::string& pointer);

}  // namespace jaxmpm
