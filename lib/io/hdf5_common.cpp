#include "io/hdf5_common.hpp"

#include <map>
#include <mutex>

namespace jaxmpm::hdf5 {
namespace {

herr_t keep_reason(unsigned, const H5E_error2_t* error, void* into) {
  auto& reason = *static_cast<std::string*>(into);
  const std::string text = error->desc ? error->desc : "";
  // The system's words are within, e.g. "file write failed: time = …, errno = 28, error message = 'No space left on device', …".
  const std::string mark = "error message = '";
  if (const auto at = text.find(mark); at != std::string::npos)
    reason = text.substr(at + mark.size(), text.find('\'', at + mark.size()) - at - mark.size());
  else if (reason.empty()) reason = text;
  return 0;
}

}  // namespace

void start() {
  static std::once_flag once;
  std::call_once(once, [] { H5dont_atexit(); });
  thread_local const herr_t quiet = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // each thread has its own stack of errors
  (void)quiet;
}

std::string last_reason() {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_reason, &reason);
  H5Eclear2(H5E_DEFAULT);
  return reason.empty() ? "HDF5 gave no reason" : reason;
}

hid_t native_type(const std::string& type) {
  static const std::map<std::string, hid_t> types{{"f4", H5T_NATIVE_FLOAT},  {"f8", H5T_NATIVE_DOUBLE}, {"u1", H5T_NATIVE_UINT8},
                                                  {"u4", H5T_NATIVE_UINT32}, {"i8", H5T_NATIVE_INT64},  {"u8", H5T_NATIVE_UINT64}};
  const auto found = types.find(type);
  if (found == types.end())
    throw IoError("a dataset has the type " + type + ", which is none of jaxmpm's; the file is damaged or of another kind.");
  return found->second;
}

std::size_t type_size(const std::string& type) { return static_cast<std::size_t>(type[1] - '0'); }

Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

Handle& Handle::operator=(Handle&& other) noexcept {
  reset();
  id_ = other.id_;
  close_ = other.close_;
  other.id_ = -1;
  return *this;
}

herr_t Handle::reset() {
  const herr_t result = id_ >= 0 ? close_(id_) : 0;
  id_ = -1;
  return result;
}

}  // namespace jaxmpm::hdf5
