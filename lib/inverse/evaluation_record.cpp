#include "inverse/evaluation_record.hpp"

namespace jaxmpm {
namespace {

const std::string group = "/evaluations/";

}  // namespace

void write_evaluations(hdf5::Writer& file, const std::vector<RecordedEvaluation>& evaluations) {
  std::vector<unsigned char> kind, diverged;
  std::vector<double> loss, forward, gradient, variables, derivatives;
  std::vector<std::uint64_t> sizes;
  for (const RecordedEvaluation& one : evaluations) {
    kind.push_back(static_cast<unsigned char>(one.kind));
    diverged.push_back(one.diverged);
    loss.push_back(one.loss);
    forward.push_back(one.forward_seconds);
    gradient.push_back(one.gradient_seconds);
    variables.insert(variables.end(), one.u.begin(), one.u.end());
    sizes.push_back(one.derivative.size());
    derivatives.insert(derivatives.end(), one.derivative.begin(), one.derivative.end());
  }
  const std::size_t count = evaluations.size(), width = evaluations.empty() ? 0 : evaluations[0].u.size();
  constexpr auto checked = hdf5::Storage::checked;
  file.dataset(group + "kind", "u1", {count}, kind.data(), checked);
  file.dataset(group + "diverged", "u1", {count}, diverged.data(), checked);
  file.dataset(group + "loss", {count}, loss, checked);
  file.dataset(group + "forward_seconds", {count}, forward, checked);
  file.dataset(group + "gradient_seconds", {count}, gradient, checked);
  file.dataset(group + "variables", {count, width}, variables, checked);
  file.dataset(group + "derivative_size", "u8", {count}, sizes.data(), checked);
  file.dataset(group + "derivatives", {derivatives.size()}, derivatives, checked);
}

std::vector<RecordedEvaluation> read_evaluations(const hdf5::Reader& file, std::size_t variables) {
  const auto kind = file.bytes(group + "kind"), diverged = file.bytes(group + "diverged");
  const auto loss = file.numbers(group + "loss"), forward = file.numbers(group + "forward_seconds");
  const auto gradient = file.numbers(group + "gradient_seconds"), u = file.numbers(group + "variables");
  const auto derivatives = file.numbers(group + "derivatives");
  const auto sizes = file.counts(group + "derivative_size");
  std::vector<RecordedEvaluation> found(kind.size());
  std::size_t total = 0;
  for (const std::uint64_t size : sizes) total += size;
  for (const std::size_t size : {diverged.size(), loss.size(), forward.size(), gradient.size(), sizes.size()})
    if (size != found.size()) throw IoError("the lists of recorded evaluations differ in length; the file is damaged.");
  if (u.size() != variables * found.size() || total != derivatives.size())
    throw IoError("the recorded evaluations are not of " + std::to_string(variables) + " variables; the file is damaged.");
  auto at = derivatives.begin();
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto first = u.begin() + static_cast<std::ptrdiff_t>(k * variables), end = at + static_cast<std::ptrdiff_t>(sizes[k]);
    found[k] = {static_cast<RecordedEvaluation::Kind>(kind[k]),
                diverged[k] != 0,
                {first, first + static_cast<std::ptrdiff_t>(variables)},
                loss[k],
                {at, end},
                forward[k],
                gradient[k]};
    at = end;
  }
  return found;
}

}  // namespace jaxmpm
