#include "io/frame.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/parallel_host.hpp"
#include "io/hdf5.hpp"

namespace jaxmpm {
namespace {

void write_field(hdf5::Writer& file, const std::string& group, const OutputField& field, const BodySnapshot& snapshot, std::size_t body,
                 int dim) {
  const std::string name = group + "/" + field.name;
  std::vector<std::size_t> shape = value_shape(field.rank, dim);
  shape.insert(shape.begin(), snapshot.id.size());
  if (field.values) file.dataset(name, shape, snapshot.*field.values);
  else if (field.name == "id") file.dataset(name, "u4", shape, snapshot.id.data());
  else file.dataset(name, "u4", shape, std::vector<std::uint32_t>(snapshot.id.size(), static_cast<std::uint32_t>(body)).data());
  file.attribute(name, "units", field.unit);
  if (const auto components = component_names(field.rank, dim); !components.empty()) file.attribute(name, "components", components);
}

/// Place of the first value that is no finite number, or their count.
std::size_t first_not_finite(const std::vector<double>& values) {
  const auto first = [&](std::size_t begin, std::size_t end) {
    while (begin < end && std::isfinite(values[begin])) ++begin;
    return begin < end ? begin : values.size();
  };
  const std::vector<std::size_t> found = in_pieces("jaxmpm::finite", values.size(), first);
  return found.empty() ? 0 : *std::min_element(found.begin(), found.end());
}

bool is_written(const FrameBody& body, const OutputField& field) {
  if (field.name == "id" || field.name == "position") return true;
  for (const std::string& name : body.fields)
    if (name == field.name) return true;
  return false;
}

}  // namespace

void write_frame(const std::string& path, const Moment& now, const std::vector<FrameBody>& layout, const std::vector<BodySnapshot>& bodies,
                 int dim) {
  hdf5::Writer file(path);
  file.attribute("/", "time", now.time);
  file.attribute("/", "step", now.step);
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const std::string group = "/" + layout[b].name;
    file.group(group);
    for (const OutputField& field : output_fields())
      if (is_written(layout[b], field)) write_field(file, group, field, bodies[b], b, dim);
  }
  file.finish();
}

void require_finite(const Moment& now, const std::vector<FrameBody>& layout, const std::vector<BodySnapshot>& bodies, int dim) {
  for (std::size_t b = 0; b < layout.size(); ++b)
    for (const OutputField& field : output_fields()) {
      if (!field.values || !is_written(layout[b], field)) continue;
      const std::vector<double>& values = bodies[b].*field.values;
      if (const std::size_t i = first_not_finite(values); i < values.size())
        throw NumericsError(
            fmt::format("particle {} of body '{}' has a {} that is not finite at step {}, {:.9g} s (dt {:.3g} s). Take a smaller "
                        "/time/step or /time/cfl.",
                        bodies[b].id[i / component_count(field.rank, dim)], layout[b].name, field.name, now.step, now.time, now.dt));
    }
}

}  // namespace jaxmpm
