#include "io/hdf5_common.hpp"

namespace jaxmpm::hdf5 {

Reader::Reader(const std::string& path) : path_(path) {
  start();
  file_ = Handle(checked(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open the file"), H5Fclose);
}

hid_t Reader::checked(hid_t result, const std::string& what) const {
  if (result < 0)
    throw IoError("cannot read '" + path_ + "': " + last_reason() + " (HDF5 could not " + what +
                  "); the file is damaged or of another kind.");
  return result;
}

bool Reader::has(const std::string& object) const {
  return checked(H5Lexists(file_, object.c_str(), H5P_DEFAULT), "look for " + object) > 0;
}

std::vector<std::string> Reader::names(const std::string& group) const {
  std::vector<std::string> found;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  checked(H5Literate_by_name(file_, group.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &found, H5P_DEFAULT), "list " + group);
  return found;
}

std::string Reader::text_attribute(const std::string& object, const std::string& name) const {
  const Handle attribute(checked(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "find attribute " + name),
                         H5Aclose);
  const Handle stored(checked(H5Aget_type(attribute), "read attribute " + name), H5Tclose);
  if (H5Tis_variable_str(stored) <= 0)
    throw IoError("cannot read '" + path_ + "': attribute " + name + " is no text; the file is of another kind.");
  const Handle type = text_type(), space(checked(H5Aget_space(attribute), "read attribute " + name), H5Sclose);
  char* text = nullptr;
  checked(H5Aread(attribute, type, &text), "read attribute " + name);
  const std::string value = text ? text : "";
  H5Dvlen_reclaim(type, space, H5P_DEFAULT, &text);
  return value;
}

double Reader::number_attribute(const std::string& object, const std::string& name) const {
  const Handle attribute(checked(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "find attribute " + name),
                         H5Aclose);
  double value = 0;
  checked(H5Aread(attribute, H5T_NATIVE_DOUBLE, &value), "read attribute " + name);
  return value;
}

std::uint64_t Reader::count_attribute(const std::string& object, const std::string& name) const {
  const Handle attribute(checked(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "find attribute " + name),
                         H5Aclose);
  std::uint64_t value = 0;
  checked(H5Aread(attribute, H5T_NATIVE_UINT64, &value), "read attribute " + name);
  return value;
}

Handle Reader::open(const std::string& dataset) const {
  return {checked(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT), "open dataset " + dataset), H5Dclose};
}

std::vector<std::size_t> Reader::shape(const std::string& dataset) const {
  const Handle set = open(dataset), space(checked(H5Dget_space(set), "read dataset " + dataset), H5Sclose);
  std::vector<hsize_t> extent(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  return {extent.begin(), extent.end()};
}

std::string Reader::type(const std::string& dataset) const {
  const Handle set = open(dataset), type(checked(H5Dget_type(set), "read dataset " + dataset), H5Tclose);
  const bool is_float = H5Tget_class(type) == H5T_FLOAT;
  const bool is_signed = H5Tget_class(type) == H5T_INTEGER && H5Tget_sign(type) == H5T_SGN_2;
  return (is_float ? "f" : is_signed ? "i" : "u") + std::to_string(H5Tget_size(type));
}

void Reader::read(const std::string& dataset, hid_t type, void* into) const {
  checked(H5Dread(open(dataset), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, into), "read dataset " + dataset);
}

namespace {
std::size_t count(const std::vector<std::size_t>& shape) {
  std::size_t n = 1;
  for (const std::size_t extent : shape) n *= extent;
  return n;
}
}  // namespace

std::vector<double> Reader::numbers(const std::string& dataset) const {
  std::vector<double> values(count(shape(dataset)));
  read(dataset, H5T_NATIVE_DOUBLE, values.data());
  return values;
}

std::vector<std::uint64_t> Reader::counts(const std::string& dataset) const {
  std::vector<std::uint64_t> values(count(shape(dataset)));
  read(dataset, H5T_NATIVE_UINT64, values.data());
  return values;
}

std::vector<unsigned char> Reader::bytes(const std::string& dataset) const {
  const std::string stored = type(dataset);
  std::vector<unsigned char> values(count(shape(dataset)) * type_size(stored));
  read(dataset, native_type(stored), values.data());
  return values;
}

std::string Reader::text(const std::string& dataset) const {
  const std::vector<unsigned char> stored = bytes(dataset);
  return {stored.begin(), stored.end()};
}

}  // namespace jaxmpm::hdf5
