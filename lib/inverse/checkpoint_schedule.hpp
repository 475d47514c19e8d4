#pragma once
// Which states a reverse run keeps (Griewank & Walther 2000, "revolve"): with s free snapshots and each step done again at most r times,
// C(s + r, s) steps can be reversed, and no schedule does more.
#include <cstddef>

namespace jaxmpm {

/// How many steps to go from a kept state, of the `steps` ≥ 2 behind it that are to be reversed, before the next state is kept; `free` ≥ 1
/// snapshots are left, this one included.
std::size_t steps_to_next_snapshot(std::size_t steps, std::size_t free);

/// Forward steps of the whole schedule besides those of one plain run over `steps`, with `snapshots` ≥ 2 in all.
double recomputed_steps(std::size_t steps, std::size_t snapshots);

}  // namespace jaxmpm
