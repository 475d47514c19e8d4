#pragma once
// Observations as CSV: the columns that all kinds share.
#include "fields/files.hpp"
#include "inverse/observed_rows.hpp"

namespace jaxmpm {

/// The table of an observation. Columns that are missing are a DeckError naming those there are.
class ObservedTable {
 public:
  ObservedTable(const deck::Observed& observed, const ObservationPlace& place);
  std::size_t size() const { return table_.rows.size(); }
  bool has(const std::string& column) const { return table_.has(column); }
  int line(std::size_t row) const { return table_.lines[row]; }
  double value(std::size_t row, const std::string& column) const { return table_.rows[row][table_.column(column)]; }
  std::vector<double> values(std::size_t row, const std::vector<std::string>& columns) const;
  /// By the mask column, where the deck names one: 1 counts, 0 does not; DeckError at anything else.
  bool counts(std::size_t row) const;
  /// By the column sigma, above 0; 1 without one.
  double sigma(std::size_t row) const;

 private:
  const ObservationPlace& place_;
  Table table_;
  std::string mask_;
};

/// DeckError where the mask names a column although the file is results.h5.
void refuse_mask_column(const deck::Observed& observed, const ObservationPlace& place);

}  // namespace jaxmpm
