#pragma once
// Data of one observation, whatever file it came from: rows to compare with readings of the run.
#include <optional>
#include <string>
#include <vector>

#include "deck/inverse.hpp"
#include "scene/model.hpp"

namespace jaxmpm {

/// What one observation's data has to fit: where it stands in the deck, its file, and the run it is compared with.
struct ObservationPlace {
  std::string pointer;  // /inverse/observations/i
  std::string file;     // with the deck's folder
  const Model& model;
  const deck::Deck& deck;
  double end;  // of the run, s
  /// Throws DeckError: the file's contents do not do. `line` 0: none in particular.
  [[noreturn]] void bad_file(int line, const std::string& message) const;
};

/// One row: `width` numbers of one subject at one time.
struct ObservedRow {
  double time = 0;          // s
  std::size_t subject = 0;  // a particle's place in its body; the column of a profile; 0 for a gauge
  std::vector<double> value;
  double sigma = 1;       // standard deviation that the file gives: the residual is divided by it
  int line = 0;           // in the file, 0 where it has none
  std::size_t group = 0;  // rows of one group make one residual
};

/// Rows in the order of times and subjects, in so many groups.
struct ObservedData {
  std::vector<ObservedRow> rows;
  std::size_t groups = 0;
};

/// Rows within from_time … to_time (at most the end of the run), one time in every `every`: the first at or after each multiple counted
/// from the first one kept. `rows` come in any order and leave in that of times and subjects. DeckError where a row is given twice, where
/// one lies before the run's start or, in a CSV without to_time, after its end, or where none is left.
std::vector<ObservedRow> within_window(std::vector<ObservedRow> rows, const deck::Observed& observed, const ObservationPlace& place);

/// Groups rows into residuals: without `average` each row is its own; with it, those of one subject whose times lie in the same window of
/// that length, counted from the first row's.
ObservedData grouped(std::vector<ObservedRow> rows, std::optional<double> average);

/// Adds the noise of a twin experiment to the values, in the order of rows; the draw depends on its seed and the place of the observation
/// in the deck (`index`) alone.
void add_noise(std::vector<ObservedRow>& rows, const std::optional<deck::Noise>& noise, std::size_t index);

/// Whether a point (m) lies in a box, its faces included. The box has as many coordinates as the domain.
bool in_box(const deck::Box& box, const double* x);

}  // namespace jaxmpm
