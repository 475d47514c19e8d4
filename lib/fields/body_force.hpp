#pragma once
// A force per unit mass over space and time, as the deck's /body_force gives it.
#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "deck/deck.hpp"

namespace jaxmpm {

/// Any number of threads may evaluate it, each through a loan of its own.
class BodyForce {
 public:
  /// One component for each of `dim` axes: a number or an expression of x, y, z, t and the deck's parameters, m/s². Throws DeckError for
  /// unknown names and malformed expressions.
  BodyForce(const std::vector<deck::Formula>& components, int dim, const std::map<std::string, double>& parameters);
  ~BodyForce();

  /// Names of the deck's parameters that it depends on, each once.
  const std::vector<std::string>& parameters() const { return names_; }
  /// How many derivatives it has: by a number added to each of three components, then by parameters().
  std::size_t slopes() const { return 3 + names_.size(); }
  /// Text of the derivative of a component by a parameter. Throws DeckError where it has none (derivative_text()).
  std::string slope_text(std::size_t component, const std::string& parameter) const;

  /// The right to evaluate the force, in one thread.
  class Loan {
   public:
    explicit Loan(const BodyForce& from);
    ~Loan();
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    /// Acceleration (m/s²) at a place (m, deck coordinates) and a time (s).
    std::array<double, 3> at(const std::array<double, 3>& place, double time) const;
    /// Adds the slopes() of `by` · at(place, time) to `sums`: zero by a parameter by which a component has no derivative.
    void add_slopes(const std::array<double, 3>& place, double time, const std::array<double, 3>& by, double* sums) const;

   private:
    const BodyForce& from_;
    std::unique_ptr<struct ForceExpressions> expressions_;
  };

 private:
  std::unique_ptr<ForceExpressions> parsed() const;
  void parse_slopes(ForceExpressions& expressions) const;

  std::vector<deck::Formula> components_;
  int dim_;
  std::map<std::string, double> parameters_;
  std::vector<std::string> names_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<ForceExpressions>> idle_;  // as many as threads have asked for at once
};

}  // namespace jaxmpm
