// Values of /inverse that take several forms.
#include "deck/describe_inverse.hpp"

namespace jaxmpm::described {

using deck::Mask;
using deck::Observation;
using deck::Optimizer;
using deck::Selection;
using deck::Start;

namespace {
Json discarded() { return Json(Json::value_t::discarded); }
Json one_of(Json forms) { return {{"oneOf", std::move(forms)}}; }
}  // namespace

void Codec<Start>::read(Start& out, const Place& place, const Limits&) {
  if (place.value.is_array()) Codec<deck::Numbers>::read(out.emplace<deck::Numbers>(), place, {});
  else Codec<double>::read(out.emplace<double>(), place, {});
}
Json Codec<Start>::write(const Start& in, const Limits&) {
  if (const auto* value = std::get_if<double>(&in)) return *value;
  if (const auto* values = std::get_if<deck::Numbers>(&in)) return *values;
  return discarded();
}
Json Codec<Start>::schema(const Limits&, Schema& defs) {
  return one_of(Json::array({{{"type", "number"}}, Codec<deck::Numbers>::schema({}, defs)}));
}

void Codec<Selection>::read(Selection& out, const Place& place, const Limits&) {
  if (place.given("ids")) Codec<deck::IdSelection>::read(out.emplace<deck::IdSelection>(), place, {});
  else if (place.value.is_object()) Codec<deck::RandomSelection>::read(out.emplace<deck::RandomSelection>(), place, {});
  else read_choice(place, {"all"});
}
Json Codec<Selection>::write(const Selection& in, const Limits&) {
  if (const auto* some = std::get_if<deck::RandomSelection>(&in)) return Codec<deck::RandomSelection>::write(*some, {});
  if (const auto* some = std::get_if<deck::IdSelection>(&in)) return Codec<deck::IdSelection>::write(*some, {});
  return "all";
}
Json Codec<Selection>::schema(const Limits&, Schema& defs) {
  return one_of(
      Json::array({{{"const", "all"}}, Codec<deck::RandomSelection>::schema({}, defs), Codec<deck::IdSelection>::schema({}, defs)}));
}

void Codec<Mask>::read(Mask& out, const Place& place, const Limits&) {
  if (place.value == "none") return;
  if (place.value.is_string()) {
    Limits filled;
    filled.fewest = 1;
    Codec<std::string>::read(out.emplace<std::string>(), place, filled);
  } else if (read_only_key(place, {"box"}) == 0) {
    Codec<deck::Box>::read(out.emplace<deck::Box>(), place.key("box"), {});
  }
}
Json Codec<Mask>::write(const Mask& in, const Limits&) {
  if (const auto* column = std::get_if<std::string>(&in)) return *column;
  if (const auto* box = std::get_if<deck::Box>(&in)) return Json{{"box", Codec<deck::Box>::write(*box, {})}};
  return "none";
}
Json Codec<Mask>::schema(const Limits&, Schema& defs) {
  return one_of(Json::array({{{"type", "string"}, {"minLength", 1}}, only_key_schema("box", Codec<deck::Box>::schema({}, defs))}));
}

void Codec<Observation>::read(Observation& out, const Place& place, const Limits&) { Tagged<Observation>::read(out, place, "kind"); }
Json Codec<Observation>::write(const Observation& in, const Limits&) { return Tagged<Observation>::write(in, "kind"); }
Json Codec<Observation>::schema(const Limits&, Schema& defs) { return Tagged<Observation>::schema(defs, "kind"); }

void Codec<Optimizer>::read(Optimizer& out, const Place& place, const Limits&) { Tagged<Optimizer>::read(out, place, "method"); }
Json Codec<Optimizer>::write(const Optimizer& in, const Limits&) { return Tagged<Optimizer>::write(in, "method"); }
Json Codec<Optimizer>::schema(const Limits&, Schema& defs) { return Tagged<Optimizer>::schema(defs, "method"); }

}  // namespace jaxmpm::described
