// jaxmpm: the command line. Exit codes: 0 done, 1 a check's bad verdict, 2 deck or usage, 3 numerics, 4 input/output, 75 stopped with a
// checkpoint.
#include <cstdio>
#include <iostream>

#include "command_line.hpp"
#include "core/error.hpp"
#include "core/logging.hpp"

namespace {

using namespace jaxmpm;

Verbosity verbosity(const CommonOptions& options) {
  return options.quiet ? Verbosity::quiet : options.verbose ? Verbosity::verbose : Verbosity::normal;
}

int guarded(const CommandLine& line) {
  try {
    start_logging(verbosity(line.common), line.common.log);
    const int code = line.command();
    std::cout.flush();
    if (!std::cout) throw IoError("cannot write to standard output (a full disk or a closed pipe).");
    return code;
  } catch (const DeckError& error) {
    const std::size_t count = error.problems.size();
    spdlog::error("jaxmpm: {} problem{} in the deck; nothing was run.\n{}", count, count == 1 ? "" : "s", error.what());
    return static_cast<int>(error.code);
  } catch (const Error& error) {
    spdlog::error("jaxmpm: {}", error.what());
    return static_cast<int>(error.code);
  } catch (const std::bad_alloc&) {
    spdlog::error(
        "jaxmpm: out of memory. `jaxmpm check DECK` tells what a deck needs; a larger /domain/cell_size or fewer particles need less.");
    return static_cast<int>(ExitCode::io);
  } catch (const std::exception& error) {
    spdlog::error("jaxmpm: an error of the program itself: {}. Please report it, with the deck.", error.what());
    return static_cast<int>(ExitCode::io);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line;
  const int code = read_command_line(argc, argv, line);
  return line.command ? guarded(line) : code;
}
