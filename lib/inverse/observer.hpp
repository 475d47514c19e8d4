#pragma once
// What looks at a run and turns it into one number, the loss, as the differentiated run sees it.
#include "solvers/model_gradient.hpp"
#include "solvers/time_control.hpp"

namespace jaxmpm {

/// One observation's data beside what the last run read: `width` numbers a row, rows in the order of times and subjects.
struct Comparison {
  std::size_t width = 0;
  std::vector<double> time;                 // s, of each row
  std::vector<std::size_t> subject;         // of each row: a particle's place in its body, a profile's place; 0 for a gauge
  std::vector<double> observed, read;       // [row][width]; read is NaN where the run had no material
  std::vector<double> sigma;                // of each row
  std::vector<std::vector<double>> places;  // of a profile's subjects: horizontal coordinates, m
};

class Observer {
 public:
  virtual ~Observer() = default;
  /// Times, s, increasing, at which it looks; an automatic step is shortened to meet them, a fixed one takes the nearest step.
  virtual const std::vector<double>& times() const = 0;
  /// Fields that look() needs besides id, position and mass.
  virtual FieldSelection needs() const = 0;
  /// Takes in the state at times()[index], bodies in deck order, particles in order of ids. Called once per time, in order, in every run.
  virtual void look(std::size_t index, const Moment& now, const std::vector<BodySnapshot>& bodies) = 0;
  /// The loss, once all times have been looked at.
  virtual double loss() const = 0;
  /// What the loss is made of, once all times have been looked at: weighted residuals whose half sum of squares is loss(). Their number and
  /// order are the same in every run; what is masked or has no material is 0.
  virtual const std::vector<double>& residuals() const = 0;
  /// ∂loss/∂(what look() saw at times()[index]). Asked for after the run, for each index, in descending order.
  virtual SnapshotGradient gradient(std::size_t index) const = 0;
  /// Data and readings, observation by observation in deck order, once all times have been looked at; none where there are no data.
  virtual std::vector<Comparison> comparisons() const { return {}; }
};

}  // namespace jaxmpm
