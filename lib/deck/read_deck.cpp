#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "deck/check.hpp"
#include "deck/descriptions.hpp"
#include "deck/document.hpp"

namespace jaxmpm::deck {

using described::Json;

namespace {

std::string text_of(const std::string& path) {
  std::error_code ignored;
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path, ignored))
    throw IoError(path + ": the deck cannot be read; check the path and its permissions");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The dimension as /domain/min and /domain/max say it, known before anything else is read; 0 where they do not.
int dimension_of(const Json& root) {
  for (const char* corner : {"/domain/min", "/domain/max"}) {
    const Json::json_pointer pointer(corner);
    if (root.is_object() && root.contains(pointer) && root.at(pointer).is_array() &&
        (root.at(pointer).size() == 2 || root.at(pointer).size() == 3))
      return static_cast<int>(root.at(pointer).size());
  }
  return 0;
}

/// Fields that tell most about a material, in frames where the deck names none.
std::vector<std::string> own_fields(const Material& material) {
  if (std::holds_alternative<Newtonian>(material)) return {"pressure"};
  if (std::holds_alternative<DruckerPrager>(material)) return {"stress", "plastic_strain"};
  return {"stress"};
}

std::vector<std::string> default_fields(const Deck& deck) {
  std::set<std::string> wanted{"velocity"};
  for (const auto& [name, material] : deck.materials)
    for (const std::string& field : own_fields(material)) wanted.insert(field);
  std::vector<std::string> ordered;
  std::copy_if(field_names().begin(), field_names().end(), std::back_inserter(ordered),
               [&wanted](const auto& field) { return wanted.count(field) > 0; });
  return ordered;
}

/// Default /time/cfl with linear splines, which are unstable from 0.3 on in some scenes (docs/stability.md, "Time step against the speed of
/// waves"); the smoother ones are stable up to 0.78 and more.
constexpr double linear_cfl = 0.25;

/// Defaults that depend on other parts of the deck.
void fill_defaults(Deck& deck, const described::Place& root) {
  if (deck.method.basis == Basis::linear && !(root.given("time") && root.key("time").given("cfl"))) deck.time.cfl = linear_cfl;
  if (deck.output.directory.empty()) deck.output.directory = "out/" + std::filesystem::path(deck.path).stem().string();
  if (!deck.output.gauge_interval) deck.output.gauge_interval = deck.output.interval;
  if (!deck.output.fields) deck.output.fields = default_fields(deck);
  for (auto& [name, gauge] : deck.gauges)
    if (auto* front = std::get_if<FrontGauge>(&gauge); front != nullptr && !front->smooth) front->smooth = deck.domain.cell_size;
}

std::string resolved_text(const Deck& deck) {
  Json json = described::Codec<Deck>::write(deck, {});
  if (deck.gauges.empty()) json["output"].erase("gauge_interval");
  return json.dump(2);
}

[[noreturn]] void report(std::vector<Problem> problems) {
  std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) { return a.line < b.line; });
  throw DeckError(std::move(problems));
}

/// Reads and checks `text`, the deck of a file.
Deck read_text(const std::string& path, const std::string& text, const std::vector<std::string>& assignments) {
  Deck deck;
  deck.path = path;
  deck.as_given = text;
  Document document = Document::parse(text);
  for (const std::string& assignment : assignments) document.assign(assignment);

  described::Reader reader([&document](const std::string& pointer) { return document.line(pointer); }, dimension_of(document.root()));
  reader.problems() = document.problems();
  const described::Place root{document.root(), "", reader};
  described::Codec<Deck>::read(deck, root, {});
  if (document.root().is_object()) {
    fill_defaults(deck, root);
    check_scene(deck, root);
    check_gauges(deck, root);
    check_inverse(deck, root);
  }
  if (!reader.problems().empty()) report(std::move(reader.problems()));
  deck.resolved = resolved_text(deck);
  return deck;
}

}  // namespace

Deck read_deck(const std::string& path, const std::vector<std::string>& assignments) { return read_text(path, text_of(path), assignments); }

Deck with_assignments(const Deck& deck, const std::vector<std::string>& assignments) {
  Deck changed = read_text(deck.path, deck.resolved, assignments);
  changed.as_given = deck.as_given;
  return changed;
}

std::string schema() {
  described::Schema defs;
  Json root{{"$schema", "https://json-schema.org/draft/2020-12/schema"}};
  root["title"] = "jaxmpm deck, format 1";
  root.update(described::Codec<Deck>::schema({}, defs));
  root["$defs"] = defs.definitions();
  return root.dump(2);
}

std::string reference_page() { return described::reference_markdown(Json::parse(schema())); }

}  // namespace jaxmpm::deck
