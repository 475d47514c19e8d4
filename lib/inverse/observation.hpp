#pragma once
// One observation of the deck: its data, and the readings of the run that it is compared with.
#include <memory>

#include "inverse/observed_rows.hpp"
#include "observe/gauge.hpp"

namespace jaxmpm {

/// A range of rows of one observation, those of one time: [first, last).
struct RowRange {
  std::size_t first = 0, last = 0;
};

class Observation {
 public:
  Observation(std::vector<ObservedRow> rows, double weight);
  virtual ~Observation() = default;
  const std::vector<ObservedRow>& rows() const { return rows_; }
  std::size_t width() const { return width_; }  ///< numbers in a row
  virtual FieldSelection needs() const = 0;
  /// Compares the rows of one time with a state: writes width() residuals for each, and keeps what gradient() needs.
  virtual void look(const RowRange& range, const Moment& now, const std::vector<BodySnapshot>& bodies, double* residuals) = 0;
  /// Adds Σ residual · ∂residual/∂(state) for rows that were looked at; `residuals` are those that look() wrote.
  virtual void add_gradient(const RowRange& range, const double* residuals, SnapshotGradient& into) const = 0;
  /// Rows of the last run that had no material to read.
  virtual std::size_t unread() const { return 0; }

 protected:
  /// √w/σ of a row.
  double scale(const ObservedRow& row) const;

 private:
  std::vector<ObservedRow> rows_;
  double root_weight_;
  std::size_t width_;
};

/// A vector field (position or velocity) of particles of one body.
std::unique_ptr<Observation> observe_particles(std::vector<ObservedRow> rows, double weight, const std::string& field, std::size_t body,
                                               const Model& model);
/// Readings of gauges, one for each subject of the rows.
std::unique_ptr<Observation> observe_gauges(std::vector<ObservedRow> rows, double weight, std::vector<std::unique_ptr<Gauge>> gauges,
                                            const Model& model);

}  // namespace jaxmpm
