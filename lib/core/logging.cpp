#include "core/logging.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <unistd.h>

#include <memory>
#include <vector>

#include "core/error.hpp"

namespace jaxmpm {

void start_logging(Verbosity verbosity, const std::string& file) {
  auto screen = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  screen->set_pattern("%v");
  screen->set_level(verbosity == Verbosity::quiet     ? spdlog::level::warn
                    : verbosity == Verbosity::verbose ? spdlog::level::debug
                                                      : spdlog::level::info);
  std::vector<spdlog::sink_ptr> sinks{screen};
  if (!file.empty()) {
    try {
      auto log = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file);
      log->set_pattern("%Y-%m-%d %H:%M:%S.%e %l %v");
      sinks.push_back(log);
    } catch (const spdlog::spdlog_ex& error) {
      throw IoError("cannot open the log file '" + file + "': " + error.what() + ". Give --log a path that can be written.");
    }
  }
  auto logger = std::make_shared<spdlog::logger>("jaxmpm", sinks.begin(), sinks.end());
  logger->set_level(spdlog::level::debug);
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(logger);
}

bool is_terminal() { return isatty(STDERR_FILENO) == 1; }

}  // namespace jaxmpm
