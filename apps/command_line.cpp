// Subcommands and options as CLI11 knows them. The only file that includes it, as it takes longer to compile than the commands themselves.
#include "command_line.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "core/error.hpp"
#include "core/provenance.hpp"
#include "fields/files.hpp"

namespace jaxmpm {
namespace {

void add_common_options(CLI::App& app, CommonOptions& options) {
  CLI::Option* quiet = app.add_flag("-q,--quiet", options.quiet, "Warnings and errors only");
  app.add_flag("-v,--verbose", options.verbose, "Tell more, such as each frame written")->excludes(quiet);
  app.add_option("--log", options.log, "Write everything that is told to this file too, with time stamps")->type_name("FILE");
}

void add_deck_options(CLI::App& app, DeckOptions& options) {
  app.add_option("deck", options.deck, "The deck: a JSON file (docs/deck-reference.md)")->required()->type_name("DECK");
  app.add_option("--set", options.assignments, "Set a value of the deck, e.g. --set /time/end=0.5; may be repeated")
      ->type_name("POINTER=JSON")
      ->allow_extra_args(false);
  app.add_option("--threads", options.threads, "Host threads; default: all cores")->check(CLI::Range(1, 4096))->type_name("N");
  app.add_option("--backend", options.backend, "cpu or cuda; default: cuda where the program was built for it")
      ->check(CLI::IsMember({"cpu", "cuda"}))
      ->type_name("NAME");
}

/// Options of a command that writes results; returns that of --resume.
CLI::Option* add_results_options(CLI::App& app, ResultsOptions& options, const std::string& overwrite, const std::string& resume,
                                 const std::string& walltime) {
  app.add_option("-o,--output", options.directory, "Results directory, instead of the deck's")->type_name("DIR");
  CLI::Option* replace = app.add_flag("--overwrite", options.overwrite, overwrite);
  CLI::Option* again = app.add_option("--resume", options.resume, resume)->excludes(replace);
  const CLI::Validator above_zero(
      [](const std::string& text) {
        double minutes = 0;
        return parse_number(text, minutes) && minutes > 0 ? std::string() : "'" + text + "' is no number of minutes above 0";
      },
      "");
  app.add_option("--max-walltime", options.max_walltime, walltime)->check(above_zero)->type_name("MIN");
  return again;
}

void add_run(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("run", "Run a deck and write its results");
  auto options = std::make_shared<ResultsOptions>();
  add_deck_options(*command, *options);
  add_results_options(*command, *options, "Replace results that are there",
                      "Continue: auto (newest checkpoint of the directory, or from the beginning) or a checkpoint file",
                      "Stop with a checkpoint after this many minutes")
      ->type_name("auto|FILE");
  command->callback([&line, options] { line.command = [&line, options] { return run(*options, line.common.quiet); }; });
}

void add_invert(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("invert", "Find the unknowns of a deck from its observations");
  auto options = std::make_shared<ResultsOptions>();
  add_deck_options(*command, *options);
  add_results_options(*command, *options, "Replace an inversion that is there",
                      "Continue the inversion of the directory, or start at the beginning", "Stop after this many minutes, to be continued")
      ->check(CLI::IsMember({"auto"}))
      ->type_name("auto");
  command->callback([&line, options] { line.command = [options] { return invert(*options); }; });
}

void add_check(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("check", "Check a deck: all errors, particles, memory, time step, estimated time");
  auto options = std::make_shared<DeckOptions>();
  add_deck_options(*command, *options);
  command->callback([&line, options] { line.command = [options] { return check(*options); }; });
}

void add_gradient(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("gradient", "Loss and gradient of a deck at the start of its unknowns");
  auto options = std::make_shared<GradientOptions>();
  add_deck_options(*command, *options);
  CLI::Option* check = command->add_flag("--check", options->check, "Compare the gradient with forward runs, and give a verdict");
  command->add_option("--directions", options->directions, "Random directions of the check")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->needs(check)
      ->type_name("N");
  command->add_option("--seed", options->seed, "Of the random directions")->capture_default_str()->needs(check)->type_name("N");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([&line, options] { line.command = [options] { return gradient(*options); }; });
}

void add_bench(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("bench", "Measure the cost of steps and of their gradient, without output");
  auto options = std::make_shared<BenchOptions>();
  add_deck_options(*command, *options);
  command->add_option("--steps", options->steps, "Steps to measure")
      ->required()
      ->check(CLI::Range(std::uint64_t(1), std::uint64_t(1) << 40))
      ->type_name("N");
  command->add_option("--warm-up", options->warm_up, "Steps before that, not counted")->capture_default_str()->type_name("N");
  command->add_flag("--gradient", options->gradient, "Also measure the gradient of as many steps, from the start of the run");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([&line, options] { line.command = [options] { return bench(*options); }; });
}

void add_schema(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("schema", "Print the JSON Schema of the deck");
  auto markdown = std::make_shared<bool>(false);
  command->add_flag("--markdown", *markdown, "Print the deck reference as Markdown instead");
  command->callback([&line, markdown] { line.command = [markdown] { return schema(*markdown); }; });
}

void add_info(CLI::App& app, CommandLine& line) {
  app.add_subcommand("info", "Print version, commit, compiler, backends and vector widths")->callback([&line] { line.command = info; });
}

}  // namespace

int read_command_line(int argc, char** argv, CommandLine& line) {
  CLI::App app("Material point method: forward simulation and calibration from one deck.", "jaxmpm");
  app.set_version_flag("--version", provenance().version);
  app.require_subcommand(1);
  app.fallthrough();
  add_common_options(app, line.common);
  for (const auto add : {add_run, add_invert, add_check, add_gradient, add_bench, add_schema, add_info}) add(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    line.command = {};
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::deck);
  }
  return 0;
}

}  // namespace jaxmpm
