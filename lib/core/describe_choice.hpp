#pragma once
// Values that are one of several described structs; included by describe.hpp alone.
#include "core/describe.hpp"

namespace jaxmpm::described {

/// Codec of a std::variant of described structs that are told apart by a tag among their own keys, as {"model": "newtonian", …}.
template <class V>
struct Tagged;
template <class... Ts>
struct Tagged<std::variant<Ts...>> {
  using V = std::variant<Ts...>;
  static std::vector<std::string> words() { return {Description<Ts>::get().name()...}; }

  static void read(V& out, const Place& place, const std::string& tag) {
    if (!place.value.is_object()) return place.problem("expected an object, found " + shown(place.value));
    if (!place.given(tag)) return place.problem(tag, "is missing; choose one of: " + listed(words()));
    const int index = read_choice(place.key(tag), words());
    int k = 0;
    ((k++ == index ? Description<Ts>::get().read(out.template emplace<Ts>(), place, tag) : void()), ...);
  }
  static Json write(const V& in, const std::string& tag) {
    return std::visit([&tag](const auto& one) { return Description<std::decay_t<decltype(one)>>::get().write(one, tag); }, in);
  }
  static Json schema(Schema& defs, const std::string& tag) {
    Json list = Json::array();
    (list.push_back(defs.reference(Description<Ts>::get().definition(), [&] { return Description<Ts>::get().schema(defs, tag); })), ...);
    return {{"oneOf", list}};
  }
};

/// Reports unless the object has exactly one key and it is one of `words`; returns that key's index or −1.
int read_only_key(const Place& place, const std::vector<std::string>& words);
Json only_key_schema(const std::string& name, Json value, const std::string& text = {});

/// Codec of a std::variant of described structs that are told apart by the only key of an object around them, as {"box": {…}}.
template <class V>
struct Keyed;
template <class... Ts>
struct Keyed<std::variant<Ts...>> {
  using V = std::variant<Ts...>;
  static std::vector<std::string> words() { return {Description<Ts>::get().name()...}; }

  static void read(V& out, const Place& place) {
    const int index = read_only_key(place, words());
    int k = 0;
    ((k++ == index ? Codec<Ts>::read(out.template emplace<Ts>(), place.key(Description<Ts>::get().name()), {}) : void()), ...);
  }
  static Json write(const V& in) {
    return std::visit(
        [](const auto& one) {
          using T = std::decay_t<decltype(one)>;
          return Json{{Description<T>::get().name(), Codec<T>::write(one, {})}};
        },
        in);
  }
  static Json schema(Schema& defs) {
    Json list = Json::array();
    (list.push_back(only_key_schema(Description<Ts>::get().name(), Codec<Ts>::schema({}, defs), Description<Ts>::get().text())), ...);
    return {{"oneOf", list}};
  }
};

}  // namespace jaxmpm::described
