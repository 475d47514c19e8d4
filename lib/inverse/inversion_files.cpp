#include "inverse/inversion_files.hpp"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/provenance.hpp"
#include "inverse/evaluation_record.hpp"
#include "inverse/misfit.hpp"
#include "io/checkpoint.hpp"
#include "io/files.hpp"
#include "scene/frame.hpp"
#include "spdlog/fmt/fmt.h"

namespace jaxmpm {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uint64_t inversion_format = 1;
const char* const kind = "jaxmpm inversion";

const Variables& best_variables(const InversionState& state) {
  const RecordedEvaluation* best = state.loss.best();
  return best != nullptr ? best->u : state.unknowns.space().start;
}

/// Numbers at a pointer as JSON: one, or a list.
Json shown(const std::string& pointer, const std::vector<double>& numbers) {
  return deck::is_list(pointer) ? Json(numbers) : Json(numbers.at(0));
}

/// Name of the file of a body's velocities.
std::string velocity_file(const deck::Body& body) { return "velocity_" + body.name + ".csv"; }

/// Pointers of the velocities of particles among the unknowns.
std::vector<std::string> particle_velocities(const Unknowns& unknowns) {
  std::vector<std::string> found;
  for (const std::string& pointer : unknowns.pointers())
    if (deck::is_particle_velocities(pointer)) found.push_back(pointer);
  return found;
}

Json iteration_json(const Unknowns& unknowns, const RecordedEvaluation& evaluation) {
  Json json{{"loss", evaluation.loss}, {"unknowns", Json::object()}};
  for (const auto& [pointer, numbers] : unknowns.values(evaluation.u))
    if (!deck::is_list(pointer)) json["unknowns"][pointer] = numbers.at(0);
  json["forward_seconds"] = evaluation.forward_seconds;
  json["gradient_seconds"] = evaluation.gradient_seconds;
  return json;
}

Json unknowns_json(const InversionState& state) {
  const Values values = state.unknowns.values(best_variables(state));
  Json json = Json::object();
  for (const VariableBlock& block : state.unknowns.blocks())
    for (const std::string& pointer : block.pointers) {
      Json& entry = json[pointer];
      if (deck::is_particle_velocities(pointer)) entry["value"]["file"] = velocity_file(state.deck.bodies[body_of(pointer)]);
      else entry["value"] = shown(pointer, values.at(pointer));
      entry["standard_error"] = nullptr;
      if (!state.standard_errors) continue;
      const auto first = state.standard_errors->begin() + static_cast<std::ptrdiff_t>(block.first);
      entry["standard_error"] = shown(pointer, {first, first + static_cast<std::ptrdiff_t>(block.count)});
    }
  return json;
}

Json comparisons_json(const std::vector<Comparison>& comparisons) {
  Json list = Json::array();
  for (const Comparison& one : comparisons) {
    const Misfit misfit = misfit_of(one);
    const bool correlated = !std::isnan(misfit.correlation);
    list.push_back({{"rows", one.time.size()},
                    {"unread", misfit.unread},
                    {"rms", misfit.rms},
                    {"mean", misfit.mean},
                    {"largest", misfit.largest},
                    {"correlation", correlated ? Json(misfit.correlation) : Json(nullptr)},
                    {"noise", misfit.can_tell() ? Json(!misfit.is_no_noise()) : Json(nullptr)}});
  }
  return list;
}

/// The data beside the readings of the best run.
void write_comparisons(hdf5::Writer& file, const std::vector<Comparison>& comparisons) {
  for (std::size_t o = 0; o < comparisons.size(); ++o) {
    const Comparison& one = comparisons[o];
    const std::string group = "/observations/" + std::to_string(o);
    const std::size_t rows = one.time.size();
    file.dataset(group + "/time", {rows}, one.time);
    file.dataset(group + "/subject", {rows}, std::vector<double>(one.subject.begin(), one.subject.end()));
    file.dataset(group + "/observed", {rows, one.width}, one.observed);
    file.dataset(group + "/read", {rows, one.width}, one.read);
    file.dataset(group + "/sigma", {rows}, one.sigma);
    if (one.places.empty()) continue;
    std::vector<double> at;
    for (const std::size_t subject : one.subject) at.insert(at.end(), one.places[subject].begin(), one.places[subject].end());
    file.dataset(group + "/at", {rows, one.places[0].size()}, at);
  }
}

std::string json_text(const InversionState& state) {
  Json json{{"title", state.deck.title}, {"stopped", state.stopped}, {"iterations", Json::array()}};
  for (const RecordedEvaluation& one : state.loss.evaluations())
    if (one.is_iteration()) json["iterations"].push_back(iteration_json(state.unknowns, one));
  json["unknowns"] = unknowns_json(state);
  json["loss"] = state.loss.best() != nullptr ? Json(state.loss.best()->loss) : Json(nullptr);
  json["observations"] = comparisons_json(state.comparisons);
  json["evaluations"] = state.loss.evaluations().size();
  json["gradient_peak_bytes"] = state.loss.peak_bytes();
  json["backend"] = state.backend;
  json["version"] = provenance().version;
  json["git_commit"] = provenance().git_commit;
  return json.dump(2) + "\n";
}

void write_history(hdf5::Writer& file, const InversionState& state) {
  std::vector<double> loss, forward, gradient;
  std::map<std::string, std::vector<double>> numbers;
  for (const RecordedEvaluation& one : state.loss.evaluations()) {
    if (!one.is_iteration()) continue;
    loss.push_back(one.loss);
    forward.push_back(one.forward_seconds);
    gradient.push_back(one.gradient_seconds);
    for (const auto& [pointer, values] : state.unknowns.values(one.u))
      if (!deck::is_list(pointer)) numbers[pointer].push_back(values.at(0));
  }
  file.dataset("/history/loss", {loss.size()}, loss);
  file.dataset("/history/forward_seconds", {forward.size()}, forward);
  file.dataset("/history/gradient_seconds", {gradient.size()}, gradient);
  for (const auto& [pointer, values] : numbers) file.dataset("/unknowns" + pointer + "/history", {values.size()}, values);
  for (const auto& [pointer, values] : state.unknowns.values(best_variables(state)))
    file.dataset("/unknowns" + pointer + "/value", {values.size()}, values);
}

/// The initial fields with the best values: what an unknown velocity field has become.
void write_fields(hdf5::Writer& file, const Model& model) {
  const auto dim = static_cast<std::size_t>(model.dim);
  for (const Body& body : model.bodies) {
    const BodyState& initial = body.initial;
    std::vector<double> position, velocity;
    for (std::size_t p = 0; p < initial.id.size(); ++p)
      for (std::size_t d = 0; d < dim; ++d) {
        position.push_back(model.domain_min[d] + model.cell_size * initial.position[p][d]);
        velocity.push_back(initial.velocity[p][d]);
      }
    const std::string group = "/bodies/" + body.name;
    file.dataset(group + "/id", "u4", {initial.id.size()}, initial.id.data());
    file.dataset(group + "/position", {initial.id.size(), dim}, position);
    file.attribute(group + "/position", "units", std::string("m"));
    file.dataset(group + "/velocity", {initial.id.size(), dim}, velocity);
    file.attribute(group + "/velocity", "units", std::string("m/s"));
  }
}

/// Velocities of a body as the deck's key velocity reads them from a file, to the bit.
std::string velocity_table(const Body& body, int dim) {
  std::string text = "# initial velocity of each particle of '" + body.name + "', m/s\nid,vx,vy" + (dim == 3 ? ",vz\n" : "\n");
  for (std::size_t p = 0; p < body.initial.id.size(); ++p) {
    text += std::to_string(body.initial.id[p]);
    for (std::size_t d = 0; d < static_cast<std::size_t>(dim); ++d) text += fmt::format(",{}", body.initial.velocity[p][d]);
    text += '\n';
  }
  return text;
}

void write_h5(const std::string& path, const InversionState& state, const Model& model) {
  hdf5::Writer file(path);
  file.attribute("/", "kind", std::string(kind));
  file.attribute("/", "format", inversion_format);
  file.attribute("/", "version", provenance().version);
  file.attribute("/", "git_commit", provenance().git_commit);
  file.attribute("/", "title", state.deck.title);
  file.attribute("/", "stopped", state.stopped);
  file.text("/deck_resolved", state.deck.resolved);
  write_history(file, state);
  write_fields(file, model);
  write_comparisons(file, state.comparisons);
  write_evaluations(file, state.loss.evaluations());
  file.finish();
}

}  // namespace

bool InversionDirectory::holds_inversion() const { return std::filesystem::exists(json()) || std::filesystem::exists(h5()); }

void InversionDirectory::prepare() const { make_directory(path_); }

void InversionDirectory::clear(const deck::Deck& deck, const Unknowns& unknowns) const {
  std::vector<std::string> files{json(), h5()};
  for (const std::string& pointer : particle_velocities(unknowns))
    files.push_back(path_ + "/" + velocity_file(deck.bodies[body_of(pointer)]));
  for (const std::string& file : files) remove_file(file);
}

void InversionDirectory::protect_inputs(const deck::Deck& deck, const Unknowns& unknowns) const {
  for (const std::string& pointer : particle_velocities(unknowns)) {
    const deck::Body& body = deck.bodies[body_of(pointer)];
    const std::string input = make_frame(deck).file(std::get<deck::ParticleFile>(body.velocity).file);
    std::error_code none;
    if (std::filesystem::equivalent(input, path_ + "/" + velocity_file(body), none))
      throw DeckError(pointer + "/file", "'" + input +
                                             "' is where this inversion writes what it finds, and the search starts from it: copy it, "
                                             "or choose another directory with -o");
  }
}

void InversionDirectory::write(const InversionState& state) const {
  const Values values = state.unknowns.values(best_variables(state));
  const Model model = build_model(with_values(state.deck, values), values);
  for (const std::string& pointer : particle_velocities(state.unknowns)) {
    const std::size_t body = body_of(pointer);
    write_file(path_ + "/" + velocity_file(state.deck.bodies[body]), velocity_table(model.bodies[body], model.dim));
  }
  write_h5(h5(), state, model);
  write_file(json(), json_text(state));
}

std::vector<RecordedEvaluation> InversionDirectory::read(const deck::Deck& deck, const Unknowns& unknowns) const {
  if (!std::filesystem::exists(h5())) return {};
  const hdf5::Reader file(h5());
  if (file.text_attribute("/", "kind") != kind || file.count_attribute("/", "format") != inversion_format)
    throw IoError("'" + h5() + "' is no inversion of format " + std::to_string(inversion_format) +
                  "; resume with the version of jaxmpm that wrote it.");
  require_same_deck(file.text("/deck_resolved"), deck.resolved, h5(),
                    {"/output", "/inverse/memory", "/inverse/disk", "/inverse/optimizer/iterations", "/inverse/optimizer/tolerance"});
  return read_evaluations(file, unknowns.size());
}

}  // namespace jaxmpm
