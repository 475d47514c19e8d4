#pragma once
// Definitions of a JSON Schema (draft 2020-12), collected while types describe themselves.
#include <functional>
#include <string>

#include "core/describe_place.hpp"

namespace jaxmpm::described {

class Schema {
 public:
  /// {"$ref": …} to a definition, which is made on first use; recursive types are fine.
  Json reference(const std::string& name, const std::function<Json()>& make);
  const Json& definitions() const { return definitions_; }

 private:
  Json definitions_ = Json::object();
};

/// Markdown from a schema: one section per described struct, one table row per key.
std::string reference_markdown(const Json& schema);

}  // namespace jaxmpm::described
