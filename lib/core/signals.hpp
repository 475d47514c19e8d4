#pragma once
// Requests to stop: SIGTERM, SIGINT and SIGUSR1 ask the run to end at the next step, with a checkpoint.

namespace jaxmpm {

/// Installs the handlers. A second SIGINT ends the program at once, as a user who presses Ctrl-C twice expects. Writing to a full or closed
/// target is reported as an error of that write instead of by a deadly signal (SIGXFSZ, SIGPIPE).
void watch_signals();

/// Number of the signal that asked to stop, 0 while there is none.
int stop_signal();

}  // namespace jaxmpm
