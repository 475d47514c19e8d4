#include "core/error.hpp"

namespace jaxmpm {
namespace {
std::string summary(const std::vector<Problem>& problems) {
  std::string text;
  for (const Problem& p : problems) {
    if (!text.empty()) text += '\n';
    text += p.pointer.empty() ? "/" : p.pointer;
    if (p.line > 0) text += " (line " + std::to_string(p.line) + ")";
    text += ": " + p.message;
  }
  return text;
}
}  // namespace

DeckError::DeckError(std::vector<Problem> found) : Error(ExitCode::deck, summary(found)), problems(std::move(found)) {}

}  // namespace jaxmpm
