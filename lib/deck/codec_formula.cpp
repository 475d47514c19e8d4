// A number or an expression.
#include "deck/descriptions.hpp"

namespace jaxmpm::described {

void Codec<deck::Formula>::read(deck::Formula& out, const Place& place, const Limits& limits) {
  if (!place.value.is_string()) return Codec<double>::read(out.emplace<double>(), place, limits);
  Limits filled;
  filled.fewest = 1;
  Codec<std::string>::read(out.emplace<std::string>(), place, filled);
}
Json Codec<deck::Formula>::write(const deck::Formula& in, const Limits&) {
  return std::visit([](const auto& value) { return Json(value); }, in);
}
Json Codec<deck::Formula>::schema(const Limits&, Schema&) {
  return {{"anyOf", Json::array({{{"type", "number"}}, {{"type", "string"}, {"minLength", 1}}})}};
}

}  // namespace jaxmpm::described
