#include "core/describe_schema.hpp"

namespace jaxmpm::described {

Json Schema::reference(const std::string& name, const std::function<Json()>& make) {
  if (!definitions_.contains(name)) {
    definitions_[name] = Json::object();  // holds the place, so that a type may contain itself
    Json made = make();
    definitions_[name] = std::move(made);
  }
  return {{"$ref", "#/$defs/" + name}};
}

}  // namespace jaxmpm::described
