#include "core/signals.hpp"
#include <initializer_list>

#include <csignal>

namespace jaxmpm {
namespace {

volatile std::sig_atomic_t received = 0;

extern "C" void remember(int signal) {
  if (signal == SIGINT) std::signal(SIGINT, SIG_DFL);
  received = signal;
}

}  // namespace

void watch_signals() {
  struct sigaction action {};
  action.sa_handler = remember;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGTERM, SIGINT, SIGUSR1}) sigaction(signal, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

int stop_signal() { return received; }

}  // namespace jaxmpm
