// jaxmpm: the command line. Exit codes: 0 done, 1 a check's bad verdict, 2 deck or usage, 3 numerics, 4 input/output, 75 stopped with a
// checkpoint.
#include <cstdio>
#include <iostream>

#include "commands.hpp"
#include "core/error.hpp"
#include "core/provenance.hpp"

namespace {

using namespace jaxmpm;

int guarded(const Chosen& chosen, const CommonOptions& options) {
  try {
    start_logging(options.verbosity(), options.log);
    const int code = chosen(options);
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
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Material point method: forward simulation and calibration from one deck.", "jaxmpm");
  app.set_version_flag("--version", provenance().version);
  app.require_subcommand(1);
  app.fallthrough();
  CommonOptions options;
  Chosen chosen;
  add_common_options(app, options);
  for (const auto add : {add_run, add_invert, add_check, add_gradient, add_bench, add_schema, add_info}) add(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::deck);
  }
  return guarded(chosen, options);
}
