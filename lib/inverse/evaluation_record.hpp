#pragma once
// Recorded evaluations in a file: group /evaluations of inversion.h5.
#include "inverse/recorded_loss.hpp"
#include "io/hdf5.hpp"

namespace jaxmpm {

void write_evaluations(hdf5::Writer& file, const std::vector<RecordedEvaluation>& evaluations);
/// Of as many variables as given. Throws IoError when they are not.
std::vector<RecordedEvaluation> read_evaluations(const hdf5::Reader& file, std::size_t variables);

}  // namespace jaxmpm
