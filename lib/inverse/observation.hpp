#pragma once
// One observation of the deck: its data, and the readings of the run that it is compared with.
#include <memory>

#include "inverse/observed_rows.hpp"
#include "inverse/observer.hpp"
#include "observe/gauge.hpp"

namespace jaxmpm {

/// A range of rows of one observation, those of one time: [first, last).
struct RowRange {
  std::size_t first = 0, last = 0;
};

class Observation {
 public:
  Observation(ObservedData data, double weight);
  virtual ~Observation() = default;
  const std::vector<ObservedRow>& rows() const { return rows_; }
  std::size_t width() const { return width_; }    ///< numbers in a row
  std::size_t groups() const { return groups_; }  ///< of rows that make one residual
  virtual FieldSelection needs() const = 0;
  /// Compares the rows of one time with a state: writes width() differences √w (reading − value)/σ for each, and keeps what add_gradient()
  /// needs. A row that has no material to read gives zeros.
  virtual void look(const RowRange& range, const Moment& now, const std::vector<BodySnapshot>& bodies, double* differences) = 0;
  /// Adds Σ by_difference · ∂difference/∂(state) for rows that were looked at.
  virtual void add_gradient(const RowRange& range, const double* by_differences, SnapshotGradient& into) const = 0;
  /// Whether the last run had material to read at a row.
  virtual bool was_read(std::size_t) const { return true; }
  /// Horizontal coordinates (m) of the subjects, where they are places.
  virtual std::vector<std::vector<double>> places() const { return {}; }
  /// The data beside the readings that gave these differences, width() for each row.
  Comparison compare(const double* differences) const;

 protected:
  /// √w/σ of a row.
  double scale(const ObservedRow& row) const;

 private:
  std::vector<ObservedRow> rows_;
  double root_weight_;
  std::size_t width_, groups_;
};

/// A vector field (position or velocity) of particles of one body.
std::unique_ptr<Observation> observe_particles(ObservedData data, double weight, const std::string& field, std::size_t body,
                                               const Model& model);
/// Readings of gauges, one for each subject of the rows; `places`: where they are, for a profile.
std::unique_ptr<Observation> observe_gauges(ObservedData data, double weight, std::vector<std::unique_ptr<Gauge>> gauges,
                                            const Model& model, std::vector<deck::Numbers> places = {});

}  // namespace jaxmpm
