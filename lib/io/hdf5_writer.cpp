#include <algorithm>

#include "io/hdf5_common.hpp"

namespace jaxmpm::hdf5 {
namespace {

Handle file_properties() {
  Handle properties(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(properties, H5F_LIBVER_V110, H5F_LIBVER_LATEST);  // this layout has checksums over its own tables
  H5Pset_fclose_degree(properties, H5F_CLOSE_STRONG);
  return properties;
}

Handle link_properties() {
  Handle properties(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(properties, 1);
  return properties;
}

Handle dataset_properties(const std::vector<std::size_t>& shape, std::size_t value_size, Storage storage) {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, false);  // equal results give equal files
  const bool has_values = !shape.empty() && std::find(shape.begin(), shape.end(), 0u) == shape.end();
  if (storage == Storage::plain || !has_values) return properties;
  std::vector<hsize_t> chunk(shape.begin(), shape.end());
  std::size_t row = value_size;
  for (std::size_t d = 1; d < shape.size(); ++d) row *= shape[d];
  constexpr std::size_t chunk_bytes = 4 << 20;
  chunk[0] = std::clamp<hsize_t>(chunk_bytes / row, 1, shape[0]);
  H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
  H5Pset_fletcher32(properties);
  return properties;
}

Handle dataspace(const std::vector<std::size_t>& shape) {
  if (shape.empty()) return {H5Screate(H5S_SCALAR), H5Sclose};
  const std::vector<hsize_t> extent(shape.begin(), shape.end());
  return {H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose};
}

}  // namespace

Writer::Writer(const std::string& path) : path_(path), pending_(path) {
  start();
  file_ = Handle(checked(H5Fcreate(pending_.temporary().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, file_properties()), "create"), H5Fclose);
}

Writer::~Writer() = default;

hid_t Writer::checked(hid_t result, const std::string& what) const {
  if (result < 0) throw cannot_write(path_, last_reason() + " (HDF5 could not " + what + ")");
  return result;
}

Handle Writer::make_attribute(const std::string& object, const std::string& name, hid_t type, hid_t space) {
  return {checked(H5Acreate_by_name(file_, object.c_str(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                  "create attribute " + name),
          H5Aclose};
}

void Writer::attribute(const std::string& object, const std::string& name, const std::string& value) {
  const Handle type = text_type(), space = dataspace({});
  const char* text = value.c_str();
  checked(H5Awrite(make_attribute(object, name, type, space), type, &text), "write attribute " + name);
}

void Writer::attribute(const std::string& object, const std::string& name, const std::vector<std::string>& values) {
  const Handle type = text_type(), space = dataspace({values.size()});
  std::vector<const char*> texts;
  for (const std::string& value : values) texts.push_back(value.c_str());
  checked(H5Awrite(make_attribute(object, name, type, space), type, texts.data()), "write attribute " + name);
}

void Writer::attribute(const std::string& object, const std::string& name, double value) {
  const Handle space = dataspace({});
  checked(H5Awrite(make_attribute(object, name, H5T_NATIVE_DOUBLE, space), H5T_NATIVE_DOUBLE, &value), "write attribute " + name);
}

void Writer::attribute(const std::string& object, const std::string& name, std::uint64_t value) {
  const Handle space = dataspace({});
  checked(H5Awrite(make_attribute(object, name, H5T_NATIVE_UINT64, space), H5T_NATIVE_UINT64, &value), "write attribute " + name);
}

void Writer::group(const std::string& name) {
  const Handle group(checked(H5Gcreate2(file_, name.c_str(), link_properties(), H5P_DEFAULT, H5P_DEFAULT), "create group " + name),
                     H5Gclose);
}

void Writer::dataset(const std::string& name, const std::string& type, const std::vector<std::size_t>& shape, const void* data,
                     Storage storage) {
  const Handle space = dataspace(shape);
  const Handle set(checked(H5Dcreate2(file_, name.c_str(), native_type(type), space, link_properties(),
                                      dataset_properties(shape, type_size(type), storage), H5P_DEFAULT),
                           "create dataset " + name),
                   H5Dclose);
  checked(H5Dwrite(set, native_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write dataset " + name);
}

void Writer::dataset(const std::string& name, const std::vector<std::size_t>& shape, const std::vector<double>& values, Storage storage) {
  dataset(name, "f8", shape, values.data(), storage);
}

void Writer::text(const std::string& name, const std::string& value) {
  dataset(name, "u1", {value.size()}, value.data(), Storage::checked);
}

void Writer::external_link(const std::string& name, const std::string& file, const std::string& object) {
  checked(H5Lcreate_external(file.c_str(), object.c_str(), file_, name.c_str(), link_properties(), H5P_DEFAULT), "link " + name);
}

void Writer::finish() {
  checked(H5Fflush(file_, H5F_SCOPE_GLOBAL), "flush");
  checked(file_.reset(), "close");
  pending_.commit();
}

}  // namespace jaxmpm::hdf5
