#pragma once
// DIR/results.h5: links to the frames, the gauges' series, and what the run was.
#include <map>
#include <string>
#include <vector>

#include "deck/deck.hpp"
#include "io/results_directory.hpp"
#include "observe/gauge.hpp"

namespace jaxmpm {

/// A frame that was written.
struct FrameEntry {
  std::uint64_t step = 0;
  double time = 0;
};

/// Writes the index anew. Frames that are not on disk (formats without hdf5) are left out. Throws IoError.
void write_index(const ResultsDirectory& directory, const deck::Deck& deck, const std::string& backend,
                 const std::vector<FrameEntry>& frames, const std::map<std::string, GaugeSeries>& gauges);

/// Resolved deck of the results in a directory; empty when there is no readable index.
std::string deck_of_results(const ResultsDirectory& directory);

/// Name of a precision as the deck writes it.
std::string precision_name(deck::Precision precision);

}  // namespace jaxmpm
