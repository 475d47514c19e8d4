#include "inverse/unknowns.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "deck/describe_inverse.hpp"
#include "fields/mlp.hpp"

namespace jaxmpm {
namespace {

using deck::Transform;
using Json = nlohmann::ordered_json;
constexpr double unbounded = std::numeric_limits<double>::infinity();

/// The network at /bodies/B/velocity/C/mlp.
const deck::Mlp& network_at(const deck::Deck& deck, const std::string& pointer) {
  const std::size_t component_at = pointer.find("/velocity/") + std::string("/velocity/").size();
  const deck::Body& body = deck.bodies.at(body_of(pointer));
  return std::get<deck::Mlp>(std::get<std::vector<deck::Component>>(body.velocity).at(std::stoul(pointer.substr(component_at))));
}

/// Velocities of a body's particles as their file has them. That they are within bounds, which reading the deck could not see, is checked.
Variables velocities_of_file(const deck::Deck& deck, const deck::Unknown& unknown, std::size_t index, const std::string& pointer) {
  const Model model = build_model(deck);
  described::Reader reader([](const std::string&) { return 0; }, model.dim);
  const Json nothing;
  const described::Place place{nothing, "/inverse/unknowns/" + std::to_string(index), reader};
  const BodyState& state = model.bodies[body_of(pointer)].initial;
  Variables found;
  for (std::size_t p = 0; p < state.id.size(); ++p)
    for (std::size_t d = 0; d < static_cast<std::size_t>(model.dim); ++d) {
      found.push_back(state.velocity[p][d]);
      deck::check_start_value(unknown, found.back(), "the file's velocity of particle " + std::to_string(state.id[p]) + ": ", place);
      if (!reader.problems().empty()) throw DeckError(reader.problems());
    }
  return found;
}

/// Numbers at which the search starts, at the pointer `at` of the unknown `index`.
Variables start_of(const deck::Deck& deck, const Json& resolved, const deck::Unknown& unknown, std::size_t index,
                   const std::string& pointer, std::size_t at) {
  if (deck::is_network(pointer)) return Mlp(network_at(deck, pointer), deck.dimension(), pointer).weights();
  if (deck::is_particle_velocities(pointer)) return velocities_of_file(deck, unknown, index, pointer);
  if (const auto* number = std::get_if<double>(&unknown.start)) return {*number};
  if (const auto* list = std::get_if<deck::Numbers>(&unknown.start)) return {list->at(at)};
  return {resolved.at(Json::json_pointer(pointer)).get<double>()};
}

double variable(Transform transform, double lower, double upper, double x) {
  if (transform == Transform::log) return std::log(x);  // −∞ at 0
  if (transform == Transform::logit) return std::log((x - lower) / (upper - x));
  return x;
}

/// A change that matters of what has no bounds: the size of the start (of a body's velocities: their root mean square), 1 where it is 0.
/// The weights of a network have sizes of their own making.
double size_of(const Variables& start, bool network) {
  double square = 0;
  for (const double x : start) square += x * x;
  if (square == 0 || network) return 1;
  return start.size() == 1 ? std::abs(start[0]) : std::sqrt(square / static_cast<double>(start.size()));
}

}  // namespace

Unknowns::Unknowns(const deck::Deck& deck) {
  const deck::Inverse inverse = deck::inverse_of(deck);
  const Json resolved = Json::parse(deck.resolved);
  for (std::size_t k = 0; k < inverse.unknowns.size(); ++k) {
    const deck::Unknown& unknown = inverse.unknowns[k];
    const auto bounds = unknown.bounds.value_or(deck::Numbers{-unbounded, unbounded});
    laws_.push_back({unknown.transform, bounds[0], bounds[1], unknown.prior});
    paths_.push_back(unknown.path);
    const std::vector<std::string> pointers = deck::pointers_of(unknown.path, resolved);
    if (unknown.share) {
      add_block(k, pointers, start_of(deck, resolved, unknown, k, pointers.front(), 0));
      continue;
    }
    for (std::size_t i = 0; i < pointers.size(); ++i) add_block(k, {pointers[i]}, start_of(deck, resolved, unknown, k, pointers[i], i));
  }
}

void Unknowns::add_block(std::size_t index, std::vector<std::string> pointers, const Variables& start) {
  const Law& own = laws_[index];
  const bool plain = own.transform == Transform::none;
  const double size = size_of(start, deck::is_network(pointers.front()));
  pointers_.insert(pointers_.end(), pointers.begin(), pointers.end());
  blocks_.push_back({index, std::move(pointers), space_.size(), start.size()});
  for (const double x : start) {
    const double u = variable(own.transform, own.lower, own.upper, x), width = own.upper - own.lower;
    if (own.prior) prior_variables_.push_back(unknown_of_.size());
    unknown_of_.push_back(index);
    space_.start.push_back(u);
    // A logit has its bounds at infinity; a logarithm's lower bound is there when the number's is 0 or none.
    space_.lower.push_back(plain ? own.lower : own.transform == Transform::log && own.lower > 0 ? std::log(own.lower) : -unbounded);
    space_.upper.push_back(plain ? own.upper : own.transform == Transform::log ? std::log(own.upper) : unbounded);
    space_.scale.push_back(!plain ? 1 : std::isfinite(width) ? width : size);
  }
}

std::string Unknowns::label(std::size_t variable) const {
  for (const VariableBlock& block : blocks_) {
    if (variable >= block.first + block.count) continue;
    const std::string name = block.pointers.size() > 1 ? paths_[block.unknown] : block.pointers.front();
    return block.count == 1 ? name : name + "[" + std::to_string(variable - block.first) + "]";
  }
  return {};
}

double Unknowns::number(std::size_t variable, double u) const {
  const Law& own = law(variable);
  if (own.transform == Transform::none) return u;
  const double x = own.transform == Transform::log ? std::exp(u) : own.lower + (own.upper - own.lower) / (1 + std::exp(-u));
  return std::clamp(x, own.lower, own.upper);  // rounding may lead out by one unit in the last place
}

double Unknowns::slope(std::size_t variable, double u) const {
  const Law& own = law(variable);
  if (own.transform == Transform::none) return 1;
  const double x = number(variable, u);
  return own.transform == Transform::log ? x : (x - own.lower) * (own.upper - x) / (own.upper - own.lower);
}

Values Unknowns::values(const Variables& u) const {
  Values found;
  for (const VariableBlock& block : blocks_) {
    std::vector<double> numbers(block.count);
    for (std::size_t i = 0; i < block.count; ++i) numbers[i] = number(block.first + i, u[block.first + i]);
    for (const std::string& pointer : block.pointers) found[pointer] = numbers;
  }
  return found;
}

Variables Unknowns::slopes(const Variables& u) const {
  Variables found(size());
  for (std::size_t i = 0; i < size(); ++i) found[i] = slope(i, u[i]);
  return found;
}

Variables Unknowns::gradient(const Variables& u, const Values& by_pointer) const {
  Variables found(size(), 0.0);
  for (const VariableBlock& block : blocks_)
    for (const std::string& pointer : block.pointers)
      for (std::size_t i = 0; i < block.count; ++i)
        found[block.first + i] += by_pointer.at(pointer).at(i) * slope(block.first + i, u[block.first + i]);
  return found;
}

double Unknowns::prior_residual(std::size_t variable, double u) const {
  const deck::Prior& prior = *law(variable).prior;
  const double mean = prior.mean ? *prior.mean : number(variable, space_.start[variable]);
  return (number(variable, u) - mean) / prior.deviation;
}

Variables Unknowns::prior_residuals(const Variables& u) const {
  Variables residuals;
  for (const std::size_t i : prior_variables_) residuals.push_back(prior_residual(i, u[i]));
  return residuals;
}

void Unknowns::add_prior_gradient(const Variables& u, Variables& gradient) const {
  const Variables residuals = prior_residuals(u);
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    const std::size_t i = prior_variables_[k];
    gradient[i] += residuals[k] * slope(i, u[i]) / law(i).prior->deviation;
  }
}

std::vector<std::string> assignments(const Values& values) {
  std::vector<std::string> list;
  for (const auto& [pointer, numbers] : values)
    if (!deck::is_particle_velocities(pointer))
      list.push_back(deck::is_network(pointer) ? pointer + "/weights=" + Json(numbers).dump() : pointer + "=" + Json(numbers.at(0)).dump());
  return list;
}

deck::Deck with_values(const deck::Deck& deck, const Values& values) {
  deck::Deck plain = deck;
  Json text = Json::parse(deck.resolved);
  text.erase("inverse");
  plain.resolved = text.dump();
  return deck::with_assignments(plain, assignments(values));
}

void check_bounds(const deck::Deck& deck, const Unknowns& unknowns) {
  std::vector<Problem> problems;
  for (const VariableBlock& block : unknowns.blocks()) {
    if (block.count > 1) continue;
    const std::array<double, 2> bounds = unknowns.bounds(block.first);
    for (const std::size_t side : {std::size_t(0), std::size_t(1)}) {
      if (!std::isfinite(bounds[side])) continue;
      try {
        with_values(deck, {{block.pointers.front(), {bounds[side]}}});
      } catch (const DeckError& error) {
        for (const Problem& problem : error.problems)
          if (problem.pointer == block.pointers.front())  // others may be mended by other unknowns
            problems.push_back({"/inverse/unknowns/" + std::to_string(block.unknown) + "/bounds/" + std::to_string(side), 0,
                                "reaches to what " + problem.pointer + " may not be: " + problem.message});
      }
    }
  }
  if (!problems.empty()) throw DeckError(std::move(problems));
}

std::size_t body_of(const std::string& pointer) { return std::stoul(pointer.substr(std::string("/bodies/").size())); }

Model build_model(const deck::Deck& deck, const Values& values) {
  Model model = build_model(deck);
  const auto dim = static_cast<std::size_t>(model.dim);
  for (const auto& [pointer, numbers] : values) {
    if (!deck::is_particle_velocities(pointer)) continue;
    std::vector<Point>& velocity = model.bodies.at(body_of(pointer)).initial.velocity;
    for (std::size_t p = 0; p < velocity.size(); ++p)
      for (std::size_t d = 0; d < dim; ++d) velocity[p][d] = numbers.at(p * dim + d);
  }
  return model;
}

}  // namespace jaxmpm
