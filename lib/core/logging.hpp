#pragma once
// What the program says while it works: one logger on standard error and, if asked for, in a file. Standard output is left to results.
#include <spdlog/spdlog.h>

#include <string>

namespace jaxmpm {

enum class Verbosity { quiet, normal, verbose };

/// Sets up the logger of the whole program: `quiet` shows warnings and errors only, `verbose` debugging too; a log file (when `file` is not
/// empty) gets everything with time stamps, whatever the verbosity. Throws IoError when the file cannot be opened.
void start_logging(Verbosity verbosity, const std::string& file = {});

/// Whether standard error is a terminal on which a line may be overwritten.
bool is_terminal();

}  // namespace jaxmpm
