#pragma once
// Shared by hdf5_writer.cpp and hdf5_reader.cpp.
#include "io/hdf5.hpp"

namespace jaxmpm::hdf5 {

/// Silences HDF5's own printing and its clean-up at exit, which would try again to flush a file whose disk is full.
void start();
/// What HDF5 noted last, innermost first: the system's reason where there is one.
std::string last_reason();
hid_t native_type(const std::string& type);
Handle text_type();

}  // namespace jaxmpm::hdf5
