#pragma once
// Plain structs from JSON and back. One describe() per struct names its keys with unit, range, default and help; from it come the reader,
// the writer (every default filled in), the JSON Schema and, from the schema, the reference page. The default of a key is what the struct
// itself starts with.
//
//   void describe(Description<Newtonian>& d) {
//     d.is("newtonian", "Weakly compressible Newtonian fluid");
//     d.required("density", &Newtonian::density).unit("kg/m³").above(0).help("Density at rest.");
//     d.optional("viscosity", &Newtonian::viscosity).unit("Pa s").from(0);
//   }
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/describe_place.hpp"
#include "core/describe_schema.hpp"

namespace jaxmpm::described {

/// What a value may be, beyond its C++ type. Bounds hold for a number and for each number of a list.
struct Limits {
  enum class Length { any, dimension, plan };  // of a list: as it is limited below, one per axis, one per axis but the vertical one
  std::string unit;
  std::optional<double> above, from, below, to;
  std::vector<std::string> choices;  // of a string, or of each string of a list
  std::string word;                  // stands for an empty optional: "none", "auto"
  Length length = Length::any;
  std::size_t fewest = 0, most = SIZE_MAX;
  bool distinct = false;
};

/// How a type is read, written and described. Specialised below for numbers, words, lists, maps, enums and described structs.
template <class T, class = void>
struct Codec;

/// Declares, in namespace described, the three calls of a codec that is defined in a .cpp file.
#define JAXMPM_CODEC(Type)                                                 \
  template <>                                                              \
  struct Codec<Type> {                                                     \
    static void read(Type& out, const Place& place, const Limits& limits); \
    static Json write(const Type& in, const Limits& limits);               \
    static Json schema(const Limits& limits, Schema& defs);                \
  }

/// Names of an enum's values in JSON: `EnumNames<E> names_of(E)`, found by argument-dependent lookup.
template <class E>
using EnumNames = std::vector<std::pair<E, std::string>>;

/// How the values of one C++ type are read, written and described by one codec; the pointers are to such values.
struct ValueCodec {
  void (*read)(void* out, const Place& place, const Limits& limits);
  Json (*write)(const void* in, const Limits& limits);  // discarded: nothing to write
  Json (*schema)(const Limits& limits, Schema& defs);
};
template <class C, class M>
inline constexpr ValueCodec codec_of{
    [](void* out, const Place& place, const Limits& limits) { C::read(*static_cast<M*>(out), place, limits); },
    [](const void* in, const Limits& limits) { return C::write(*static_cast<const M*>(in), limits); }, &C::schema};

/// What is known of one key of a struct.
struct KeyFacts {
  std::string name, text, condition, default_text;
  bool required = false, empty_is_absent = false;
  Limits limits;
  const ValueCodec* codec = nullptr;  // none: a key of the file, which must have the value `fixed` (null: any string)
  std::ptrdiff_t offset = 0;          // of the member in its struct, bytes
  Json fixed;
  std::function<bool(const void* in)> matters;
  std::vector<std::string> matters_by;  // keys that `matters` looks at
  std::function<void(void* out, const Reader&)> fill;
};

/// Says more about a key of a struct T; the calls can be chained.
template <class T>
class Key {
 public:
  explicit Key(KeyFacts& facts) : facts_(facts) {}

  Key& help(std::string prose) {
    facts_.text = std::move(prose);
    return *this;
  }
  Key& unit(std::string name_of_unit) {
    facts_.limits.unit = std::move(name_of_unit);
    return *this;
  }
  Key& above(double bound) {
    facts_.limits.above = bound;
    return *this;
  }
  Key& from(double bound) {
    facts_.limits.from = bound;
    return *this;
  }
  Key& below(double bound) {
    facts_.limits.below = bound;
    return *this;
  }
  Key& to(double bound) {
    facts_.limits.to = bound;
    return *this;
  }
  Key& choices(std::vector<std::string> words) {
    facts_.limits.choices = std::move(words);
    return *this;
  }
  Key& word(std::string name_of_empty) {
    facts_.limits.word = std::move(name_of_empty);
    return *this;
  }
  /// A list with one number per axis of the domain.
  Key& vector() {
    facts_.limits.length = Limits::Length::dimension;
    return *this;
  }
  /// A list with one number per axis except the vertical one.
  Key& plan_vector() {
    facts_.limits.length = Limits::Length::plan;
    return *this;
  }
  Key& items(std::size_t fewest, std::size_t most = SIZE_MAX) {
    facts_.limits.fewest = fewest;
    facts_.limits.most = most;
    return *this;
  }
  Key& distinct() {
    facts_.limits.distinct = true;
    return *this;
  }
  /// The key has an effect only where the condition, holds(const T&), which looks at the keys `by`, holds; elsewhere it is refused, and not
  /// written.
  template <class F>
  Key& when(std::vector<std::string> by, F holds, std::string words) {
    facts_.matters_by = std::move(by);
    facts_.matters = [holds](const void* in) { return holds(*static_cast<const T*>(in)); };
    facts_.condition = std::move(words);
    return *this;
  }
  /// An empty string or list stands for a key that was not given, and is not written.
  Key& absent_when_empty() {
    facts_.empty_is_absent = true;
    return *this;
  }
  /// A default that depends on other keys or on the dimension; `words` says it in the reference. Somebody above fills it in.
  Key& otherwise(std::string words) {
    facts_.default_text = std::move(words);
    return *this;
  }
  /// The same; filler(T&, const Reader&) fills it in.
  template <class F>
  Key& otherwise(std::string words, F filler) {
    facts_.fill = [filler](void* out, const Reader& reader) { filler(*static_cast<T*>(out), reader); };
    return otherwise(std::move(words));
  }

 private:
  KeyFacts& facts_;
};

/// Keys and rules of a struct, whose C++ type only Description<T> knows: all that reads, writes and describes is compiled once for all.
class StructDescription {
 public:
  /// Name of the struct in JSON, what it is, and the family (material, shape, …) whose members its name tells apart.
  void is(std::string name, std::string prose, const std::string& family = {});
  /// The struct exists only in this dimension.
  void only_in(int dimension) { dimension_ = dimension; }
  /// A key that belongs to the file, not to the struct: it must have this value (or, where `value` is null, may be any string).
  void fixed(const std::string& name, Json value, bool needed, const std::string& prose);

  const std::string& name() const { return name_; }
  const std::string& text() const { return text_; }
  const std::string& definition() const { return definition_; }

 protected:
  using Rule = std::function<void(const void* in, const Place&)>;
  KeyFacts& add(const std::string& name, const ValueCodec& codec, std::ptrdiff_t offset, bool required);
  void add_rule(std::vector<std::string> by, Rule rule) { rules_.push_back({std::move(by), std::move(rule)}); }
  void read_struct(void* out, const Place& place, const std::string& tag) const;
  Json write_struct(const void* in, const std::string& tag) const;
  Json struct_schema(const void* fresh, Schema& defs, const std::string& tag) const;

 private:
  void read_keys(void* out, const Place& place) const;
  void check_together(const void* out, const Place& place) const;
  std::vector<std::string> names(const std::string& tag) const;

  std::string name_, definition_, text_;
  int dimension_ = 0;
  std::deque<KeyFacts> keys_;
  std::vector<std::pair<std::vector<std::string>, Rule>> rules_;
};

template <class T>
class Description : public StructDescription {
 public:
  Description() { describe(*this); }
  static const Description& get() {
    static const Description description;
    return description;
  }

  template <class M>
  Key<T> required(const std::string& name, M T::*member) {
    return Key<T>(add(name, codec_of<Codec<M>, M>, offset_of(member), true));
  }
  template <class M>
  Key<T> optional(const std::string& name, M T::*member) {
    return optional_as<Codec<M>>(name, member);
  }
  /// As optional(), with a codec other than that of the member's type.
  template <class C, class M>
  Key<T> optional_as(const std::string& name, M T::*member) {
    return Key<T>(add(name, codec_of<C, M>, offset_of(member), false));
  }
  /// A check of several keys together, rule(const T&, const Place&), made when none of the keys `by` has a problem of its own.
  template <class F>
  void check(std::vector<std::string> by, F rule) {
    add_rule(std::move(by), [rule](const void* in, const Place& place) { rule(*static_cast<const T*>(in), place); });
  }

  /// `tag`: a key that was read already and tells which struct this is.
  void read(T& out, const Place& place, const std::string& tag = {}) const { read_struct(&out, place, tag); }
  Json write(const T& in, const std::string& tag = {}) const { return write_struct(&in, tag); }
  Json schema(Schema& defs, const std::string& tag = {}) const { return struct_schema(&fresh_, defs, tag); }

 private:
  template <class M>
  std::ptrdiff_t offset_of(M T::*member) const {
    return reinterpret_cast<const char*>(&(fresh_.*member)) - reinterpret_cast<const char*>(&fresh_);
  }

  const T fresh_{};  // holds the defaults
};

// ---- simple types ----

template <>
struct Codec<double> {
  static void read(double& out, const Place& place, const Limits& limits);
  static Json write(double in, const Limits&) { return in; }
  static Json schema(const Limits& limits, Schema&);
};
template <>
struct Codec<bool> {
  static void read(bool& out, const Place& place, const Limits&);
  static Json write(bool in, const Limits&) { return in; }
  static Json schema(const Limits&, Schema&) { return {{"type", "boolean"}}; }
};
template <>
struct Codec<std::string> {
  static void read(std::string& out, const Place& place, const Limits& limits);
  static Json write(const std::string& in, const Limits&) { return in; }
  static Json schema(const Limits& limits, Schema&);
};

/// A whole number within bounds; what is out of T's own range is refused before it is converted.
bool read_integer(const Place& place, const Limits& limits, double lowest, double highest, Json& out);
Json integer_schema(const Limits& limits);
template <class T>
struct Codec<T, std::enable_if_t<std::is_integral_v<T>>> {
  static void read(T& out, const Place& place, const Limits& limits) {
    Json value;
    const double lowest = std::is_signed_v<T> ? -2147483648.0 : 0.0;
    if (read_integer(place, limits, lowest, sizeof(T) == 4 ? 2147483647.0 : 9007199254740992.0, value)) out = value.get<T>();
  }
  static Json write(T in, const Limits&) { return in; }
  static Json schema(const Limits& limits, Schema&) { return integer_schema(limits); }
};

/// Reads one of some words; returns its index, or −1 after reporting.
int read_choice(const Place& place, const std::vector<std::string>& choices);
template <class T>
struct Codec<T, std::enable_if_t<std::is_enum_v<T>>> {
  static std::vector<std::string> words() {
    std::vector<std::string> list;
    for (const auto& [value, name] : names_of(T{})) list.push_back(name);
    return list;
  }
  static void read(T& out, const Place& place, const Limits&) {
    const int index = read_choice(place, words());
    if (index >= 0) out = names_of(T{})[static_cast<std::size_t>(index)].first;
  }
  static Json write(T in, const Limits&) {
    for (const auto& [value, name] : names_of(T{}))
      if (value == in) return name;
    return nullptr;
  }
  static Json schema(const Limits&, Schema&) { return {{"enum", words()}}; }
};

// ---- containers ----

/// Whether the value is an object; reports if not.
bool check_object(const Place& place);
/// Reports keys that are not among `names`, with the nearest of them.
void check_keys(const Place& place, const std::vector<std::string>& names);

/// Whether the value is a list of permitted length with distinct items; reports if not.
bool check_list(const Place& place, const Limits& limits);
Json list_schema(const Limits& limits, Json items);
template <class T>
struct Codec<std::vector<T>> {
  /// Limits of the items. In a list of lists the length along the axes is that of the inner ones, the count that of the outer one.
  static Limits inner(Limits limits) {
    limits.fewest = 0;
    limits.most = SIZE_MAX;
    limits.distinct = false;
    return limits;
  }
  static Limits outer(Limits limits) {
    if constexpr (std::is_same_v<T, std::vector<double>>) limits.length = Limits::Length::any;
    return limits;
  }
  static void read(std::vector<T>& out, const Place& place, const Limits& limits) {
    if (!check_list(place, outer(limits))) return;
    out.clear();
    for (std::size_t i = 0; i < place.value.size(); ++i) {
      out.emplace_back();
      Codec<T>::read(out.back(), place.item(i), inner(limits));
    }
  }
  static Json write(const std::vector<T>& in, const Limits& limits) {
    Json list = Json::array();
    for (const T& item : in) list.push_back(Codec<T>::write(item, limits));
    return list;
  }
  static Json schema(const Limits& limits, Schema& defs) { return list_schema(outer(limits), Codec<T>::schema(inner(limits), defs)); }
};

template <class T>
struct Codec<std::optional<T>> {
  static void read(std::optional<T>& out, const Place& place, const Limits& limits) {
    out.reset();
    if (!limits.word.empty() && place.value == limits.word) return;
    if (!limits.word.empty() && place.value.is_string())
      return place.problem("expected \"" + limits.word + "\" or " + (std::is_arithmetic_v<T> ? "a number" : "its own values") + ", found " +
                           shown(place.value));
    Codec<T>::read(out.emplace(), place, limits);
  }
  static Json write(const std::optional<T>& in, const Limits& limits) {
    if (in) return Codec<T>::write(*in, limits);
    return limits.word.empty() ? Json(Json::value_t::discarded) : Json(limits.word);
  }
  static Json schema(const Limits& limits, Schema& defs) {
    Json inside = Codec<T>::schema(limits, defs);
    if (limits.word.empty()) return inside;
    return {{"anyOf", Json::array({{{"const", limits.word}}, inside})}};
  }
};

/// A map from names to values; `limits.choices` are the names allowed, where there are any.
bool check_names(const Place& place, const Limits& limits);
/// Whether a string can name things on disk (letters, digits, _ . and -, a letter first); reports at `place` if not.
bool check_name(const std::string& name, const Place& place);
Json map_schema(const Limits& limits, Json values);
template <class T>
struct Codec<std::map<std::string, T>> {
  static void read(std::map<std::string, T>& out, const Place& place, const Limits& limits) {
    if (!check_names(place, limits)) return;
    for (const auto& [name, value] : place.value.items()) Codec<T>::read(out[name], place.key(name), {});
  }
  static Json write(const std::map<std::string, T>& in, const Limits&) {
    Json object = Json::object();
    for (const auto& [name, value] : in) object[name] = Codec<T>::write(value, {});
    return object;
  }
  static Json schema(const Limits& limits, Schema& defs) { return map_schema(limits, Codec<T>::schema({}, defs)); }
};

// ---- described structs ----

template <class T, class>
struct Codec {
  static void read(T& out, const Place& place, const Limits&) { Description<T>::get().read(out, place); }
  static Json write(const T& in, const Limits&) { return Description<T>::get().write(in); }
  static Json schema(const Limits&, Schema& defs) {
    return defs.reference(Description<T>::get().definition(), [&defs] { return Description<T>::get().schema(defs); });
  }
};

}  // namespace jaxmpm::described

#include "core/describe_choice.hpp"
