#pragma once
// One frame: fields of all particles at one moment, as HDF5.
#include <string>
#include <vector>

#include "observe/fields.hpp"
#include "solvers/time_control.hpp"

namespace jaxmpm {

/// Fields of one body in a frame, besides its id and position.
struct FrameBody {
  std::string name;
  std::vector<std::string> fields;
};

/// Writes frames/NNNNNN.h5: attributes time and step, BODY/{id,position,…} in the order of ids, units as attributes. Throws IoError.
void write_frame(const std::string& path, const Moment& now, const std::vector<FrameBody>& layout, const std::vector<BodySnapshot>& bodies,
                 int dim);

/// Throws NumericsError naming the first particle with a non-finite value, so that none reaches the disk.
void require_finite(const Moment& now, const std::vector<FrameBody>& layout, const std::vector<BodySnapshot>& bodies, int dim);

}  // namespace jaxmpm
