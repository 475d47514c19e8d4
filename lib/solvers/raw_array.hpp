#pragma once
// Arrays of a checkpoint: packing values, and finding and unpacking them again.
#include <algorithm>
#include <cstring>
#include <type_traits>

#include "core/error.hpp"
#include "solvers/solver.hpp"

namespace jaxmpm {

template <class Value>
const char* type_name() {
  if constexpr (std::is_same_v<Value, float>) return "f4";
  else if constexpr (std::is_same_v<Value, double>) return "f8";
  else if constexpr (std::is_same_v<Value, std::uint32_t>) return "u4";
  else return "i8";
}

template <class Value>
RawArray pack_array(const std::string& name, const Value* data, std::size_t n) {
  RawArray array{name, type_name<Value>(), {n}, std::vector<unsigned char>(n * sizeof(Value))};
  if (n > 0) std::memcpy(array.bytes.data(), data, array.bytes.size());
  return array;
}

/// Throws IoError where there is no array of this name.
inline const RawArray& find_array(const std::vector<RawArray>& arrays, const std::string& name) {
  const auto at = std::find_if(arrays.begin(), arrays.end(), [&](const RawArray& a) { return a.name == name; });
  if (at == arrays.end()) throw IoError("the checkpoint has no array \"" + name + "\"; it is of another deck, or damaged");
  return *at;
}

/// Copies an array of a checkpoint to `out`, which has the size that the model asks for. Throws IoError where the array does not fit it.
template <class Container>
void unpack_array(const std::vector<RawArray>& arrays, const std::string& name, Container& out) {
  using Value = typename Container::value_type;
  const RawArray& array = find_array(arrays, name);
  if (array.type != type_name<Value>() || array.bytes.size() != out.size() * sizeof(Value))
    throw IoError("array \"" + name +
                  "\" of the checkpoint has another type or length than this deck's; it is of another deck, or damaged");
  if (!out.empty()) std::memcpy(out.data(), array.bytes.data(), array.bytes.size());
}

}  // namespace jaxmpm
