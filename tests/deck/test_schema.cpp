// Schema and reference page come from the same descriptions as the reader.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "example.hpp"

using nlohmann::json;

namespace {

void collect_keys(const json& value, std::set<std::string>& keys) {
  for (const auto& [key, child] : value.items()) {
    if (value.is_object()) keys.insert(key);
    if (child.is_structured()) collect_keys(child, keys);
  }
}

void collect_properties(const json& schema, std::set<std::string>& keys) {
  for (const auto& [key, child] : schema.items()) {
    if (key == "properties")
      for (const auto& [name, property] : child.items()) keys.insert(name);
    if (child.is_structured()) collect_properties(child, keys);
  }
}

}  // namespace

TEST_CASE("the schema has every key of the format") {
  const json schema = json::parse(jaxmpm::deck::schema());
  CHECK(schema.at("$schema") == "https://json-schema.org/draft/2020-12/schema");
  std::set<std::string> known, used;
  collect_properties(schema, known);
  json deck = json::parse(jaxmpm::test::full_deck);
  for (const char* named : {"materials", "gauges", "parameters"}) {  // their keys are the user's own names
    for (const auto& [name, value] : deck[named].items())
      if (value.is_object()) collect_keys(value, used);
    deck.erase(named);
  }
  for (const auto& [face, wall] : deck["walls"].items()) collect_keys(wall, used);
  deck.erase("walls");
  collect_keys(deck, used);
  for (const std::string& key : used) {
    INFO(key);
    CHECK(known.count(key) == 1);
  }
  for (const char* key : {"materials", "gauges", "parameters", "walls", "youngs_modulus", "points", "learning_rate"})
    CHECK(known.count(key) == 1);
}

TEST_CASE("every reference of the schema leads to a definition") {
  const std::string text = jaxmpm::deck::schema();
  const json definitions = json::parse(text).at("$defs");
  const std::string lead = "\"$ref\": \"#/$defs/";
  for (std::size_t at = 0; (at = text.find(lead, at)) != std::string::npos; ++at) {
    const std::size_t start = at + lead.size();
    CHECK(definitions.contains(text.substr(start, text.find('"', start) - start)));
  }
}

TEST_CASE("docs/deck-reference.md is what the descriptions say") {
  std::ifstream file(std::string(JAXMPM_SOURCE_DIR) + "/docs/deck-reference.md");
  const std::string page{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::string current = jaxmpm::deck::reference_page();
  if (page != current) {
    const std::string fresh = (std::filesystem::temp_directory_path() / "deck-reference.md").string();
    std::ofstream(fresh) << current;
    FAIL("out of date; the current page is in " << fresh << ": copy it to docs/deck-reference.md");
  }
}
