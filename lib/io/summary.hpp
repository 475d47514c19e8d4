#pragma once
// What a run or a benchmark took: the figures of `bench --json` and of DIR/run.json, from one function.
#include <nlohmann/json.hpp>
#include <string>

#include "solvers/simulation.hpp"

namespace jaxmpm {

/// Name of a backend as the command line writes it.
std::string backend_name(Backend backend);

/// Particles, steps, seconds and what follows from them. `seconds` is wall time in steps alone; `phases` the seconds of these very steps.
nlohmann::ordered_json cost_summary(const Model& model, const Solver& solver, Backend backend, std::uint64_t steps, double seconds,
                                    const PhaseSeconds& phases);

}  // namespace jaxmpm
