#include "io/summary.hpp"

#include "core/provenance.hpp"
#include "core/runtime.hpp"
#include "io/index.hpp"

namespace jaxmpm {

std::string backend_name(Backend backend) { return backend == Backend::cuda ? "cuda" : "cpu"; }

nlohmann::ordered_json cost_summary(const Model& model, const Solver& solver, Backend backend, std::uint64_t steps, double seconds,
                                    const PhaseSeconds& phases) {
  const auto particles = static_cast<double>(solver.particle_count());
  const auto count = static_cast<double>(steps);
  nlohmann::ordered_json json;
  json["particles"] = solver.particle_count();
  json["steps"] = steps;
  json["seconds"] = seconds;
  json["particle_steps_per_second"] = seconds > 0 ? particles * count / seconds : 0;
  json["seconds_per_1000_steps"] = steps > 0 ? 1000 * seconds / count : 0;
  json["backend"] = backend_name(backend);
  json["threads"] = thread_count();
  json["precision"] = precision_name(model.method.precision);
  json["gradient_form"] = model.method.gradient == deck::GradientForm::mls ? "mls" : "spline";
  json["dimension"] = model.dim;
  json["bytes_per_particle"] = solver.bytes_per_particle();
  json["active_blocks"] = solver.active_blocks();
  if (model.method.rest) json["particles_at_rest"] = solver.particles_at_rest();
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["seconds_by_phase"] = {{"sort", phases.sort}, {"p2g", phases.p2g}, {"grid", phases.grid}, {"g2p", phases.g2p}};
  json["version"] = provenance().version;
  json["git_commit"] = provenance().git_commit;
  return json;
}

}  // namespace jaxmpm
