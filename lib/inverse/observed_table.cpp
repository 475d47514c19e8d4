#include "inverse/observed_table.hpp"

#include "core/error.hpp"

namespace jaxmpm {

ObservedTable::ObservedTable(const deck::Observed& observed, const ObservationPlace& place)
    : place_(place), table_(read_table(place.file, place.pointer + "/file")) {
  if (const auto* column = std::get_if<std::string>(&observed.mask)) mask_ = *column;
}

std::vector<double> ObservedTable::values(std::size_t row, const std::vector<std::string>& columns) const {
  std::vector<double> values;
  for (const std::string& column : columns) values.push_back(value(row, column));
  return values;
}

bool ObservedTable::counts(std::size_t row) const {
  if (mask_.empty()) return true;
  const double mask = value(row, mask_);
  if (mask != 0 && mask != 1)
    place_.bad_file(line(row), "the mask column '" + mask_ + "' holds 1 for a row that counts and 0 for another, nothing else");
  return mask == 1;
}

double ObservedTable::sigma(std::size_t row) const {
  if (!table_.has("sigma")) return 1;
  const double sigma = value(row, "sigma");
  if (!(sigma > 0)) place_.bad_file(line(row), "sigma is a standard deviation and must be above 0");
  return sigma;
}

void refuse_mask_column(const deck::Observed& observed, const ObservationPlace& place) {
  if (std::holds_alternative<std::string>(observed.mask))
    throw DeckError(place.pointer + "/mask",
                    "names a column of a CSV, but '" + place.file + "' is the results of a run; use a box, or \"none\"");
}

}  // namespace jaxmpm
