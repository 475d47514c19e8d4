#pragma once
// The words after `jaxmpm`.
#include <functional>

#include "commands.hpp"

namespace jaxmpm {

struct CommandLine {
  CommonOptions common;
  std::function<int()> command;  // work of the subcommand, which returns the exit code; empty: nothing is left to do
};

/// Reads the command line into `line`, which must stay where it is; answers --help, --version and mistakes. Returns the exit code of a
/// program that has nothing left to do.
int read_command_line(int argc, char** argv, CommandLine& line);

}  // namespace jaxmpm
