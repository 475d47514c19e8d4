#pragma once
// What can go wrong, as the user sees it: an exit code and a message that says what, where, why and what to do.
#include <stdexcept>
#include <string>
#include <vector>

namespace jaxmpm {

/// Exit codes of the program (contract: docs/command-line.md).
enum class ExitCode { done = 0, bad_verdict = 1, deck = 2, numerics = 3, io = 4, stopped = 75 };

/// Base of every error that reaches the user; `code` becomes the exit status.
struct Error : std::runtime_error {
  Error(ExitCode exit_code, const std::string& message) : std::runtime_error(message), code(exit_code) {}
  ExitCode code;
};

/// One complaint about a deck: where it is (JSON pointer and line, 0 when unknown) and what to do about it.
struct Problem {
  std::string pointer;
  int line = 0;
  std::string message;
};

/// Everything wrong with a deck, reported at once (exit 2).
struct DeckError : Error {
  explicit DeckError(std::vector<Problem> found);
  DeckError(const std::string& pointer, const std::string& message) : DeckError({Problem{pointer, 0, message}}) {}
  std::vector<Problem> problems;
};

/// A file that cannot be read or written (exit 4).
struct IoError : Error {
  explicit IoError(const std::string& message) : Error(ExitCode::io, message) {}
};

/// A run that went unstable: a particle left the domain or a value is not finite (exit 3).
struct NumericsError : Error {
  explicit NumericsError(const std::string& message) : Error(ExitCode::numerics, message) {}
};

}  // namespace jaxmpm
